/// @file
/// Objects that touch sensors: triangle meshes and analytic solids, each in its own frame O, in metres.
#pragma once

#include <array>
#include <concepts>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "taxelsim/pose.h"

namespace taxelsim {

/// Triangle mesh. Order and winding are free, and the mesh need not be closed: only the lowest surface above a sample counts.
struct Mesh {
  std::vector<std::array<float, 3>> vertices;           ///< (num_vertices x 3), m, in O.
  std::vector<std::array<std::uint32_t, 3>> triangles;  ///< (num_triangles x 3), indices into `vertices`.
};

/// Sphere, centred on the origin.
struct Sphere {
  double radius = 0;  ///< m, > 0.
};

/// Cylinder along z with flat ends, centred on the origin.
struct Cylinder {
  double radius = 0;  ///< m, > 0.
  double length = 0;  ///< m, > 0.
};

/// Capsule along z, centred on the origin.
struct Capsule {
  double radius = 0;  ///< m, > 0.
  double length = 0;  ///< m, >= 0, length of the straight part.
};

/// Box, centred on the origin.
struct Box {
  Vector3 size{0, 0, 0};  ///< m, > 0, full side lengths along x, y, z.
};

/// All points with z >= 0 in O.
struct HalfSpace {};

/// Cone with its apex at the origin and its axis along +z.
struct Cone {
  double radius = 0;  ///< m, > 0, radius of the base at z = height.
  double height = 0;  ///< m, > 0.
};

/// Torus with axis z, centred on the origin.
struct Torus {
  double major_radius = 0;  ///< m, > minor_radius, from the centre to the middle of the tube.
  double minor_radius = 0;  ///< m, > 0, radius of the tube.
};

/// Any shape.
using Shape = std::variant<Mesh, Sphere, Cylinder, Capsule, Box, HalfSpace, Cone, Torus>;

/// A named shape.
struct Object {
  std::string name;  ///< Name in messages and data sets.
  Shape shape;       ///< Geometry in O.

  Object() = default;
  /// An object with a name.
  Object(std::string object_name, Shape object_shape) : name(std::move(object_name)), shape(std::move(object_shape)) {}
  /// An object named after the kind of its shape: "mesh", "sphere", ...
  Object(Shape object_shape);  // NOLINT(google-explicit-constructor): lists of shapes read well at the call site
  /// The same, from one of the alternatives of Shape.
  template <typename Kind>
  requires(!std::same_as<std::remove_cvref_t<Kind>, Object> && !std::same_as<std::remove_cvref_t<Kind>, Shape> &&
           std::constructible_from<Shape, Kind>) Object(Kind&& kind)  // NOLINT(bugprone-forwarding-reference-overload)
      : Object(Shape(std::forward<Kind>(kind))) {}
};

/// Axis of a mesh file that becomes z.
enum class UpAxis {
  kX,  ///< The file's x.
  kY,  ///< The file's y.
  kZ,  ///< The file's z.
};

/// Options of loadMesh().
struct MeshOptions {
  double scale = 1;  ///< Metres per unit of the file, > 0. Default 1.
  /// m, > 0: longest side of the bounding box that the mesh gets, instead of `scale`. Default: none.
  std::optional<double> size = {};
  UpAxis up_axis = UpAxis::kZ;  ///< Axis of the file that becomes z; the other axes follow cyclically. Default kZ.
  /// m, >= 0, bound of the simplification. Default 1e-5 (10 um); 0 keeps every triangle.
  ///
  /// The Hausdorff distance between the surface in the file and the simplified one is at most this value; it is proven, not estimated. A
  /// depth changes by at most this value along the surface normal and by this value / cos(slope) along z. On a silhouette, a sample may hit
  /// one surface and miss the other.
  double max_depth_error = 1e-5;
};

/// Bytes of the largest mesh file that is read. A larger one is refused before it is opened.
inline constexpr std::uintmax_t kMaxMeshFileBytes = std::uintmax_t{1} << 30;

/// Reads OBJ, STL, PLY or glTF.
///
/// All parts of the file become one mesh. It is scaled and rotated, its vertices are welded, degenerate triangles are dropped, and the rest
/// is simplified within max_depth_error. The result for a mesh of 20,000 triangles or more is kept in the user's cache directory
/// ($XDG_CACHE_HOME/taxelsim, else ~/.cache/taxelsim). The same file and options give the same mesh. Throws Error(kInput) if the file is
/// missing, too large, not a mesh, without a triangle or not finite, and if an option is out of range. Logs a warning for a mesh longer
/// than 0.7 m, which is probably in millimetres, or shorter than 0.1 mm, which was probably scaled twice.
Mesh loadMesh(const std::filesystem::path& file, const MeshOptions& options = {});

/// Parses the command line's notation of an object: a mesh file, or sphere:R, cylinder:R,L, capsule:R,L, box:X,Y,Z, half_space, cone:R,H,
/// torus:MAJOR,MINOR, in metres. `options`: of a mesh file. Throws Error(kInput). Logs a warning for an object longer than 0.7 m
/// or shorter than 0.1 mm, whose sizes are probably in another unit.
Object parseObject(std::string_view text, const MeshOptions& options = {});

/// Throws Error(kInput), naming the object, if a dimension is not finite or out of range, a mesh has no triangle, or an index is out of
/// range.
void checkObject(const Object& object);

/// Axis-aligned box.
struct Bounds {
  Vector3 min{0, 0, 0};  ///< m, lowest coordinates.
  Vector3 max{0, 0, 0};  ///< m, highest coordinates.
};

/// Axis-aligned bounding box in O. Infinite for a half-space.
Bounds boundsOf(const Object& object);

/// Lowest point (m, in O) of the object rotated by R_SO: its first contact with a skin in the plane z = 0 of S.
///
/// If an edge or a face is lowest, its middle; for a mesh, the mean of its lowest vertices. For a half-space that faces down, tilted or
/// not, its origin; for any other half-space it throws Error(kInput).
Vector3 lowestPoint(const Object& object, const Quaternion& R_SO);

}  // namespace taxelsim
