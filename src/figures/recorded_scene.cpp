#include "figures/recorded_scene.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

#include "base/sha256.h"
#include "base/text.h"
#include "scene/object_reader.h"
#include "scene/sensor_file.h"
#include "taxelsim/error.h"
#include "taxelsim/scene.h"

namespace taxelsim::figures {
namespace {

const std::string kSceneOfDataSet = "scene of the data set";
// Keys of an object that do not change its shape in its own frame; some of them name files.
constexpr std::array<std::string_view, 8> kNoShape{"anchor", "contour",     "edge", "max_depth_error",
                                                   "motion", "orientation", "pose", "weight"};

// `item`: of the list of objects.
YamlTree shapeOf(const YamlTree& item) {
  YamlTree shape = item;
  shape.keys.clear(), shape.children.clear();
  for (std::size_t k = 0; k < item.keys.size(); ++k) {
    if (std::find(kNoShape.begin(), kNoShape.end(), item.keys[k].text) != kNoShape.end()) continue;
    shape.keys.push_back(item.keys[k]);
    shape.children.push_back(item.children[k]);
  }
  return shape;
}

bool isMesh(const std::filesystem::directory_entry& entry, const std::string& name, const std::string& sha256) {
  return entry.path().filename() == name && entry.is_regular_file() && sha256File(entry.path()) == sha256;
}

// The folder that holds the mesh of an object; empty for a solid.
std::filesystem::path folderOfMesh(const YamlNode& item, std::span<const std::filesystem::path> assets) {
  const std::optional<YamlNode> mesh = item.child("mesh"), sha256 = item.child("sha256");
  if (!mesh || !sha256) return {};
  const std::string name = mesh->text("a mesh file"), digest = sha256->text("64 hexadecimal digits");
  for (const std::filesystem::path& folder : assets) {
    std::error_code error;
    if (!std::filesystem::is_directory(folder, error)) throw Error(ErrorKind::kInput, "--assets " + folder.string() + ": no such folder");
    for (const auto& entry :
         std::filesystem::recursive_directory_iterator(folder, std::filesystem::directory_options::skip_permission_denied)) {
      if (isMesh(entry, name, digest)) return entry.path().parent_path();
    }
  }
  throw Error(ErrorKind::kInput, fmt::format("{} with SHA-256 {}... is not found; --assets names the folder that holds it", oneLine(name),
                                             digest.substr(0, 8)));
}

// The block of a robot's sensor of that name.
std::optional<YamlNode> sensorOfRobot(const YamlNode& root, const std::string& name) {
  const std::optional<YamlNode> robot = root.child("robot");
  if (!robot || !robot->isMap()) return std::nullopt;
  for (const YamlTree::Key& key : robot->tree().keys) {
    const YamlNode kind = *robot->child(key.text);
    const std::optional<YamlNode> mounts = kind.isMap() ? kind.child("sensors") : std::nullopt;
    if (!mounts || !mounts->isList()) continue;
    for (const YamlNode& mount : mounts->items("a list")) {
      const std::optional<YamlNode> found = mount.isMap() ? mount.child("name") : std::nullopt;
      if (found && found->isScalar() && found->tree().text == name) return mount.child("sensor");
    }
  }
  return std::nullopt;
}

}  // namespace

std::optional<Sensor> recordedSensor(const Manifest& manifest, const std::string& name) {
  try {
    const YamlTree tree = parseYaml(readableScene(manifest.scene), kSceneOfDataSet);
    const YamlNode root(tree, kSceneOfDataSet);
    if (!root.isMap()) return std::nullopt;
    const std::optional<YamlNode> block = name.empty() ? root.child("sensor") : sensorOfRobot(root, name);
    Canonical unused;
    if (block && block->isMap()) return readSensorBlock(*block, {}, unused);
  } catch (const Error&) {
    return std::nullopt;  // the checksum was right; only the sensor is unknown
  }
  return std::nullopt;
}

std::size_t numRecordedObjects(const Manifest& manifest) {
  const YamlTree tree = parseYaml(readableScene(manifest.scene), kSceneOfDataSet);
  const YamlNode root(tree, kSceneOfDataSet);
  const std::optional<YamlNode> objects = root.isMap() ? root.child("objects") : std::nullopt;
  return objects && objects->isList() ? objects->tree().children.size() : 0;
}

Object recordedObject(const Manifest& manifest, std::size_t index, std::span<const std::filesystem::path> assets, double max_depth_error) {
  const YamlTree tree = parseYaml(readableScene(manifest.scene), kSceneOfDataSet);
  const YamlNode root(tree, kSceneOfDataSet);
  const std::optional<YamlNode> objects = root.isMap() ? root.child("objects") : std::nullopt;
  if (!objects || !objects->isList() || index >= objects->tree().children.size())
    throw Error(ErrorKind::kInput, fmt::format("{}: it has no object {}", kSceneOfDataSet, index));
  YamlTree list = objects->tree(), scene = root.tree();
  list.children = {shapeOf(objects->tree().children[index])};
  scene.keys = {{"objects", list.line, list.column}};
  scene.children = {list};
  const YamlNode node(scene, kSceneOfDataSet);
  Canonical unused;
  const YamlMap map(node, YamlMap::Keys{"objects"}, unused);
  const std::filesystem::path folder = folderOfMesh(map.require("objects", kObjectList).items(kObjectList).front(), assets);
  return readObjects(map, folder, max_depth_error).front().object;
}

}  // namespace taxelsim::figures
