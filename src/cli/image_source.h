// Tactile images from a measurement or a data set.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "taxelsim/measurement.h"
#include "taxelsim/sensor.h"

namespace taxelsim::cli {

struct ImageSource {
  std::string file;              // as given
  std::string name;              // for figures
  std::optional<Sensor> sensor;  // none for a data set whose taxels come from a file that the scene names
  Images images;                 // no times for a data set, because times restart with every episode
};

// A directory is read as a data set, a file as a measurement. Throws Error(kInput) if it has no images or several sensors.
ImageSource loadImages(const std::filesystem::path& path);

}  // namespace taxelsim::cli
