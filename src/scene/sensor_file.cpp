#include "scene/sensor_file.h"

#include <limits>

#include "scene/keys/sensor.h"
#include "scene/patch_reader.h"
#include "scene/psf_reader.h"
#include "scene/readout_reader.h"
#include "scene/skin_reader.h"
#include "sensor/fields.h"

namespace taxelsim {

void checkFormatVersion(const YamlNode& root) {
  if (!root.isMap()) root.refuse("a mapping that begins with format_version: " + std::to_string(kFormatVersion));
  const std::optional<YamlNode> given = root.child("format_version");
  if (!given) root.fail("missing `format_version: " + std::to_string(kFormatVersion) + "`");
  const std::uint64_t version = given->integer(1, std::numeric_limits<std::uint64_t>::max());
  if (version > kFormatVersion) {
    given->fail("version " + std::to_string(version) + " is newer than this program: it reads up to " + std::to_string(kFormatVersion));
  }
}

Sensor readSensor(const YamlNode& node, const std::filesystem::path& directory, Canonical& canonical, bool versioned) {
  const YamlMap map(node, sensorKeys(), canonical, versioned ? "" : "format_version");
  Sensor sensor;
  sensor.name = map.text("name");
  sensor.patches = readPatches(map, directory);
  readFields(map, kSensorFields, sensor);
  sensor.depth_sampling = map.choice<DepthSampling>("depth_sampling");
  sensor.skin = readSkin(map);
  sensor.psf = readPsf(map);
  sensor.readout = readReadout(map, sensor.patches);
  readFields(map, kFrameRateFields, sensor);
  atNode(node, [&] { checkSensor(sensor); });
  return sensor;
}

Sensor readSensorFile(const std::filesystem::path& file, Canonical& canonical) {
  const std::string name = file.generic_string();
  const YamlTree tree = parseYaml(readYamlFile(file), name);
  const YamlNode root(tree, name);
  checkFormatVersion(root);
  return readSensor(root, file.parent_path(), canonical, true);
}

Sensor readSensorBlock(const YamlNode& node, const std::filesystem::path& directory, Canonical& canonical) {
  canonical.open("sensor");
  Sensor sensor;
  if (node.isMap()) {
    sensor = readSensor(node, directory, canonical, false);
  } else {
    const std::filesystem::path file = directory / node.text(kSensorBlock);
    std::error_code error;
    // Errors inside that file have positions in that file.
    if (!std::filesystem::is_regular_file(file, error)) node.fail(file.generic_string() + " is not there, or not a file");
    sensor = readSensorFile(file, canonical);
  }
  canonical.close();
  return sensor;
}

Sensor loadSensor(const std::filesystem::path& file) {
  Canonical canonical;
  return readSensorFile(file, canonical);
}

}  // namespace taxelsim
