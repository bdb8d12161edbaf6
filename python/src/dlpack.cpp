// Read-only arrays for consumers of DLPack that know no read-only arrays.
#include <nanobind/ndarray.h>

#include <cstdint>
#include <vector>

#include "bind.h"

namespace taxelsim::python {

namespace {

// Another array over the same memory, which is not NumPy's and keeps `array` alive.
nb::ndarray<nb::array_api, nb::ro> neutral(nb::handle array) {
  const auto view = nb::cast<nb::ndarray<nb::ro, nb::device::cpu>>(array);
  std::vector<std::size_t> shape;
  std::vector<std::int64_t> strides;
  for (std::size_t axis = 0; axis < view.ndim(); ++axis) {
    shape.push_back(view.shape(axis));
    strides.push_back(view.stride(axis));
  }
  return {view.data(), view.ndim(), shape.data(), array, strides.data(), view.dtype()};
}

}  // namespace

void bindDlpack(nb::module_& module) {
  module.def("dlpack", &neutral, "array"_a, nb::sig("def dlpack(array: numpy.typing.NDArray[typing.Any]) -> typing.Any"),
             R"(A read-only array as an object that every consumer of DLPack takes, without a copy.

NumPy refuses to export its read-only arrays to consumers that speak DLPack below 1.0, JAX and older PyTorch among them.
torch.from_dlpack(dlpack(array)) shares the memory; do not write to the tensor. It keeps the memory alive.)");
}

}  // namespace taxelsim::python
