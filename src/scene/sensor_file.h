// Sensor files, and the `sensor` block of a scene (docs/file_formats.md).
#pragma once

#include <cstdint>
#include <filesystem>

#include "scene/yaml_reader.h"
#include "taxelsim/sensor.h"

namespace taxelsim {

inline constexpr std::uint64_t kFormatVersion = 1;  // of sensor and scene files

// Refuses a file without `format_version` or with a newer one: before its other keys are looked at, since a newer file may have others.
void checkFormatVersion(const YamlNode& root);

// read(root, directory) of a file that has a `format_version`.
template <typename Function>
auto readVersionedFile(const std::filesystem::path& file, Function read) {
  const std::string name = file.generic_string();
  const YamlTree tree = parseYaml(readYamlFile(file), name);
  const YamlNode root(tree, name);
  checkFormatVersion(root);
  return read(root, file.parent_path());
}

// Reads and checks a sensor, checkSensor() included, and writes every setting to `canonical`. Files that it names lie relative to
// `directory`. Only a file of its own is `versioned`.
Sensor readSensor(const YamlNode& node, const std::filesystem::path& directory, Canonical& canonical, bool versioned);

// The same from a file of its own.
Sensor readSensorFile(const std::filesystem::path& file, Canonical& canonical);

// What readSensorBlock() takes, for a message.
inline constexpr const char* kSensorBlock = "a sensor file, or a sensor's own settings";

// The sensor that `node` names by a file, relative to `directory`, or gives in place; as the block `sensor` of the canonical text.
Sensor readSensorBlock(const YamlNode& node, const std::filesystem::path& directory, Canonical& canonical);

}  // namespace taxelsim
