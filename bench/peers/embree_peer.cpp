#include "peers/embree_peer.h"

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "peers/taxel_stage.h"
#include "peers/threads.h"

namespace taxelsim::bench {
namespace {

constexpr int kSide = 4;     // samples per taxel, per side
constexpr int kPacket = 16;  // rays of one taxel
constexpr int kBlock = 16;   // instances per work item of a thread

struct Vec3f {
  float x, y, z;
};

struct MeshScene {
  RTCScene scene = nullptr;
  std::array<Vec3f, 8> corners;  // of the mesh's box, in O
};

struct TaxelRect {
  int first_row, last_row, first_col, last_col;
};

MeshScene sceneOf(RTCDevice device, const Mesh& mesh) {
  MeshScene made;
  made.scene = rtcNewScene(device);
  rtcSetSceneBuildQuality(made.scene, RTC_BUILD_QUALITY_HIGH);
  rtcSetSceneFlags(made.scene, RTC_SCENE_FLAG_NONE);
  const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_HIGH);
  void* vertices =
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(mesh.vertices[0]), mesh.vertices.size());
  std::copy(mesh.vertices.begin(), mesh.vertices.end(), static_cast<std::array<float, 3>*>(vertices));
  void* indices =
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(mesh.triangles[0]), mesh.triangles.size());
  std::copy(mesh.triangles.begin(), mesh.triangles.end(), static_cast<std::array<std::uint32_t, 3>*>(indices));
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(made.scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(made.scene);
  RTCBounds box;
  rtcGetSceneBounds(made.scene, &box);
  for (int c = 0; c < 8; ++c)
    made.corners[c] = {c & 1 ? box.upper_x : box.lower_x, c & 2 ? box.upper_y : box.lower_y, c & 4 ? box.upper_z : box.lower_z};
  return made;
}

}  // namespace

struct EmbreePeer::Impl {
  Impl(const Sensor& sensor, Rays which, int threads, int per_side)
      : stage(sensor), rays(which), num_threads(threadsOf(threads)), rays_per_side(per_side) {}
  ~Impl() {
    for (const MeshScene& object : objects) rtcReleaseScene(object.scene);
    if (device) rtcReleaseDevice(device);
  }

  struct alignas(64) Scratch {
    RTCRayHit16 packet;
    TaxelStage::Scratch taxels;
  };

  TaxelRect rectUnder(const MeshScene& object, const std::array<double, 9>& R, const Vec3f& p) const;
  TaxelRect castRays(const MeshScene& object, const Pose& X_SO, Scratch& scratch) const;
  void castRays(const MeshScene& object, const Pose& X_SO, const TaxelRect& rect, std::array<float, 2> in_cell, Scratch& scratch) const;

  TaxelStage stage;
  Rays rays;
  int num_threads;
  int rays_per_side;  // of a cell
  RTCDevice device = nullptr;
  std::vector<MeshScene> objects;
  std::vector<std::unique_ptr<Scratch>> scratches;  // (num_threads)
};

// Taxels under the object's rotated box.
TaxelRect EmbreePeer::Impl::rectUnder(const MeshScene& object, const std::array<double, 9>& R, const Vec3f& p) const {
  const auto r = [&](int row, int column) { return static_cast<float>(R[3 * row + column]); };
  const TaxelRect none{0, -1, 0, -1};
  Vec3f low{1e30f, 1e30f, 1e30f}, high{-1e30f, -1e30f, -1e30f};
  for (const Vec3f& c : object.corners) {
    const Vec3f q{r(0, 0) * c.x + r(0, 1) * c.y + r(0, 2) * c.z + p.x, r(1, 0) * c.x + r(1, 1) * c.y + r(1, 2) * c.z + p.y,
                  r(2, 0) * c.x + r(2, 1) * c.y + r(2, 2) * c.z + p.z};
    low = {std::min(low.x, q.x), std::min(low.y, q.y), std::min(low.z, q.z)};
    high = {std::max(high.x, q.x), std::max(high.y, q.y), std::max(high.z, q.z)};
  }
  if (low.z > 0 || high.z < -stage.thickness()) return none;
  const auto taxel = [](float x, float pitch, int count) {
    return static_cast<int>(std::floor(x / pitch + 0.5f * static_cast<float>(count)));
  };
  return {std::max(0, taxel(low.x, stage.pitchX(), stage.numRows())),
          std::min(stage.numRows() - 1, taxel(high.x, stage.pitchX(), stage.numRows())),
          std::max(0, taxel(low.y, stage.pitchY(), stage.numCols())),
          std::min(stage.numCols() - 1, taxel(high.y, stage.pitchY(), stage.numCols()))};
}

// Stages 1 and 2.
TaxelRect EmbreePeer::Impl::castRays(const MeshScene& object, const Pose& X_SO, Scratch& scratch) const {
  const Vec3f p{static_cast<float>(X_SO.position[0]), static_cast<float>(X_SO.position[1]), static_cast<float>(X_SO.position[2])};
  const TaxelRect rect = rays == Rays::kUnderBox ? rectUnder(object, rotationMatrix(X_SO.rotation), p)
                                                 : TaxelRect{0, stage.numRows() - 1, 0, stage.numCols() - 1};
  for (int i = rect.first_row; i <= rect.last_row; ++i)
    for (int j = rect.first_col; j <= rect.last_col; ++j) stage.force(scratch.taxels, i, j) = 0;
  const auto place = [&](int k) { return (static_cast<float>(k) + 0.5f) / static_cast<float>(rays_per_side); };
  for (int a = 0; a < rays_per_side; ++a)
    for (int b = 0; b < rays_per_side; ++b) castRays(object, X_SO, rect, {place(a), place(b)}, scratch);
  return rect;
}

// Adds the forces of one ray of every sample, at a place of its cell. A ray runs from the bottom of the skin to its surface; the part
// beyond the hit is the penetration.
void EmbreePeer::Impl::castRays(const MeshScene& object, const Pose& X_SO, const TaxelRect& rect, std::array<float, 2> in_cell,
                                Scratch& scratch) const {
  const std::array<double, 9> R = rotationMatrix(X_SO.rotation);
  const auto r = [&](int row, int column) { return static_cast<float>(R[3 * row + column]); };
  const Vec3f p{static_cast<float>(X_SO.position[0]), static_cast<float>(X_SO.position[1]), static_cast<float>(X_SO.position[2])};
  const float force_per_depth = stage.sampleForce() / static_cast<float>(rays_per_side * rays_per_side);

  // Columns of R_OS: the axes of S in O.
  const Vec3f x_O{r(0, 0), r(0, 1), r(0, 2)}, y_O{r(1, 0), r(1, 1), r(1, 2)}, z_O{r(2, 0), r(2, 1), r(2, 2)};
  const float thickness = stage.thickness();
  alignas(64) float offset_x[kPacket], offset_y[kPacket], offset_z[kPacket];
  for (int k = 0; k < kPacket; ++k) {
    const int row = k / kSide, col = k % kSide;
    const float x = ((static_cast<float>(row) + in_cell[0]) / kSide - 0.5f) * stage.pitchX();
    const float y = ((static_cast<float>(col) + in_cell[1]) / kSide - 0.5f) * stage.pitchY();
    offset_x[k] = x * x_O.x + y * y_O.x;
    offset_y[k] = x * x_O.y + y * y_O.y;
    offset_z[k] = x * x_O.z + y * y_O.z;
  }

  alignas(64) static constexpr std::array<int, kPacket> kAllValid{-1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1};
  RTCRayHit16& packet = scratch.packet;
  for (int i = rect.first_row; i <= rect.last_row; ++i) {
    for (int j = rect.first_col; j <= rect.last_col; ++j) {
      const float dx = (static_cast<float>(i) - 0.5f * static_cast<float>(stage.numRows() - 1)) * stage.pitchX() - p.x;
      const float dy = (static_cast<float>(j) - 0.5f * static_cast<float>(stage.numCols() - 1)) * stage.pitchY() - p.y;
      const float dz = -thickness - p.z;
      const Vec3f o{dx * x_O.x + dy * y_O.x + dz * z_O.x, dx * x_O.y + dy * y_O.y + dz * z_O.y, dx * x_O.z + dy * y_O.z + dz * z_O.z};
      for (int k = 0; k < kPacket; ++k) {
        packet.ray.org_x[k] = o.x + offset_x[k];
        packet.ray.org_y[k] = o.y + offset_y[k];
        packet.ray.org_z[k] = o.z + offset_z[k];
        packet.ray.dir_x[k] = z_O.x;
        packet.ray.dir_y[k] = z_O.y;
        packet.ray.dir_z[k] = z_O.z;
        packet.ray.tnear[k] = 0;
        packet.ray.tfar[k] = thickness;
        packet.ray.time[k] = 0;
        packet.ray.mask[k] = ~0u;
        packet.ray.flags[k] = 0;
        packet.hit.geomID[k] = RTC_INVALID_GEOMETRY_ID;
        packet.hit.instID[0][k] = RTC_INVALID_GEOMETRY_ID;
      }
      RTCIntersectContext context;
      rtcInitIntersectContext(&context);
      context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
      rtcIntersect16(kAllValid.data(), object.scene, &context, &packet);
      float depth = 0;
      for (int k = 0; k < kPacket; ++k) depth += thickness - packet.ray.tfar[k];
      stage.force(scratch.taxels, i, j) += force_per_depth * depth;
    }
  }
}

EmbreePeer::EmbreePeer(const Sensor& sensor, const std::vector<const Mesh*>& meshes, Rays rays, int num_threads, int rays_per_side)
    : impl_(std::make_unique<Impl>(sensor, rays, num_threads, rays_per_side)) {
  impl_->device = rtcNewDevice(nullptr);
  for (const Mesh* mesh : meshes) impl_->objects.push_back(sceneOf(impl_->device, *mesh));
  for (int t = 0; t < impl_->num_threads; ++t) {
    impl_->scratches.push_back(std::make_unique<Impl::Scratch>());
    impl_->scratches.back()->taxels = impl_->stage.scratch();
  }
}

EmbreePeer::~EmbreePeer() = default;

std::string EmbreePeer::name() const {
  return impl_->rays == Rays::kAll ? "embree" : "embree_box";
}

std::string EmbreePeer::what() const {
  return impl_->rays == Rays::kAll ? "Embree 3, 16-ray packets, every sample" : "Embree 3, 16-ray packets, taxels under the object's box";
}

void EmbreePeer::run(std::span<const int> ids, std::span<const Pose> X_SO, PeerFrame& frame) {
  const Impl& impl = *impl_;
  frame.resize(X_SO.size(), static_cast<std::size_t>(impl.stage.numTaxels()));
  inThreads(impl.num_threads, static_cast<int>(X_SO.size()), kBlock, [&](int thread, int instance) {
    const auto i = static_cast<std::size_t>(instance);
    Impl::Scratch& scratch = *impl.scratches[static_cast<std::size_t>(thread)];
    const TaxelRect rect = impl.castRays(impl.objects[static_cast<std::size_t>(ids[i])], X_SO[i], scratch);
    impl.stage.finish(scratch.taxels, rect.first_row, rect.last_row, i, frame);
  });
}

}  // namespace taxelsim::bench
