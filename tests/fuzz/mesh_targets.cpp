// Targets of mesh files.
#include <array>
#include <cmath>
#include <string>

#include "fuzz/gltf_mutation.h"
#include "fuzz/input.h"
#include "fuzz/targets.h"
#include "taxelsim/object.h"

namespace taxelsim::fuzz {
namespace {

constexpr double kScale = 0.1;  // stored meshes are 0.01 to 2 units long; the loader logs a warning outside of 0.1 mm to 0.7 m

void readMesh(const std::string& extension, std::string_view input) {
  const auto file = inputFolder().write("mesh" + extension, input);
  Mesh mesh;
  if (!accepts([&] { mesh = loadMesh(file, {.scale = kScale}); })) return;
  for (const auto& vertex : mesh.vertices) {
    for (const float coordinate : vertex) require(std::isfinite(coordinate), "a vertex is not finite");
  }
  for (const auto& triangle : mesh.triangles) {
    for (const std::uint32_t corner : triangle) require(corner < mesh.vertices.size(), "a triangle uses a vertex that does not exist");
  }
  require(!mesh.triangles.empty(), "an empty mesh");
  accepts([&] { checkObject(Object("mesh", mesh)); });
}

}  // namespace

std::span<const Target> meshTargets() {
  static constexpr std::array kTargets{
      Target{"obj", [](std::string_view input) { readMesh(".obj", input); }},
      Target{"stl", [](std::string_view input) { readMesh(".stl", input); }},
      Target{"ply", [](std::string_view input) { readMesh(".ply", input); }},
      Target{"glb", [](std::string_view input) { readMesh(input.starts_with("glTF") ? ".glb" : ".gltf", input); }},
      Target{"gltf", [](std::string_view input) { readMesh(".glb", input); }, mutatedGlb}};
  return kTargets;
}

}  // namespace taxelsim::fuzz
