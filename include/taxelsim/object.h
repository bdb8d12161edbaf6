// Objects that touch sensors: triangle meshes and analytic solids, each in its own frame O, in metres.
#pragma once

#include <array>
#include <concepts>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "taxelsim/pose.h"

namespace taxelsim {

// Triangles in any order and winding; need not be closed: only the lowest surface over a sample counts.
struct Mesh {
  std::vector<std::array<float, 3>> vertices;           // (num_vertices x 3), m, in O
  std::vector<std::array<std::uint32_t, 3>> triangles;  // (num_triangles x 3), indices into vertices
};

struct Sphere {
  double radius = 0;  // m, > 0; centred on the origin
};
struct Cylinder {
  double radius = 0;  // m, > 0
  double length = 0;  // m, > 0; along z, centred on the origin, with flat ends
};
struct Capsule {
  double radius = 0;  // m, > 0
  double length = 0;  // m, >= 0, of the straight part; along z, centred on the origin
};
struct Box {
  Vector3 size{0, 0, 0};  // m, > 0, full side lengths along x, y, z; centred on the origin
};
struct HalfSpace {};  // all points with z >= 0 in O
struct Cone {
  double radius = 0;  // m, > 0, of the base at z = height
  double height = 0;  // m, > 0; the apex is the origin, the axis is +z
};
struct Torus {
  double major_radius = 0;  // m, > minor_radius, from the centre to the middle of the tube; axis z
  double minor_radius = 0;  // m, > 0, of the tube
};

using Shape = std::variant<Mesh, Sphere, Cylinder, Capsule, Box, HalfSpace, Cone, Torus>;

struct Object {
  std::string name;
  Shape shape;

  Object() = default;
  Object(std::string object_name, Shape object_shape) : name(std::move(object_name)), shape(std::move(object_shape)) {}
  // A shape alone names itself after its kind ("mesh", "sphere", ...).
  Object(Shape object_shape);  // NOLINT(google-explicit-constructor): lists of shapes read well at the call site
  template <typename Kind>
  requires(!std::same_as<std::remove_cvref_t<Kind>, Object> && !std::same_as<std::remove_cvref_t<Kind>, Shape> &&
           std::constructible_from<Shape, Kind>) Object(Kind&& kind)  // NOLINT(bugprone-forwarding-reference-overload)
      : Object(Shape(std::forward<Kind>(kind))) {}
};

enum class UpAxis { kX, kY, kZ };

struct MeshOptions {
  double scale = 1;             // metres per unit of the file, > 0
  UpAxis up_axis = UpAxis::kZ;  // the file's axis that becomes z; the others follow cyclically

  // m, >= 0: triangles are left out as long as no point of the surface that was read is farther than this from the one that is kept, nor
  // the other way round. That is proven, not estimated; 0 keeps every triangle. A depth changes by at most this along the surface's normal,
  // and by this / cos(slope) along z; only on a silhouette may a sample be hit by one surface and missed by the other.
  double max_depth_error = 1e-5;
};

// Largest mesh file read, bytes. A larger one is refused before it is opened.
inline constexpr std::uintmax_t kMaxMeshFileBytes = std::uintmax_t{1} << 30;

// Reads OBJ, STL, PLY or glTF; all parts of the file become one mesh, scaled and turned, vertices welded, degenerate triangles dropped,
// then simplified as max_depth_error allows. The same file and options give the same mesh. Throws Error(kInput) when the file is missing,
// too large, not a mesh, holds no triangle or a value that is not finite, and when an option is out of its range.
Mesh loadMesh(const std::filesystem::path& file, const MeshOptions& options = {});

// An object from a word as the CLI takes it: a mesh file, or sphere:R | cylinder:R,L | capsule:R,L | box:X,Y,Z | half_space |
// cone:R,H | torus:MAJOR,MINOR in metres. Throws Error(kInput).
Object parseObject(std::string_view text);

// Throws Error(kInput), naming the object, when a dimension is not finite or out of its range, a mesh has no triangle, or
// an index is out of range.
void checkObject(const Object& object);

struct Bounds {
  Vector3 min{0, 0, 0};
  Vector3 max{0, 0, 0};
};

// Axis-aligned box in O, m. A half-space has infinite bounds.
Bounds boundsOf(const Object& object);

// The lowest point of the object, in O, once it is turned by R_SO: where it first meets a skin in the plane z = 0 of S. Where a
// whole edge or face is lowest, its middle (for a mesh: the mean of its lowest vertices). A half-space that faces down, tilted or
// not, gives its origin; one that does not throws Error(kInput).
Vector3 lowestPoint(const Object& object, const Quaternion& R_SO);

}  // namespace taxelsim
