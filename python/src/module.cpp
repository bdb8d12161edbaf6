// taxelsim._core: the C++ library in Python. The package taxelsim adds checks of arrays and is what users import.
#include "bind.h"
#include "taxelsim/version.h"

NB_MODULE(_core, module) {
  using namespace taxelsim::python;
  module.attr("version") = taxelsim::kVersion;
  bindErrors(module);
  bindLog(module);
  bindPose(module);
  bindDevice(module);
  bindObjects(module);
  bindSensor(module);
  bindStiffness(module);
  bindModel(module);
  bindSimulator(module);
  bindScene(module);
  bindEnvironment(module);
  bindRuns(module);
  bindGrasps(module);
  bindEvaluationParts(module);
  bindDataset(module);
  bindDlpack(module);
}
