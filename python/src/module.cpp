// taxelsim._core: the C++ library in Python. The package taxelsim adds checks of arrays and is what users import.
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/string_view.h>
#include <nanobind/stl/vector.h>

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "bind.h"
#include "cli/python_table.h"
#include "taxelsim/version.h"

namespace taxelsim::python {
namespace {

// cls(...) calls the method cls._construct().
void routeConstructor(nb::handle cls) {
  nb::cpp_function_def([](nb::handle self, const nb::args& args, const nb::kwargs& kwargs) { self.attr("_construct")(*args, **kwargs); },
                       nb::name("__init__"), nb::scope(cls), nb::is_method());
}

// Paths, since arguments may be names of files that are not UTF-8.
bool isPythonCommand(const std::vector<std::filesystem::path>& arguments) {
  return !cli::pythonCommand(std::vector<std::string>(arguments.begin(), arguments.end())).empty();
}

}  // namespace
}  // namespace taxelsim::python

NB_MODULE(_core, module) {
  using namespace taxelsim::python;
  module.attr("version") = taxelsim::kVersion;
  module.def("is_python_command", &isPythonCommand, nb::arg("arguments"),
             "Whether the arguments of the command line are for a subcommand that is written in Python.");
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
  bindRobot(module);
  bindEnvironment(module);
  bindRuns(module);
  bindGrasps(module);
  bindEvaluationParts(module);
  bindDataset(module);
  bindDlpack(module);
  if (nb::cast<std::string_view>(module.attr("__name__")) != "_core") {  // "_core" alone: type stubs are made of the bare module
    nb::module_::import_("taxelsim._native").attr("describe")(module, nb::cpp_function(&routeConstructor));
  }
}
