#include "simulation/pack_objects.h"

#include <algorithm>
#include <bit>

#include "geometry/clusters.h"

namespace taxelsim {
namespace {

static_assert(layout::kLatticeBits == kLatticeBits && layout::kTrianglesPerCluster == kTrianglesPerCluster &&
              layout::kClustersPerGroup == kClustersPerGroup);

// Stands for infinity in bounds; squares of it are finite floats.
constexpr float kEndless = 1e9f;

float asFloat(std::uint32_t bits) { return std::bit_cast<float>(bits); }

layout::BoundsRecord packBox(const ClusterBox& box, std::uint32_t offset) {
  return {{box.center[0], box.center[1], box.center[2], asFloat(box.first + offset)},
          {box.half_size[0], box.half_size[1], box.half_size[2], asFloat(box.count)}};
}

void packMesh(const Mesh& mesh, PackedObjects& packed, layout::ObjectRecord& record) {
  const ClusteredMesh clustered = clusterMesh(mesh);
  const auto first_group = static_cast<std::uint32_t>(packed.groups.size());
  const auto first_cluster = static_cast<std::uint32_t>(packed.clusters.size());
  const auto first_triangle = static_cast<std::uint32_t>(packed.triangles.size() / layout::kTriangleWords);
  record.kind_groups = {layout::kKindMesh, first_group, static_cast<std::uint32_t>(clustered.groups.size()), 0u};
  record.lattice = {static_cast<float>(clustered.middle[0]), static_cast<float>(clustered.middle[1]), static_cast<float>(clustered.middle[2]),
                    static_cast<float>(clustered.step)};
  for (const ClusterBox& group : clustered.groups) packed.groups.push_back(packBox(group, first_cluster));
  for (const ClusterBox& cluster : clustered.clusters) packed.clusters.push_back(packBox(cluster, first_triangle));
  for (const auto& triangle : clustered.triangles) {
    for (const LatticePoint& q : triangle) {
      packed.triangles.push_back(q[0] | q[1] << kLatticeBits);
      packed.triangles.push_back(q[1] >> (32 - kLatticeBits) | q[2] << (2 * kLatticeBits - 32));
    }
  }
}

// Kind and parameters of an analytic solid, as shaders/lib/analytic.glsl reads them.
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

PackedObjects packObjects(std::span<const Object> objects) {
  PackedObjects packed;
  for (const Object& object : objects) {
    layout::ObjectRecord record{};
    const Bounds bounds = boundsOf(object);
    for (int axis = 0; axis < 3; ++axis) {
      const double low = std::max<double>(bounds.min[axis], -kEndless);
      const double high = std::min<double>(bounds.max[axis], kEndless);
      record.center[axis] = static_cast<float>((low + high) / 2);
      record.half_size[axis] = static_cast<float>((high - low) / 2 * (1 + 1e-6));
    }
    std::visit(PackSolid{record}, object.shape);
    if (const Mesh* mesh = std::get_if<Mesh>(&object.shape)) packMesh(*mesh, packed, record);
    packed.objects.push_back(record);
  }
  return packed;
}

}  // namespace taxelsim
