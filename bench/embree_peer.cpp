#include "embree_peer.h"

#include <embree3/rtcore.h>
#include <immintrin.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <thread>

#include "taxelsim/error.h"

namespace taxelsim::bench {
namespace {

constexpr int kSide = 4;     // samples per taxel, per side
constexpr int kPacket = 16;  // rays of one taxel
constexpr int kReach = 1;    // of the 3 x 3 PSF, taxels
constexpr int kBlock = 16;   // instances that a thread takes at a time
constexpr int kMaxTaxels = 1024;
constexpr float kPi = std::numbers::pi_v<float>;

struct Vec3f {
  float x, y, z;
};

}  // namespace

struct EmbreePeer::Impl {
  int num_rows, num_cols, num_taxels, padded_cols, num_threads;
  float pitch_x, pitch_y, thickness, sample_force;  // sample_force: N per m of penetration
  float gain, trigger, saturation, taxel_area;
  bool skip_beside;
  std::array<float, 9> kernel;
  std::vector<float> inverse_divisor;   // (num_taxels): 1 / what of the kernel lies inside, seen from a source
  std::vector<float> taxel_x, taxel_y;  // (num_taxels), m
  std::vector<float> force_of_counts;   // (saturation + 1), N
  std::array<Vec3f, 8> corners;         // of the mesh's box, in O
  RTCDevice device = nullptr;
  RTCScene scene = nullptr;

  // Buffers of one thread, on cache lines of their own.
  struct alignas(64) Scratch {
    RTCRayHit16 packet;
    alignas(64) float taxel_force[kMaxTaxels];
    alignas(64) float padded[4 * kMaxTaxels];
    alignas(64) float spread[kMaxTaxels];
    alignas(64) float measured[kMaxTaxels];
  };

  ~Impl() {
    if (scene) rtcReleaseScene(scene);
    if (device) rtcReleaseDevice(device);
  }

  void build(const Mesh& mesh);
  void castRays(const Pose& X_SO, Scratch& scratch) const;
  void spreadForces(Scratch& scratch) const;
  PeerFeatures featuresOf(const float* force, int num_touched) const;
  void frameOf(int i, const Pose& X_SO, Scratch& scratch, PeerFrame& frame) const;
};

void EmbreePeer::Impl::build(const Mesh& mesh) {
  device = rtcNewDevice(nullptr);
  scene = rtcNewScene(device);
  rtcSetSceneBuildQuality(scene, RTC_BUILD_QUALITY_HIGH);
  rtcSetSceneFlags(scene, RTC_SCENE_FLAG_NONE);
  const RTCGeometry geometry = rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE);
  rtcSetGeometryBuildQuality(geometry, RTC_BUILD_QUALITY_HIGH);
  void* vertices =
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(mesh.vertices[0]), mesh.vertices.size());
  std::copy(mesh.vertices.begin(), mesh.vertices.end(), static_cast<std::array<float, 3>*>(vertices));
  void* indices =
      rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, sizeof(mesh.triangles[0]), mesh.triangles.size());
  std::copy(mesh.triangles.begin(), mesh.triangles.end(), static_cast<std::array<std::uint32_t, 3>*>(indices));
  rtcCommitGeometry(geometry);
  rtcAttachGeometry(scene, geometry);
  rtcReleaseGeometry(geometry);
  rtcCommitScene(scene);

  RTCBounds box;
  rtcGetSceneBounds(scene, &box);
  for (int c = 0; c < 8; ++c)
    corners[c] = {c & 1 ? box.upper_x : box.lower_x, c & 2 ? box.upper_y : box.lower_y, c & 4 ? box.upper_z : box.lower_z};
}

// Stages 1 and 2. A ray starts at the bottom of the skin and ends at its surface, so what is left of it is the penetration.
void EmbreePeer::Impl::castRays(const Pose& X_SO, Scratch& scratch) const {
  const std::array<double, 9> R = rotationMatrix(X_SO.rotation);
  const auto r = [&](int row, int column) { return static_cast<float>(R[3 * row + column]); };
  const Vec3f p{static_cast<float>(X_SO.position[0]), static_cast<float>(X_SO.position[1]), static_cast<float>(X_SO.position[2])};

  std::fill_n(scratch.taxel_force, num_taxels, 0.0f);
  int first_row = 0, last_row = num_rows - 1, first_col = 0, last_col = num_cols - 1;
  if (skip_beside) {
    // The box of the object in S.
    Vec3f low{1e30f, 1e30f, 1e30f}, high{-1e30f, -1e30f, -1e30f};
    for (const Vec3f& c : corners) {
      const Vec3f q{r(0, 0) * c.x + r(0, 1) * c.y + r(0, 2) * c.z + p.x, r(1, 0) * c.x + r(1, 1) * c.y + r(1, 2) * c.z + p.y,
                    r(2, 0) * c.x + r(2, 1) * c.y + r(2, 2) * c.z + p.z};
      low = {std::min(low.x, q.x), std::min(low.y, q.y), std::min(low.z, q.z)};
      high = {std::max(high.x, q.x), std::max(high.y, q.y), std::max(high.z, q.z)};
    }
    if (low.z > 0 || high.z < -thickness) return;
    first_row = std::max(0, static_cast<int>(std::floor(low.x / pitch_x + 0.5f * num_rows)));
    last_row = std::min(num_rows - 1, static_cast<int>(std::floor(high.x / pitch_x + 0.5f * num_rows)));
    first_col = std::max(0, static_cast<int>(std::floor(low.y / pitch_y + 0.5f * num_cols)));
    last_col = std::min(num_cols - 1, static_cast<int>(std::floor(high.y / pitch_y + 0.5f * num_cols)));
  }

  // Columns of R_OS: the axes of S in O.
  const Vec3f x_O{r(0, 0), r(0, 1), r(0, 2)}, y_O{r(1, 0), r(1, 1), r(1, 2)}, z_O{r(2, 0), r(2, 1), r(2, 2)};
  alignas(64) float offset_x[kPacket], offset_y[kPacket], offset_z[kPacket];
  for (int k = 0; k < kPacket; ++k) {
    const float x = ((static_cast<float>(k / kSide) + 0.5f) / kSide - 0.5f) * pitch_x;
    const float y = ((static_cast<float>(k % kSide) + 0.5f) / kSide - 0.5f) * pitch_y;
    offset_x[k] = x * x_O.x + y * y_O.x;
    offset_y[k] = x * x_O.y + y * y_O.y;
    offset_z[k] = x * x_O.z + y * y_O.z;
  }

  alignas(64) static constexpr std::array<int, kPacket> kAllValid{-1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1, -1};
  RTCRayHit16& packet = scratch.packet;
  for (int i = first_row; i <= last_row; ++i) {
    for (int j = first_col; j <= last_col; ++j) {
      const int taxel = i * num_cols + j;
      const float dx = taxel_x[taxel] - p.x, dy = taxel_y[taxel] - p.y, dz = -thickness - p.z;
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
      rtcIntersect16(kAllValid.data(), scene, &context, &packet);
      float depth = 0;
      for (int k = 0; k < kPacket; ++k) depth += thickness - packet.ray.tfar[k];
      scratch.taxel_force[taxel] = sample_force * depth;
    }
  }
}

// Stage 3, in an array with a border of one taxel so that no tap needs a test.
void EmbreePeer::Impl::spreadForces(Scratch& scratch) const {
  for (int i = 0; i < num_rows; ++i) {
    float* row = scratch.padded + (i + kReach) * padded_cols + kReach;
    for (int j = 0; j < num_cols; ++j) row[j] = scratch.taxel_force[i * num_cols + j] * inverse_divisor[i * num_cols + j];
  }
  for (int i = 0; i < num_rows; ++i) {
    for (int j = 0; j < num_cols; ++j) {
      float sum = 0;
      for (int a = -kReach; a <= kReach; ++a) {
        for (int b = -kReach; b <= kReach; ++b) {
          sum += scratch.padded[(i + kReach - a) * padded_cols + j + kReach - b] * kernel[(a + kReach) * 3 + b + kReach];
        }
      }
      scratch.spread[i * num_cols + j] = sum;
    }
  }
}

// Stage 6.
PeerFeatures EmbreePeer::Impl::featuresOf(const float* force, int num_touched) const {
  PeerFeatures features;
  float sum = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0, peak = 0;
  for (int t = 0; t < num_taxels; ++t) {
    const float f = force[t], fx = f * taxel_x[t], fy = f * taxel_y[t];
    sum += f;
    x += fx;
    y += fy;
    xx += fx * taxel_x[t];
    xy += fx * taxel_y[t];
    yy += fy * taxel_y[t];
    peak = std::max(peak, f);
  }
  features.total_force = sum;
  features.peak_force = peak;
  features.contact_area = static_cast<float>(num_touched) * taxel_area;
  if (sum <= 0) return features;
  const float mx = x / sum, my = y / sum;
  xx = xx / sum - mx * mx;
  xy = xy / sum - mx * my;
  yy = yy / sum - my * my;
  const float middle = (xx + yy) / 2, radius = std::sqrt((xx - yy) * (xx - yy) / 4 + xy * xy);
  features.center_of_pressure[0] = mx;
  features.center_of_pressure[1] = my;
  features.second_moments[0] = xx;
  features.second_moments[1] = xy;
  features.second_moments[2] = yy;
  features.eigenvalues[0] = middle + radius;
  features.eigenvalues[1] = std::max(0.0f, middle - radius);
  if (radius > 0) {
    features.edge_angle = std::atan2(2 * xy, xx - yy) / 2;
    if (features.edge_angle <= -kPi / 2) features.edge_angle += kPi;
    features.edge_confidence = (features.eigenvalues[0] - features.eigenvalues[1]) / (features.eigenvalues[0] + features.eigenvalues[1]);
  }
  return features;
}

void EmbreePeer::Impl::frameOf(int i, const Pose& X_SO, Scratch& scratch, PeerFrame& frame) const {
  castRays(X_SO, scratch);
  spreadForces(scratch);
  float* spread = frame.spread_force.data() + static_cast<std::size_t>(i) * num_taxels;
  std::uint32_t* image = frame.tactile_image.data() + static_cast<std::size_t>(i) * num_taxels;
  int num_clean = 0, num_measured = 0;
  for (int t = 0; t < num_taxels; ++t) {
    spread[t] = scratch.spread[t];
    num_clean += scratch.spread[t] > trigger;
    // Stage 5: a straight curve, rounded half away from zero.
    const float counts = std::min(std::max(gain * (scratch.spread[t] - trigger), 0.0f), saturation);
    image[t] = static_cast<std::uint32_t>(counts + 0.5f);
    num_measured += image[t] > 0;
    scratch.measured[t] = force_of_counts[image[t]];
  }
  frame.clean[i] = featuresOf(scratch.spread, num_clean);
  frame.measured[i] = featuresOf(scratch.measured, num_measured);
}

EmbreePeer::EmbreePeer(const Sensor& sensor, const Mesh& mesh, Rays rays, int threads) : impl_(std::make_unique<Impl>()) {
  checkSensor(sensor);
  const Winkler* law = std::get_if<Winkler>(&sensor.skin.law);
  const bool plain = sensor.patches.size() == 1 && sensor.patches[0].X_SP == Pose{} && sensor.samples_per_taxel == kSide && law &&
                     law->normal_exponent == 1 && law->normal_damping == 0 && sensor.psf.size == 2 * kReach + 1 &&
                     sensor.psf.normalization == Psf::Normalization::kPerSource && sensor.readout.curve.size() == 1 &&
                     sensor.readout.curve_limit == 0 && sensor.readout.curve_points.empty() && sensor.readout.noise == 0 &&
                     sensor.readout.taxel_gain.empty() && sensor.readout.taxel_trigger.empty() && numTaxels(sensor) <= kMaxTaxels;
  if (!plain) {
    throw Error(ErrorKind::kInput, sensor.name +
                                       ": the Embree peer does one grid patch at the origin with 4 x 4 samples, linear springs, a 3 x 3 "
                                       "PSF per source and a straight, noiseless curve only");
  }
  Impl& impl = *impl_;
  const GridPatch& patch = sensor.patches[0];
  impl.skip_beside = rays == Rays::kUnderBox;
  impl.num_rows = patch.num_rows;
  impl.num_cols = patch.num_cols;
  impl.num_taxels = patch.num_rows * patch.num_cols;
  impl.padded_cols = patch.num_cols + 2 * kReach;
  impl.num_threads = threads > 0 ? threads : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
  impl.pitch_x = static_cast<float>(patch.pitch[0]);
  impl.pitch_y = static_cast<float>(patch.pitch[1]);
  impl.thickness = static_cast<float>(sensor.skin.thickness);
  impl.taxel_area = static_cast<float>(patch.pitch[0] * patch.pitch[1]);
  impl.sample_force = static_cast<float>(law->normal_contact_stiffness * patch.pitch[0] * patch.pitch[1] / kPacket);
  impl.gain = static_cast<float>(sensor.readout.output_scale * sensor.readout.curve[0]);
  impl.trigger = static_cast<float>(sensor.readout.trigger);
  impl.saturation = static_cast<float>(sensor.readout.saturation);
  for (int k = 0; k < 9; ++k) impl.kernel[k] = static_cast<float>(sensor.psf.kernel[k]);
  for (int i = 0; i < impl.num_rows; ++i) {
    for (int j = 0; j < impl.num_cols; ++j) {
      impl.taxel_x.push_back(static_cast<float>((i - (impl.num_rows - 1) / 2.0) * patch.pitch[0]));
      impl.taxel_y.push_back(static_cast<float>((j - (impl.num_cols - 1) / 2.0) * patch.pitch[1]));
      double divisor = 0;
      for (int a = -kReach; a <= kReach; ++a) {
        for (int b = -kReach; b <= kReach; ++b) {
          const bool inside = i + a >= 0 && i + a < impl.num_rows && j + b >= 0 && j + b < impl.num_cols;
          divisor += inside ? sensor.psf.kernel[(a + kReach) * 3 + b + kReach] : 0;
        }
      }
      impl.inverse_divisor.push_back(static_cast<float>(1 / divisor));
    }
  }
  for (int counts = 0; counts <= sensor.readout.saturation; ++counts) {
    impl.force_of_counts.push_back(static_cast<float>(nominalForce(sensor.readout, counts)));
  }
  impl.build(mesh);
}

EmbreePeer::~EmbreePeer() = default;

int EmbreePeer::numThreads() const {
  return impl_->num_threads;
}

void EmbreePeer::run(std::span<const Pose> X_SO, PeerFrame& frame) {
  const Impl& impl = *impl_;
  const int num_instances = static_cast<int>(X_SO.size());
  frame.spread_force.resize(X_SO.size() * impl.num_taxels);
  frame.tactile_image.resize(X_SO.size() * impl.num_taxels);
  frame.measured.resize(X_SO.size());
  frame.clean.resize(X_SO.size());

  std::atomic<int> next{0};
  const auto work = [&] {
    // As Embree's manual asks.
    _MM_SET_FLUSH_ZERO_MODE(_MM_FLUSH_ZERO_ON);
    _MM_SET_DENORMALS_ZERO_MODE(_MM_DENORMALS_ZERO_ON);
    const auto scratch = std::make_unique<Impl::Scratch>();
    for (int begin; (begin = next.fetch_add(kBlock)) < num_instances;) {
      for (int i = begin; i < std::min(begin + kBlock, num_instances); ++i) impl.frameOf(i, X_SO[i], *scratch, frame);
    }
  };
  std::vector<std::jthread> threads;
  for (int t = 0; t < impl.num_threads; ++t) threads.emplace_back(work);
}

}  // namespace taxelsim::bench
