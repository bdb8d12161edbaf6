#include "support/embree_oracle.h"

#include <embree3/rtcore.h>

#include "reference/samples.h"
#include "support/test.h"

namespace taxelsim::support {
namespace {

struct DeviceRelease {
  void operator()(RTCDevice device) const { rtcReleaseDevice(device); }
};
struct SceneRelease {
  void operator()(RTCScene scene) const { rtcReleaseScene(scene); }
};
using DeviceHandle = std::unique_ptr<RTCDeviceTy, DeviceRelease>;
using SceneHandle = std::unique_ptr<RTCSceneTy, SceneRelease>;

RTCDevice sharedDevice() {
  static const DeviceHandle device(rtcNewDevice("threads=1"));
  if (!device) {
    throw std::runtime_error("Embree gives no device");
  }
  return device.get();
}

}  // namespace

std::vector<double> embreeHeights(const GridPatch& patch, int samples_per_taxel, std::span<const reference::PlacedObject> objects) {
  const SceneHandle scene(rtcNewScene(sharedDevice()));
  rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);
  rtcSetSceneBuildQuality(scene.get(), RTC_BUILD_QUALITY_HIGH);
  double lowest = 0;
  const Pose X_PS = inverse(patch.X_SP);
  for (const reference::PlacedObject& placed : objects) {
    const Mesh& mesh = std::get<Mesh>(placed.object->shape);
    const RTCGeometry geometry = rtcNewGeometry(sharedDevice(), RTC_GEOMETRY_TYPE_TRIANGLE);
    auto* vertices = static_cast<float*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, 3 * sizeof(float), mesh.vertices.size()));
    const Pose X_PO = X_PS * placed.X_SO;
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
      const Vector3 p = X_PO * Vector3{mesh.vertices[v][0], mesh.vertices[v][1], mesh.vertices[v][2]};
      lowest = std::min(lowest, p[2]);
      std::transform(p.begin(), p.end(), vertices + 3 * v, [](double value) { return static_cast<float>(value); });
    }
    auto* triangles = static_cast<std::uint32_t*>(
        rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, 3 * sizeof(std::uint32_t), mesh.triangles.size()));
    for (const std::array<std::uint32_t, 3>& corners : mesh.triangles) {
      triangles = std::copy(corners.begin(), corners.end(), triangles);
    }
    rtcCommitGeometry(geometry);
    rtcAttachGeometry(scene.get(), geometry);
    rtcReleaseGeometry(geometry);
  }
  rtcCommitScene(scene.get());

  Sensor single;
  single.patches = {patch};
  single.samples_per_taxel = samples_per_taxel;
  const float start = static_cast<float>(lowest) - 1e-3f;  // below every object, not merely below the skin
  std::vector<double> heights;
  for (const reference::Sample& sample : reference::samplesOf(single)) {
    RTCIntersectContext context;
    rtcInitIntersectContext(&context);
    RTCRayHit ray{};
    ray.ray = {.org_x = static_cast<float>(sample.position_P[0]),
               .org_y = static_cast<float>(sample.position_P[1]),
               .org_z = start,
               .tnear = 0,
               .dir_x = 0,
               .dir_y = 0,
               .dir_z = 1,
               .time = 0,
               .tfar = std::numeric_limits<float>::infinity(),
               .mask = ~0u,
               .id = 0,
               .flags = 0};
    ray.hit.geomID = RTC_INVALID_GEOMETRY_ID;
    rtcIntersect1(scene.get(), &context, &ray);
    heights.push_back(ray.hit.geomID == RTC_INVALID_GEOMETRY_ID ? std::numeric_limits<double>::infinity()
                                                                : static_cast<double>(start) + static_cast<double>(ray.ray.tfar));
  }
  return heights;
}

}  // namespace taxelsim::support
