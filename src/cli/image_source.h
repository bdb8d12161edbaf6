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

// A directory is read as a data set, a file as a measurement. `sensor`: where the columns of the data set are grouped by sensor; empty for
// the first. Throws Error(kInput) if there are no images, or several sensors without groups.
ImageSource loadImages(const std::filesystem::path& path, const std::string& sensor);

}  // namespace taxelsim::cli
