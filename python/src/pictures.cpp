// taxelsim._pictures: pictures of sensors and data sets. A module of its own, since Cairo needs libraries of X11, which `import taxelsim`
// must not.
#include "figures/episode_view.h"

#include <nanobind/ndarray.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>
#include <spdlog/fmt/fmt.h>

#include <cstdint>
#include <filesystem>
#include <memory>
#include <new>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "bind.h"
#include "figures/sensor_panels.h"
#include "figures/taxel_chart.h"
#include "taxelsim/error.h"
#include "taxelsim/sensor.h"

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

// The picture (height, width, 3) that `draw` returns, drawn without the interpreter's lock.
template <typename Draw>
nb::object pictureOf(const Draw& draw) {
  std::unique_ptr<Pixels> pixels;
  {
    const nb::gil_scoped_release released;
    pixels = std::make_unique<Pixels>(draw());
  }
  std::uint8_t* const data = pixels->values.data();
  const std::size_t height = pixels->height, width = pixels->width;
  const nb::capsule owner(pixels.release(), [](void* owned) noexcept { delete static_cast<Pixels*>(owned); });
  return nb::ndarray<nb::numpy, std::uint8_t, nb::ndim<3>>(data, {height, width, 3}, owner).cast();
}

using Image = nb::ndarray<const double, nb::ndim<1>, nb::c_contig, nb::device::cpu>;

// `images`: titles and values (num_taxels).
nb::object drawSensorFigure(const Sensor& sensor, const std::vector<std::pair<std::string, Image>>& images, const std::string& title,
                            const std::string& subtitle, const std::string& unit, double range) {
  std::vector<figures::TactilePanel> panels;
  for (const auto& [name, values] : images) {
    if (values.size() != static_cast<std::size_t>(numTaxels(sensor)))
      throw Error(ErrorKind::kInput, fmt::format("images: {} values are not allowed: {} taxels", values.size(), numTaxels(sensor)));
    for (figures::TactilePanel& panel : figures::panelsOf(sensor, {values.data(), values.size()}, name).panels) {
      if (panel.neighbours) panel.axes = figures::axesOfImage(panel);
      panels.push_back(std::move(panel));
    }
  }
  const figures::FigureOptions options{.title = title, .subtitle = subtitle, .unit = unit, .num_columns = 1, .range = range};
  return pictureOf([&] { return figures::drawTactileFigure(panels, options).pixels(); });
}

// (num_taxels, 4, 2).
nb::object outlinesOf(const Sensor& sensor) {
  auto* const outlines = new std::vector<figures::TaxelOutline>(figures::outlinesOf(sensor));
  const nb::capsule owner(outlines, [](void* owned) noexcept { delete static_cast<std::vector<figures::TaxelOutline>*>(owned); });
  return nb::ndarray<nb::numpy, double, nb::ndim<3>>(outlines->front().front().data(), {outlines->size(), 4, 2}, owner).cast();
}

}  // namespace
}  // namespace taxelsim::python

NB_MODULE(_pictures, module) {
  using namespace taxelsim::python;
  nb::class_<EpisodePictures>(module, "EpisodePictures",
                              "Pictures of the frames of an episode: sensor and object in 3-D, tactile image, force and edge angle. range: "
                              "counts of the brightest colour, 0 for those of the data set. assets: folders with the meshes of the scene. "
                              "sensor: its name where columns are grouped by sensor; empty for the first.")
      .def(
          "__init__",
          [](EpisodePictures* self, const std::string& folder, std::uint64_t episode, double range, const std::vector<std::string>& assets,
             const std::string& sensor) {
            const std::vector<std::filesystem::path> folders(assets.begin(), assets.end());
            new (self) EpisodePictures({.directory = folder, .sensor = sensor, .episode = episode, .range = range}, folders);
          },
          "folder"_a, "episode"_a, "range"_a = 0.0, "assets"_a = std::vector<std::string>(), "sensor"_a = std::string(),
          nb::call_guard<nb::gil_scoped_release>())
      .def_prop_ro("without_view", &EpisodePictures::withoutView, "Why pictures show the tactile image alone; empty if they show all.")
      .def("times", &EpisodePictures::times, nb::call_guard<nb::gil_scoped_release>(), "s, of the frames.")
      .def(
          "draw", [](EpisodePictures& self, std::uint64_t frame) { return pictureOf([&] { return self.pictureOf(frame); }); }, "frame"_a,
          nb::sig("def draw(self, frame: int) -> numpy.typing.NDArray[numpy.uint8]"),
          "Picture (height, width, 3) of a frame, counted from 0. All have one size and one colour scale.");
  module.def(
      "taxel_outlines", &outlinesOf, "sensor"_a, nb::sig("def taxel_outlines(sensor: object) -> numpy.typing.NDArray[numpy.float64]"),
      "Corners (num_taxels, 4, 2) of the taxels in figures, m: x points down, y to the right; by (x, y) of the taxel (-, -), (-, +), "
      "(+, +), (+, -). A list of taxels is unrolled along its skin.");
  module.def(
      "sensor_figure", &drawSensorFigure, "sensor"_a, "images"_a, "title"_a, "subtitle"_a, "unit"_a, "range"_a,
      nb::sig("def sensor_figure(sensor: object, images: Sequence[tuple[str, numpy.typing.NDArray[numpy.float64]]], title: str, subtitle: "
              "str, unit: str, range: float) -> numpy.typing.NDArray[numpy.uint8]"),
      "A figure (height, width, 3) as `taxelsim frame --png` writes it. images: title and values (num_taxels) of each. range: value of the "
      "brightest colour.");
}
