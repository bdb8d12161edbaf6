// The settings of a measurement, in a file of their own or in a list of recordings.
#pragma once

#include <filesystem>
#include <string>

#include "scene/yaml_reader.h"
#include "taxelsim/measurement.h"

namespace taxelsim {

struct MeasurementPlace {
  std::filesystem::path file;     // for messages
  std::string name;               // of the measurement
  std::filesystem::path sensors;  // sensor files are relative to this directory
  std::filesystem::path tables;   // tables are relative to this directory
  bool is_file = false;           // with a format_version
};

Measurement readMeasurement(const YamlNode& root, const MeasurementPlace& place);

}  // namespace taxelsim
