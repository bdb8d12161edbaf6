// Read-only arrays for consumers of DLPack that know no read-only arrays.
#include <nanobind/ndarray.h>

#include "bind.h"

namespace taxelsim::python {

void bindDlpack(nb::module_& module) {
  module.def(
      "dlpack", [](const nb::ndarray<nb::ro>& array) { return array; }, "array"_a,
      nb::sig("def dlpack(array: numpy.typing.NDArray[typing.Any]) -> typing.Any"),
      R"(A read-only array as an object that every consumer of DLPack takes, without a copy.

NumPy refuses to export its read-only arrays to consumers that speak DLPack below 1.0, JAX and older PyTorch among them.
torch.from_dlpack(dlpack(array)) shares the memory; do not write to the tensor. It keeps the memory alive.)");
}

}  // namespace taxelsim::python
