// taxelsim._pictures: pictures of a data set, for videos. A module of its own, since Cairo needs libraries of X11, which `import taxelsim`
// must not.
#include "figures/frame_figures.h"

#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <cstdint>
#include <memory>
#include <new>

#include "bind.h"

namespace taxelsim::python {
namespace {

using figures::FrameFigures;
using figures::Pixels;

nb::object draw(FrameFigures& figures, std::uint64_t frame) {
  std::unique_ptr<Pixels> pixels;
  {
    const nb::gil_scoped_release released;
    pixels = std::make_unique<Pixels>(figures.pictureOf(frame).pixels());
  }
  std::uint8_t* const data = pixels->values.data();
  const std::size_t height = pixels->height, width = pixels->width;
  const nb::capsule owner(pixels.release(), [](void* owned) noexcept { delete static_cast<Pixels*>(owned); });
  return nb::ndarray<nb::numpy, std::uint8_t, nb::ndim<3>>(data, {height, width, 3}, owner).cast();
}

}  // namespace
}  // namespace taxelsim::python

NB_MODULE(_pictures, module) {
  using namespace taxelsim::python;
  nb::class_<FrameFigures>(module, "EpisodePictures",
                           "Pictures of the frames of an episode. range: counts of the brightest colour, 0 for those of the data set.")
      .def(
          "__init__",
          [](FrameFigures* self, const std::string& folder, std::uint64_t episode, double range) {
            new (self) FrameFigures({.directory = folder, .episode = episode, .range = range});
          },
          "folder"_a, "episode"_a, "range"_a = 0.0, nb::call_guard<nb::gil_scoped_release>())
      .def("times", &FrameFigures::times, nb::call_guard<nb::gil_scoped_release>(), "s, of the frames.")
      .def("draw", &draw, "frame"_a, nb::sig("def draw(self, frame: int) -> numpy.typing.NDArray[numpy.uint8]"),
           "Picture (height, width, 3) of a frame, counted from 0. All have one size and one colour scale.");
}
