#include "simulation/pack/pack_objects.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/log.h"
#include "base/text.h"
#include "geometry/clusters.h"
#include "geometry/outward.h"
#include "geometry/polyhedron.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

static_assert(layout::kLatticeBits == kLatticeBits && layout::kQuadsPerCluster == kQuadsPerCluster &&
              layout::kClustersPerGroup == kClustersPerGroup);

// Numbers of quads are 32-bit in GLSL.
constexpr std::uint32_t kMaxClusters = 1u << (layout::kFirstBits - 2);

// Stands for infinity in bounds; squares of it are finite floats.
constexpr float kEndlessHeight = 1e9f;

// Faces that a polyhedron may have: with more, rastering its triangles is as fast.
constexpr std::size_t kMaxFaces = 16;

glm::uvec4 packBox(const ClusterBox& box, std::uint32_t offset) {
  const auto axis = [&](std::size_t i) {
    const std::uint32_t low = box.low[i] >> layout::kBoxShift;
    const std::uint32_t high = (box.high[i] >> layout::kBoxShift) + 1;
    return low | high << 16;
  };
  return {axis(0), axis(1), axis(2), (box.first + offset) | (box.count - 1) << layout::kFirstBits};
}

void packQuad(const Quad& quad, PackedObjects& packed) {
  for (const LatticePoint& q : quad) {
    packed.quads.push_back(q[0] | q[1] << kLatticeBits);
    packed.quads.push_back(q[1] >> (32 - kLatticeBits) | q[2] << (2 * kLatticeBits - 32));
  }
}

void packMesh(const Mesh& mesh, bool closed, const SampleGrid& grid, PackedObjects& packed, layout::ObjectRecord& record) {
  const ClusteredMesh clustered = clusterMesh(mesh);
  const auto first_group = static_cast<std::uint32_t>(packed.groups.size());
  const auto first_cluster = static_cast<std::uint32_t>(packed.clusters.size());
  if (first_cluster + clustered.clusters.size() > kMaxClusters) {
    throw Error(ErrorKind::kInput,
                "the objects have more than " + std::to_string(kMaxClusters * kQuadsPerCluster) + " pairs of triangles together");
  }
  const Raster raster = chooseRaster(mesh, grid);
  record.kind_groups = {
      layout::kKindMesh, first_group, static_cast<std::uint32_t>(clustered.groups.size()),
      static_cast<std::uint32_t>(raster.subpixel_bits) | (raster.large ? layout::kLargeTriangles : 0u) | (closed ? layout::kClosed : 0u)};
  record.lattice = {static_cast<float>(clustered.middle[0]), static_cast<float>(clustered.middle[1]),
                    static_cast<float>(clustered.middle[2]), static_cast<float>(clustered.step)};
  for (const ClusterBox& group : clustered.groups) packed.groups.push_back(packBox(group, first_cluster));
  for (const ClusterBox& cluster : clustered.clusters) {
    packed.clusters.push_back(packBox(cluster, 0));
    for (std::uint32_t q = 0; q < cluster.count; ++q) packQuad(clustered.quads[cluster.first + q], packed);
    const LatticePoint& corner = clustered.quads[cluster.first].front();
    for (std::uint32_t q = cluster.count; q < kQuadsPerCluster; ++q) packQuad({corner, corner, corner, corner}, packed);
  }
}

Mesh meshOf(const Box& box) {
  Mesh mesh;
  for (unsigned corner = 0; corner < 8; ++corner) {
    const auto at = [&](std::size_t axis) {
      return static_cast<float>((corner >> axis & 1u) != 0 ? box.size[axis] / 2 : -box.size[axis] / 2);
    };
    mesh.vertices.push_back({at(0), at(1), at(2)});
  }
  mesh.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                    {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
  return mesh;
}

// Rings around the axis of sections with the area of the circle: off by at most 1.3e-3 of the minor radius.
Mesh meshOf(const Torus& torus) {
  constexpr std::uint32_t kAround = 192, kSection = 64;
  constexpr double kTurn = 2 * std::numbers::pi, kAngle = kTurn / kSection;
  const double minor = torus.minor_radius * std::sqrt(kAngle / std::sin(kAngle));
  Mesh mesh;
  for (std::uint32_t i = 0; i < kAround; ++i) {
    const double around = kTurn * i / kAround;
    for (std::uint32_t j = 0; j < kSection; ++j) {
      const double radius = torus.major_radius + minor * std::cos(kAngle * j);
      mesh.vertices.push_back({static_cast<float>(radius * std::cos(around)), static_cast<float>(radius * std::sin(around)),
                               static_cast<float>(minor * std::sin(kAngle * j))});
      const std::uint32_t p = i * kSection + j, q = i * kSection + (j + 1) % kSection;
      const std::uint32_t r = (p + kSection) % (kAround * kSection), s = (q + kSection) % (kAround * kSection);
      mesh.triangles.push_back({p, r, s});
      mesh.triangles.push_back({p, s, q});
    }
  }
  return mesh;
}

// Packs what area sampling sums over triangles. False: `object` is another solid.
bool packOutward(const Object& object, const SampleGrid& grid, PackedObjects& packed, layout::ObjectRecord& record) {
  const auto pack = [&](const Mesh& mesh) {
    std::optional<Mesh> outward;
    try {
      outward = outwardMesh(mesh);
    } catch (const Error& error) {
      throw Error(ErrorKind::kInput, "object '" + oneLine(object.name) + "': " + error.what());
    }
    if (!outward) {
      logWarning("object " + oneLine(object.name) +
                 " is a mesh that is not closed: depth_sampling: area takes its depth in the middle of each cell, as point does");
    }
    packMesh(outward ? *outward : mesh, outward.has_value(), grid, packed, record);
    return true;
  };
  if (const Mesh* mesh = std::get_if<Mesh>(&object.shape)) return pack(*mesh);
  if (const Box* box = std::get_if<Box>(&object.shape)) return pack(meshOf(*box));
  if (const Torus* torus = std::get_if<Torus>(&object.shape)) return pack(meshOf(*torus));
  return false;
}

// Of each object, the faces of a mesh that is a polyhedron.
std::vector<std::optional<std::vector<Face>>> polyhedra(std::span<const Object> objects) {
  std::vector<std::optional<std::vector<Face>>> faces(objects.size());
  for (std::size_t i = 0; i < objects.size(); ++i) {
    if (const Mesh* mesh = std::get_if<Mesh>(&objects[i].shape)) faces[i] = convexFaces(*mesh, kMaxFaces);
  }
  return faces;
}

void packFaces(const std::vector<Face>& faces, PackedObjects& packed, layout::ObjectRecord& record) {
  record.kind_groups = {layout::kKindPolyhedron, static_cast<std::uint32_t>(packed.faces.size()), 0u, 0u};
  for (std::size_t f = 0; f < packed.num_faces; ++f) {
    const auto& [normal, offset] = faces[f < faces.size() ? f : 0];
    packed.faces.emplace_back(normal[0], normal[1], normal[2], offset);
  }
}

// Kind and parameters of an analytic solid, as shaders/depth/solids.glsl reads them.
struct PackSolid {
  layout::ObjectRecord& record;

  void set(std::uint32_t kind, double a = 0, double b = 0, double c = 0) const {
    record.kind_groups = {kind, 0u, 0u, 0u};
    record.parameters = {static_cast<float>(a), static_cast<float>(b), static_cast<float>(c), 0.0f};
  }
  void operator()(const Mesh&) const {}
  void operator()(const Sphere& s) const { set(layout::kKindSphere, s.radius); }
  void operator()(const Cylinder& s) const { set(layout::kKindCylinder, s.radius, s.length / 2); }
  void operator()(const Capsule& s) const { set(layout::kKindCapsule, s.radius, s.length / 2); }
  void operator()(const Box& s) const { set(layout::kKindBox, s.size[0] / 2, s.size[1] / 2, s.size[2] / 2); }
  void operator()(const HalfSpace&) const { set(layout::kKindHalfSpace); }
  void operator()(const Cone& s) const { set(layout::kKindCone, s.radius, s.height); }
  void operator()(const Torus& s) const { set(layout::kKindTorus, s.major_radius, s.minor_radius); }
};

}  // namespace

PackedObjects packObjects(std::span<const Object> objects, const SampleGrid& grid, Shapes shapes) {
  PackedObjects packed;
  std::vector<std::optional<std::vector<Face>>> faces(objects.size());
  if (shapes == Shapes::kPolyhedra) faces = polyhedra(objects);
  for (const std::optional<std::vector<Face>>& of_one : faces) {
    if (of_one) packed.num_faces = std::max(packed.num_faces, static_cast<std::uint32_t>(of_one->size()));
  }
  for (std::size_t i = 0; i < objects.size(); ++i) {
    const Object& object = objects[i];
    layout::ObjectRecord record{};
    const Bounds bounds = boundsOf(object);
    for (int axis = 0; axis < 3; ++axis) {
      const double low = std::max<double>(bounds.min[axis], -kEndlessHeight);
      const double high = std::min<double>(bounds.max[axis], kEndlessHeight);
      record.center[axis] = static_cast<float>((low + high) / 2);
      record.half_size[axis] = static_cast<float>((high - low) / 2 * (1 + 1e-6));
    }
    const Mesh* mesh = std::get_if<Mesh>(&object.shape);
    const bool is_packed = shapes == Shapes::kOutward && packOutward(object, grid, packed, record);
    if (!is_packed && mesh == nullptr) {
      std::visit(PackSolid{record}, object.shape);
    } else if (!is_packed && faces[i]) {
      packFaces(*faces[i], packed, record);
    } else if (!is_packed) {
      packMesh(*mesh, false, grid, packed, record);
    }
    packed.objects.push_back(record);
  }
  return packed;
}

}  // namespace taxelsim
