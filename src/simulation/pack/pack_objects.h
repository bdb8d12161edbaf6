// Objects -> the records that the contact pass reads.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "shared/model.h"
#include "simulation/raster.h"
#include "taxelsim/object.h"

namespace taxelsim {

struct PackedObjects {
  std::vector<layout::ObjectRecord> objects;
  std::vector<glm::uvec4> groups;  // boxes of the meshes' groups, shared/model.h
  std::vector<glm::uvec4> clusters;
  std::vector<std::uint32_t> quads;  // of triangles
  std::vector<glm::vec4> faces;      // of polyhedra: normal and offset (m), in O
  std::uint32_t num_faces = 1;       // of each polyhedron; shorter ones repeat some
};

// How packObjects() packs shapes for which there is more than one way.
enum class Shapes {
  kMeshes,     // meshes stay meshes
  kPolyhedra,  // convex meshes of few faces become polyhedra
  kOutward,    // for area sampling: boxes and tori become meshes, and closed meshes wind outward
};

PackedObjects packObjects(std::span<const Object> objects, const SampleGrid& grid, Shapes shapes);

}  // namespace taxelsim
