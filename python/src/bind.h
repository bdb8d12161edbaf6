// The parts of the extension module taxelsim._core, one file each. Types are registered before the functions that use them.
#pragma once

#include <nanobind/nanobind.h>

namespace taxelsim::python {

namespace nb = nanobind;
using namespace nb::literals;

void bindErrors(nb::module_& module);
void bindLog(nb::module_& module);
void bindPose(nb::module_& module);
void bindDevice(nb::module_& module);
void bindObjects(nb::module_& module);
void bindSensor(nb::module_& module);
void bindStiffness(nb::module_& module);
void bindModel(nb::module_& module);
void bindSimulator(nb::module_& module);
void bindScene(nb::module_& module);
void bindRobot(nb::module_& module);
void bindEnvironment(nb::module_& module);
void bindGrasps(nb::module_& module);
void bindRuns(nb::module_& module);
void bindEvaluationParts(nb::module_& module);
void bindDataset(nb::module_& module);
void bindDlpack(nb::module_& module);

}  // namespace taxelsim::python
