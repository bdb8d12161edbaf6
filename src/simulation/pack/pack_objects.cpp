#include "simulation/pack/pack_objects.h"

#include <algorithm>
#include <cmath>

#include "geometry/clusters.h"
#include "geometry/polyhedron.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

static_assert(layout::kLatticeBits == kLatticeBits && layout::kQuadsPerCluster == kQuadsPerCluster &&
              layout::kClustersPerGroup == kClustersPerGroup);

// Numbers of quads are 32-bit in GLSL.
constexpr std::uint32_t kMaxClusters = 1u << (layout::kFirstBits - 2);

// Stands for infinity in bounds; squares of it are finite floats.
constexpr float kEndless = 1e9f;

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

void packMesh(const Mesh& mesh, const SampleGrid& grid, PackedObjects& packed, layout::ObjectRecord& record) {
  const ClusteredMesh clustered = clusterMesh(mesh);
  const auto first_group = static_cast<std::uint32_t>(packed.groups.size());
  const auto first_cluster = static_cast<std::uint32_t>(packed.clusters.size());
  if (first_cluster + clustered.clusters.size() > kMaxClusters) {
    throw Error(ErrorKind::kInput,
                "the objects have more than " + std::to_string(kMaxClusters * kQuadsPerCluster) + " pairs of triangles together");
  }
  const Raster raster = chooseRaster(mesh, grid);
  record.kind_groups = {layout::kKindMesh, first_group, static_cast<std::uint32_t>(clustered.groups.size()),
                        static_cast<std::uint32_t>(raster.subpixel_bits) | (raster.large ? layout::kLargeTriangles : 0u)};
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

// The faces of all meshes if each of them is a polyhedron, else nothing: rastering all meshes is faster than both paths in one model.
std::vector<std::vector<Face>> polyhedra(std::span<const Object> objects) {
  std::vector<std::vector<Face>> all;
  for (const Object& object : objects) {
    const Mesh* mesh = std::get_if<Mesh>(&object.shape);
    if (mesh == nullptr) continue;
    const std::optional<std::vector<Face>> faces = convexFaces(*mesh, kMaxFaces);
    if (!faces) return {};
    all.push_back(*faces);
  }
  return all;
}

void packFaces(const std::vector<Face>& faces, PackedObjects& packed, layout::ObjectRecord& record) {
  record.kind_groups = {layout::kKindPolyhedron, static_cast<std::uint32_t>(packed.faces.size()), 0u, 0u};
  for (std::size_t f = 0; f < packed.num_faces; ++f) {
    const auto& [normal, offset] = faces[f < faces.size() ? f : 0];
    packed.faces.emplace_back(normal[0], normal[1], normal[2], offset);
  }
}

// Kind and parameters of an analytic solid, as shaders/depth/analytic.glsl reads them.
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

PackedObjects packObjects(std::span<const Object> objects, const SampleGrid& grid, bool with_polyhedra) {
  PackedObjects packed;
  const std::vector<std::vector<Face>> faces = with_polyhedra ? polyhedra(objects) : std::vector<std::vector<Face>>{};
  for (const std::vector<Face>& of_one : faces) packed.num_faces = std::max(packed.num_faces, static_cast<std::uint32_t>(of_one.size()));
  std::size_t num_meshes = 0;
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
    if (const Mesh* mesh = std::get_if<Mesh>(&object.shape)) {
      if (faces.empty()) {
        packMesh(*mesh, grid, packed, record);
      } else {
        packFaces(faces[num_meshes++], packed, record);
      }
    }
    packed.objects.push_back(record);
  }
  return packed;
}

}  // namespace taxelsim
