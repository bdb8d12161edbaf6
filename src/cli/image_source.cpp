#include "cli/image_source.h"

#include <algorithm>
#include <functional>
#include <numeric>

#include "figures/frame_figures.h"
#include "figures/recorded_scene.h"
#include "taxelsim/dataset.h"
#include "taxelsim/error.h"
#include "taxelsim/scene.h"

namespace taxelsim::cli {
namespace {

constexpr const char* kImage = "tactile_image";
constexpr std::uint64_t kFramesRead = 4096;

ImageSource loadDataSet(const std::filesystem::path& directory, const std::string& sensor) {
  const DatasetReader reader(directory, /*allow_incomplete=*/false, /*isolated=*/true);
  const Manifest& manifest = reader.manifest();
  const std::string group = figures::imageGroup(manifest, sensor, directory.string()), image = group + kImage;
  const std::string name = group == "data/" ? "" : group.substr(5, group.size() - 6);
  const auto column = std::find_if(manifest.columns.begin(), manifest.columns.end(), [&](const Column& c) { return c.name == image; });
  if (reader.numFrames() == 0) throw Error(ErrorKind::kInput, directory.string() + ": no frames");
  ImageSource source{.file = directory.string(),
                     .name = figures::sceneName(manifest) + (name.empty() ? "" : ", " + name),
                     .sensor = figures::recordedSensor(manifest, name),
                     .images = {}};
  source.images.num_taxels = std::accumulate(column->shape.begin(), column->shape.end(), std::size_t{1}, std::multiplies<>());
  if (source.sensor && source.images.num_taxels != static_cast<std::size_t>(numTaxels(*source.sensor))) {
    throw Error(ErrorKind::kInput, directory.string() + ": has several sensors per instance, whose images cannot be compared");
  }
  for (std::uint64_t first = 0; first < reader.numFrames(); first += kFramesRead) {
    for (const double counts : reader.readAsDouble(image, first, std::min(kFramesRead, reader.numFrames() - first))) {
      source.images.counts.push_back(static_cast<float>(counts));
    }
  }
  return source;
}

ImageSource loadFile(const std::filesystem::path& file) {
  Measurement measurement = loadMeasurement(file);
  ImageSource source{.file = file.string(), .name = measurement.name, .sensor = std::move(measurement.sensor), .images = {}};
  if (auto* points = std::get_if<PointImages>(&measurement.data)) {
    source.images = std::move(points->images);
  } else if (auto* stamp = std::get_if<StampImages>(&measurement.data)) {
    source.images = std::move(stamp->images);
  } else if (auto* uniform = std::get_if<UniformPress>(&measurement.data)) {
    source.images = std::move(uniform->images);
  } else if (auto* sequence = std::get_if<ImageSequence>(&measurement.data)) {
    source.images = std::move(sequence->images);
  } else {
    throw Error(ErrorKind::kInput,
                file.generic_string() +
                    ": a measurement without images; use images, point_images, footprint_images, stamp_images or uniform_press");
  }
  return source;
}

}  // namespace

ImageSource loadImages(const std::filesystem::path& path, const std::string& sensor) {
  std::error_code error;
  return std::filesystem::is_directory(path, error) ? loadDataSet(path, sensor) : loadFile(path);
}

}  // namespace taxelsim::cli
