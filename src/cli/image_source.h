// Tactile images from either of two places: a measurement with images, or a data set.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "taxelsim/measurement.h"
#include "taxelsim/sensor.h"

namespace taxelsim::cli {

struct ImageSource {
  std::string file;              // as given
  std::string name;              // for pictures
  std::optional<Sensor> sensor;  // none of a data set whose scene names a file that gives the taxels
  Images images;                 // of a data set without times: they begin anew with every episode
};

// A directory is a data set, a file a measurement. Throws Error(kInput) for one without images, or of several sensors.
ImageSource loadImages(const std::filesystem::path& path);

}  // namespace taxelsim::cli
