// taxelsim._pictures: pictures of a data set, for videos. A module of its own, since Cairo needs libraries of X11, which `import taxelsim`
// must not.
#include "figures/episode_view.h"

#include <nanobind/ndarray.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bind.h"
#include "taxelsim/error.h"

namespace taxelsim::python {
namespace {

using figures::Pixels;

// Pictures with the object in 3-D; without it, tactile images alone where the data set lacks what the view needs.
class EpisodePictures {
 public:
  EpisodePictures(figures::FrameSelection selection, const std::vector<std::filesystem::path>& assets) : frames_(std::move(selection)) {
    try {
      view_.emplace(frames_, assets);
    } catch (const Error& error) {
      if (error.kind() != ErrorKind::kInput) throw;
      without_view_ = error.what();
    }
  }
  EpisodePictures(const EpisodePictures&) = delete;  // view_ refers to frames_
  EpisodePictures& operator=(const EpisodePictures&) = delete;

  std::vector<double> times() const { return frames_.times(); }
  const std::string& withoutView() const { return without_view_; }
  Pixels pictureOf(std::uint64_t frame) { return (view_ ? view_->pictureOf(frame) : frames_.pictureOf(frame)).pixels(); }

 private:
  figures::FrameFigures frames_;
  std::optional<figures::EpisodeView> view_;
  std::string without_view_;
};

nb::object draw(EpisodePictures& pictures, std::uint64_t frame) {
  std::unique_ptr<Pixels> pixels;
  {
    const nb::gil_scoped_release released;
    pixels = std::make_unique<Pixels>(pictures.pictureOf(frame));
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
  nb::class_<EpisodePictures>(module, "EpisodePictures",
                              "Pictures of the frames of an episode: sensor and object in 3-D, tactile image, force and edge angle. range: "
                              "counts of the brightest colour, 0 for those of the data set. assets: folders with the meshes of the scene.")
      .def(
          "__init__",
          [](EpisodePictures* self, const std::string& folder, std::uint64_t episode, double range,
             const std::vector<std::string>& assets) {
            const std::vector<std::filesystem::path> folders(assets.begin(), assets.end());
            new (self) EpisodePictures({.directory = folder, .episode = episode, .range = range}, folders);
          },
          "folder"_a, "episode"_a, "range"_a = 0.0, "assets"_a = std::vector<std::string>(), nb::call_guard<nb::gil_scoped_release>())
      .def_prop_ro("without_view", &EpisodePictures::withoutView, "Why pictures show the tactile image alone; empty if they show all.")
      .def("times", &EpisodePictures::times, nb::call_guard<nb::gil_scoped_release>(), "s, of the frames.")
      .def("draw", &draw, "frame"_a, nb::sig("def draw(self, frame: int) -> numpy.typing.NDArray[numpy.uint8]"),
           "Picture (height, width, 3) of a frame, counted from 0. All have one size and one colour scale.");
}
