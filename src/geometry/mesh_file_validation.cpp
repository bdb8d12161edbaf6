#include "geometry/mesh_file_validation.h"

#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>
#include <string_view>

#include "base/text.h"
#include "geometry/gltf_validation.h"

namespace taxelsim {
namespace {

// Parses the coordinates of vertex lines strictly: Assimp reads "1,5" and "1.5.5" as 1.5.
std::string validateObj(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::string line;
  std::size_t num_vertices = 0;
  for (std::size_t number = 1; std::getline(stream, line); ++number) {
    std::istringstream words(line);
    std::string word;
    if (!(words >> word) || word != "v" || line.find('\\') != std::string::npos) continue;
    for (int axis = 0; axis < 3; ++axis) {
      if (!(words >> word)) return "line " + std::to_string(number) + ": vertex " + std::to_string(num_vertices) + " lacks a coordinate";
      double coordinate = 0;
      const std::string_view digits = std::string_view(word).substr(word[0] == '+' ? 1 : 0);
      if (!parseNumber(digits, coordinate) || std::abs(coordinate) > std::numeric_limits<float>::max()) {
        return "line " + std::to_string(number) + ": vertex " + std::to_string(num_vertices) + " has the coordinate " +
               oneLine(word).substr(0, 40) + ", which is not a finite number";
      }
    }
    ++num_vertices;
  }
  return {};
}

}  // namespace

std::string validateMeshFile(const std::filesystem::path& file, MeshFormat format) {
  switch (format) {
    case MeshFormat::kObj:
      return validateObj(file);
    case MeshFormat::kStl:
    case MeshFormat::kPly:
      break;
    case MeshFormat::kGltf:
    case MeshFormat::kGlb:
      return validateGltf(file, format == MeshFormat::kGlb);
  }
  return {};
}

}  // namespace taxelsim
