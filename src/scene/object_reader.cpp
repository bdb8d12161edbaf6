#include "scene/object_reader.h"

#include <algorithm>
#include <map>
#include <set>

#include "base/vector3.h"
#include "geometry/object_fields.h"
#include "geometry/unit_check.h"
#include "scene/hashed_file.h"
#include "scene/keys/object.h"
#include "scene/motion_reader.h"
#include "scene/pose_reader.h"
#include "scene/scene_fields.h"

namespace taxelsim {
namespace {

constexpr std::uintmax_t kMaxContourBytes = std::uintmax_t{1} << 20;

Mesh readMesh(const YamlMap& map, const YamlNode& node, const std::filesystem::path& directory, double max_depth_error) {
  const std::filesystem::path file = readHashedFile(map, "mesh", directory, kMaxMeshFileBytes);
  MeshOptions options{.max_depth_error = max_depth_error};
  readFields(map, kMeshScaleFields, options);
  options.up_axis = map.choice<UpAxis>("up_axis");
  readFields(map, kMeshErrorFields, options);
  return atNode(node, [&] { return loadMesh(file, options); });
}

template <typename Solid, typename Table>
Shape readSolid(const YamlMap& parent, std::string_view kind, const Table& table) {
  Solid solid;
  readFields(YamlMap(parent, kind), table, solid);
  return solid;
}

Shape readSolid(const YamlMap& parent, std::string_view kind) {
  if (kind == "sphere") return readSolid<Sphere>(parent, kind, kSphereFields);
  if (kind == "cylinder") return readSolid<Cylinder>(parent, kind, kCylinderFields);
  if (kind == "capsule") return readSolid<Capsule>(parent, kind, kCapsuleFields);
  if (kind == "box") return readSolid<Box>(parent, kind, kBoxFields);
  if (kind == "cone") return readSolid<Cone>(parent, kind, kConeFields);
  if (kind == "torus") return readSolid<Torus>(parent, kind, kTorusFields);
  Canonical none;
  const YamlMap map(parent.require(kind), YamlMap::Keys{}, none);
  parent.canonical().line(kind, "{}");
  return HalfSpace{};
}

// The object's edge: a direction, or a closed contour.
void readEdge(const YamlMap& map, const std::filesystem::path& directory, SceneObject& object) {
  if (const std::optional<YamlNode> edge = map.find("edge")) {
    const Vector3 direction = map.numbers<3>("edge");
    const double size = length(direction);
    if (!(size > 0)) edge->fail("[0, 0, 0] is not allowed: a direction");
    object.edge = scale(1 / size, direction);
  }
  if (map.has("contour")) {
    map.rejectBoth("contour", "edge");
    const YamlMap block(map, "contour");
    const std::filesystem::path file = readHashedFile(block, "file", directory, kMaxContourBytes);
    object.contour = atNode(block.require("file"), [&] { return loadContour(file); });
  }
  if (map.has("anchor")) {
    map.rejectBoth("anchor", "contour", "an object with a contour starts at a random point of it");
    object.anchor = map.numbers<3>("anchor");
  }
}

// Default names of objects: the name of the file or shape, with a number from the second on.
class Names {
 public:
  // False if an earlier object has this name.
  bool take(const std::string& name) { return taken_.insert(name).second; }

  std::string make(const YamlMap& map, std::string_view shape) {
    std::string word(shape);
    if (shape == "mesh") word = std::filesystem::path(map.require(shape).text(map.whatOf(shape))).stem().string();
    if (word.empty()) word = "mesh";
    int& number = numbers_[word];
    std::string name;
    do {
      name = ++number == 1 ? word : word + "_" + std::to_string(number);
    } while (!take(name));
    return name;
  }

 private:
  std::set<std::string> taken_;
  std::map<std::string, int> numbers_;
};

}  // namespace

std::vector<SceneObject> readObjects(const YamlMap& map, const std::filesystem::path& directory, double max_depth_error, ObjectUse use) {
  Canonical& canonical = map.canonical();
  const YamlNode list = map.require("objects", kObjectList);
  const std::vector<YamlNode> items = list.items(kObjectList);
  if (items.empty()) list.refuse(kObjectList);
  if (use == ObjectUse::kPlaced && items.size() > kMaxPlacedObjects) {
    list.fail(std::to_string(items.size()) + " objects are not allowed: at most " + std::to_string(kMaxPlacedObjects) +
              ", all in the scene at once");
  }
  Names names;
  for (const YamlNode& item : items) {
    const std::optional<YamlNode> name = item.child("name");
    if (name && !names.take(name->text("a name"))) name->fail("an earlier object has this name");
  }

  canonical.open("objects");
  std::vector<SceneObject> objects;
  double total_weight = 0;
  for (const YamlNode& item : items) {
    const YamlMap object_map = YamlMap::item(item, use == ObjectUse::kDrawn ? objectKeys() : placedObjectKeys(), canonical);
    const std::string_view shape = object_map.onlyOne();
    SceneObject object;
    std::optional<std::string> default_name;
    if (!object_map.has("name")) default_name = names.make(object_map, shape);
    object.object.name = object_map.text("name", "a name", default_name);
    if (use == ObjectUse::kPlaced) {
      object.pose = readPose(object_map, "pose");
    } else {
      readFields(object_map, kObjectFields, object);
      object.orientation = readRotation(object_map, "orientation");
      readEdge(object_map, directory, object);
    }
    object.motion = readMotion(object_map, directory);
    if (shape == "mesh") {
      object.object.shape = readMesh(object_map, object_map.require(shape), directory, max_depth_error);
    } else {
      for (const std::string_view key : {"scale", "up_axis", "max_depth_error", "sha256"}) {
        if (const std::optional<YamlNode> node = object_map.find(key)) node->fail("belongs to a mesh, not to a " + std::string(shape));
      }
      object.object.shape = readSolid(object_map, shape);
      const std::string size = implausibleSize(boundsOf(object.object), "are its sizes in millimetres? Give them by keys that end in _mm",
                                               "are its sizes in metres? Give them by keys without _mm");
      if (!size.empty()) object_map.require(shape, "").warn("the object " + size);
    }
    atNode(item, [&] { checkObject(object.object); });
    total_weight += object.weight;
    objects.push_back(std::move(object));
  }
  canonical.close();
  if (total_weight <= 0) list.fail("every weight is 0: at least one object must be chosen");
  return objects;
}

void refuseMotions(const YamlMap& map, const std::string& reason) {
  for (const YamlNode& item : map.require("objects", "").items("")) {
    if (const std::optional<YamlNode> motion = item.child("motion")) motion->fail(reason);
  }
}

}  // namespace taxelsim
