#include "scene/taxel_reader.h"

#include "geometry/object_fields.h"
#include "scene/hashed_file.h"
#include "scene/keys/sensor.h"
#include "scene/urdf_taxels.h"
#include "sensor/taxel_mesh.h"
#include "taxelsim/object.h"

namespace taxelsim {
namespace {

const std::string kAtMost = "at most " + std::to_string(kMaxListTaxels) + " taxels";

// The side of a square, or [along x, along y].
std::array<double, 2> readSize(const YamlMap& map) {
  const Allowed& allowed = map.allowedOf("size");
  const YamlNode node = map.require("size", "the side of a square in m, > 0, or [along x, along y]");
  std::array<double, 2> size{};
  if (node.isList()) {
    const std::vector<double> numbers = node.numbers(allowed, 2);
    size = {numbers[0], numbers[1]};
  } else {
    size.fill(node.number(allowed));
  }
  map.canonical().line("size", canonicalList(size));
  return size;
}

// The canonical text keeps the directions, because the rotation from them may differ in the last bit between machines.
GridPatch readTaxel(const YamlMap& map, std::string name) {
  const Vector3 position = map.numbers<3>("position");
  const Vector3 normal = map.numbers<3>("normal");
  std::optional<Vector3> x_axis;
  if (map.has("x_axis")) x_axis = map.numbers<3>("x_axis");
  const std::array<double, 2> size = readSize(map);
  return atNode(map.node(), [&] { return taxelPatch(std::move(name), position, normal, size, x_axis); });
}

}  // namespace

std::vector<GridPatch> readTaxelList(const YamlMap& sensor) {
  const std::vector<YamlNode> items = sensor.items("taxels");
  if (items.size() > static_cast<std::size_t>(kMaxListTaxels)) sensor.require("taxels").refuse(kAtMost);
  Canonical& canonical = sensor.canonical();
  canonical.open("taxels");
  std::vector<GridPatch> taxels;
  for (const YamlNode& item : items) {
    const YamlMap map = YamlMap::item(item, taxelKeys(), canonical);
    taxels.push_back(readTaxel(map, "taxel_" + std::to_string(taxels.size())));
  }
  canonical.close();
  return taxels;
}

std::vector<GridPatch> readTaxelMesh(const YamlMap& sensor, const std::filesystem::path& directory) {
  const YamlMap map(sensor, "taxel_mesh");
  const std::filesystem::path file = readHashedFile(map, "file", directory, kMaxMeshFileBytes);
  MeshOptions options;
  readFields(map, kMeshScaleFields, options);
  options.up_axis = map.choice<UpAxis>("up_axis");
  const YamlNode node = map.require("file");
  const Mesh mesh = atNode(node, [&] { return loadMesh(file, options); });
  if (mesh.triangles.size() > 2 * static_cast<std::size_t>(kMaxListTaxels)) {
    node.fail(std::to_string(mesh.triangles.size()) + " triangles are not allowed: two a taxel, " + kAtMost);
  }
  return atNode(node, [&] { return taxelsOfMesh(mesh); });
}

std::vector<GridPatch> readTaxelUrdf(const YamlMap& sensor, const std::filesystem::path& directory) {
  const YamlMap map(sensor, "urdf");
  const std::filesystem::path file = readHashedFile(map, "file", directory, kMaxUrdfBytes);
  const std::string name = map.text("sensor");
  return atNode(map.node(), [&] { return loadUrdfTaxels(file, name, kMaxListTaxels); });
}

}  // namespace taxelsim
