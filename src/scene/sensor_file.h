// Sensor files, and the `sensor` block of a scene (docs/reference/sensor_file.md).
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

#include "scene/yaml_reader.h"
#include "taxelsim/sensor.h"

namespace taxelsim {

inline constexpr std::uint64_t kFormatVersion = 1;  // of sensor and scene files

// Refuses a file without `format_version` or with a newer one. Called before the check of keys, since a newer file may have others.
void checkFormatVersion(const YamlNode& root);

// Parses the file, checks its `format_version` and returns read(root, directory).
template <typename Function>
auto readVersionedFile(const std::filesystem::path& file, Function read) {
  const std::string name = file.generic_string();
  const YamlTree tree = parseYaml(readYamlFile(file), name);
  const YamlNode root(tree, name);
  checkFormatVersion(root);
  return read(root, file.parent_path());
}

// Reads a sensor, checks it with checkSensor() and writes every setting to `canonical`. Files are relative to `directory`. `versioned`: the
// node is a file of its own, with a `format_version`.
Sensor readSensor(const YamlNode& node, const std::filesystem::path& directory, Canonical& canonical, bool versioned);

// The same for a sensor file.
Sensor readSensorFile(const std::filesystem::path& file, Canonical& canonical);

// For messages: the values that readSensorBlock() accepts.
inline constexpr const char* kSensorBlock = "a sensor file, or a sensor's own settings";

// The sensor of a scene: a file, relative to `directory`, or settings in place. Writes the block `sensor` of the canonical text.
Sensor readSensorBlock(const YamlNode& node, const std::filesystem::path& directory, Canonical& canonical);

// The block `skin` of a sensor file, with every setting of the law.
std::string skinText(const Skin& skin);

}  // namespace taxelsim
