// The `objects` of a scene: meshes by file, analytic solids by their dimensions.
#pragma once

#include <filesystem>
#include <vector>

#include "scene/yaml_reader.h"
#include "taxelsim/scene.h"

namespace taxelsim {

// What the objects of a scene are for.
enum class ObjectUse {
  kDrawn,   // one per episode, placed on the sensor: weight, orientation, edge, contour, anchor
  kPlaced,  // all at once, at most kMaxPlacedObjects: pose
};
inline constexpr std::size_t kMaxPlacedObjects = 8;  // kMaxSlots of taxelsim/simulator.h

inline constexpr const char* kObjectList = "a list of at least one object";

// Reads the objects of the scene `map`, loads their meshes (relative to `directory`) and checks them with checkObject(). `max_depth_error`:
// m, of meshes that have no key of that name.
std::vector<SceneObject> readObjects(const YamlMap& map, const std::filesystem::path& directory, double max_depth_error,
                                     ObjectUse use = ObjectUse::kDrawn);

// Fails at the first object that has a `motion`, with `reason`.
void refuseMotions(const YamlMap& map, const std::string& reason);

}  // namespace taxelsim
