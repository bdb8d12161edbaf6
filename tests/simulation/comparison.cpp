#include "simulation/comparison.h"

#include "base/vector3.h"
#include "reference/features.h"
#include "reference/readout.h"
#include "simulation/raster.h"
#include "support/test.h"

namespace taxelsim::support {
namespace {

template <typename T>
std::span<const T> sliceOf(std::span<const T> all, int instance, int num_instances) {
  const std::size_t per_instance = all.size() / static_cast<std::size_t>(num_instances);
  return all.subspan(static_cast<std::size_t>(instance) * per_instance, per_instance);
}

// The bits of the arrays of one instance.
class Bits {
 public:
  Bits(int instance, int num_instances) : instance_(instance), num_instances_(num_instances) {}

  template <typename T>
  void add(std::span<const T> all) {
    for (const T value : sliceOf(all, instance_, num_instances_)) {
      if constexpr (std::is_same_v<T, float>) {
        bits_.push_back(std::bit_cast<std::uint32_t>(value));
      } else {
        bits_.push_back(static_cast<std::uint32_t>(value));
      }
    }
  }

// Statements for the rows of taxelsim/feature_table.h and output_table.h: adds the array of `view`.
#define TAXELSIM_BITS(constant, name, ...) add(view.name);
#define TAXELSIM_TAXEL_BITS(name, ...) add(view.name);
  void addFeatures(const FeatureView& view) {
    TAXELSIM_IMAGE_FEATURES(TAXELSIM_BITS)
  }
  void add(const ContactFeatureView& view) {
    addFeatures(view);
    TAXELSIM_CONTACT_FEATURES(TAXELSIM_BITS)
    TAXELSIM_REGION_FEATURES(TAXELSIM_BITS)
  }
  void add(const TactileJacobianView& view) {
    TAXELSIM_JACOBIAN_FEATURES(TAXELSIM_BITS)
  }
  void addMeasured(const FrameView& view) {
    add(view.tactile_image);
    addFeatures(view);
    TAXELSIM_READOUT_FEATURES(TAXELSIM_BITS)
    TAXELSIM_MEASURED_TAXELS(TAXELSIM_TAXEL_BITS)
    add(view.contact);
    add(view.jacobian);
  }
  void addTruth(const GroundTruthView& view) {
    addFeatures(view);
    TAXELSIM_TRUTH_FEATURES(TAXELSIM_BITS)
    TAXELSIM_TRUE_TAXELS(TAXELSIM_TAXEL_BITS)
    add(view.contact);
    add(view.jacobian);
    add(view.jacobian.contact_wrench);
  }

  std::vector<std::uint32_t> take() {
    return std::move(bits_);
  }

 private:
  int instance_, num_instances_;
  std::vector<std::uint32_t> bits_;
};

void expectFinite(std::span<const float> values, std::size_t size, const char* name) {
  EXPECT_EQ(values.size(), size) << name;
  EXPECT_TRUE(std::all_of(values.begin(), values.end(), [](float value) { return std::isfinite(value); })) << name;
}

void expectFeaturesWellFormed(const FeatureView& view, std::size_t n) {
#define TAXELSIM_FINITE(constant, name, offset, width, ...) expectFinite(view.name, width* n, #name);
  TAXELSIM_IMAGE_FEATURES(TAXELSIM_FINITE)
}

// Reports the number of taxels outside their bounds and the first of them: one message instead of thousands.
void expectInside(std::span<const float> values, const Bounded& bounds, double relative, double absolute, const char* name) {
  ASSERT_EQ(values.size(), bounds.low.size()) << name;
  std::size_t num_outside = 0, first = 0;
  for (std::size_t t = values.size(); t-- > 0;) {
    const double low = bounds.low[t] - relative * std::abs(bounds.low[t]) - absolute;
    const double high = bounds.high[t] + relative * std::abs(bounds.high[t]) + absolute;
    if (!(values[t] >= low && values[t] <= high)) {
      ++num_outside;
      first = t;
    }
  }
  EXPECT_EQ(num_outside, 0u) << name << "[" << first << "] = " << values[first] << " is outside [" << bounds.low[first] << ", "
                             << bounds.high[first] << "]";
}

// Largest coordinate of a taxel centre or half the size of the array, m: the length that errors of moments are relative to.
double largestCoordinateOf(const Sensor& sensor) {
  double extent = 0;
  for (const Vector3& p : taxelPositions(sensor)) {
    extent = std::max({extent, std::abs(p[0]), std::abs(p[1]), std::abs(p[2])});
  }
  for (const GridPatch& patch : sensor.patches) {
    extent = std::max({extent, patch.pitch[0] * patch.num_rows / 2, patch.pitch[1] * patch.num_cols / 2});
  }
  return extent;
}

void expectFeatures(const FeatureView& view, int instance, const Sensor& sensor, const reference::Features& expected, double relative,
                    double area_slack, const char* which) {
  SCOPED_TRACE(which);
  const double extent = largestCoordinateOf(sensor);
  const double force = expected.total_force;
  EXPECT_NEAR(view.total_force[instance], force, relative * force + kAbsoluteForce);
  EXPECT_NEAR(view.peak_force[instance], expected.peak_force, relative * expected.peak_force);
  EXPECT_NEAR(view.contact_area[instance], expected.contact_area, area_slack + relative * expected.contact_area);
  if (force <= 0) {
    for (int axis = 0; axis < 3; ++axis) {
      EXPECT_EQ(view.center_of_pressure[3 * instance + axis], 0);
      EXPECT_EQ(view.second_moments[3 * instance + axis], 0);
    }
    EXPECT_EQ(view.edge_angle[instance], 0);
    EXPECT_EQ(view.edge_confidence[instance], 0);
    return;
  }
  // Fixed-point sums are rounded to their last place, relative to the whole force.
  const double rounding = relative + kAbsoluteForce / force;
  if (rounding > 1e-3) {
    return;  // a whisper: no moment means anything
  }
  const double moment_rounding = 4 * rounding * extent * extent;
  for (int axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(view.center_of_pressure[3 * instance + axis], expected.center_of_pressure[axis], 2 * rounding * extent);
    EXPECT_NEAR(view.second_moments[3 * instance + axis], expected.second_moments[axis], moment_rounding);
  }
  const auto [larger, smaller] = expected.eigenvalues;
  EXPECT_NEAR(view.eigenvalues[2 * instance], larger, 2 * moment_rounding);
  EXPECT_NEAR(view.eigenvalues[2 * instance + 1], smaller, 2 * moment_rounding);
  EXPECT_GE(view.edge_confidence[instance], 0);
  EXPECT_LE(view.edge_confidence[instance], 1 + 4 * kUlp);
  EXPECT_GT(view.edge_angle[instance], -std::numbers::pi / 2 - 1e-6);
  EXPECT_LE(view.edge_angle[instance], std::numbers::pi / 2 + 1e-6);
  // The errors of (l1 - l2)/(l1 + l2) and 1/2 atan2(2 xy, xx - yy) are the error of the moments over these sums.
  const double confidence_slack = 4 * moment_rounding / (larger + smaller) + 8 * kUlp;
  if (confidence_slack < 0.1) {
    EXPECT_NEAR(view.edge_confidence[instance], expected.edge_confidence, confidence_slack);
  }
  const double angle_slack = 2 * moment_rounding / (larger - smaller) + 8 * kUlp;
  if (angle_slack < 0.1) {
    EXPECT_NEAR(std::remainder(view.edge_angle[instance] - expected.edge_angle, std::numbers::pi), 0, angle_slack);
  }
}

}  // namespace

double extentOf(const Sensor& sensor) {
  double extent = 0;
  for (const Vector3& p : taxelPositions(sensor)) extent = std::max(extent, length(p));
  for (const GridPatch& patch : sensor.patches) {
    extent = std::max({extent, patch.pitch[0] * patch.num_rows, patch.pitch[1] * patch.num_cols});
  }
  return extent;
}

Rounding roundingFor(const Sensor& sensor, std::span<const reference::PlacedObject> objects) {
  double finest = std::numeric_limits<double>::infinity(), coarsest = 0;
  int longest = 0;
  for (const GridPatch& patch : sensor.patches) {
    finest = std::min({finest, patch.pitch[0], patch.pitch[1]});
    coarsest = std::max({coarsest, patch.pitch[0], patch.pitch[1]});
    longest = std::max({longest, patch.num_rows, patch.num_cols});
  }
  const int s = sensor.samples_per_taxel;
  Rounding rounding = kRounding;
  for (const reference::PlacedObject& placed : objects) {
    if (const Mesh* mesh = std::get_if<Mesh>(&placed.object->shape)) {
      const Raster raster = chooseRaster(*mesh, {finest / s, static_cast<std::uint32_t>(longest * s)});
      rounding.shift = std::max(rounding.shift, kShift + 0.5 * std::ldexp(coarsest / s, -raster.subpixel_bits));
    }
    if (std::holds_alternative<Torus>(placed.object->shape)) {
      rounding.margin_z = kTorusMarginZ;
    }
  }
  return rounding;
}

const Device& sharedDevice() {
  static const Device device = Device::open({});
  return device;
}

std::vector<reference::PlacedObject> Touch::placed(const std::vector<Object>& objects, double offset) const {
  std::vector<reference::PlacedObject> result;
  for (std::size_t slot = 0; slot < ids.size(); ++slot) {
    if (ids[slot] != kNoObject) {
      result.push_back({&objects[ids[slot]], X_SO[slot]});
      result.back().X_SO.position[2] += offset;
    }
  }
  return result;
}

void setTouches(Simulator& simulator, const std::vector<Touch>& touches) {
  std::vector<int> ids;
  std::vector<Pose> X_SO;
  for (const Touch& touch : touches) {
    ids.insert(ids.end(), touch.ids.begin(), touch.ids.end());
    X_SO.insert(X_SO.end(), touch.X_SO.begin(), touch.X_SO.end());
  }
  simulator.setObjects(ids, X_SO);
}

Simulator makeSimulator(const Sensor& sensor, const std::vector<Object>& objects, const SimulatorOptions& options) {
  return Simulator(Model(sharedDevice(), {.sensor = sensor, .objects = objects}), options);
}

FrameView stepOnce(Simulator& simulator, const std::vector<Touch>& touches, double dt, const std::vector<float>& loads) {
  setTouches(simulator, touches);
  if (!loads.empty()) simulator.setLoads(loads);
  return stepOnce(simulator, dt);
}

FrameView stepOnce(Simulator& simulator, double dt) {
  simulator.step(dt);
  return simulator.read();
}

std::vector<std::uint32_t> measuredBitsOf(const FrameView& frame, int instance, int num_instances) {
  Bits bits(instance, num_instances);
  bits.addMeasured(frame);
  return bits.take();
}

std::vector<std::uint32_t> bitsOf(const FrameView& frame, int instance, int num_instances) {
  Bits bits(instance, num_instances);
  bits.addMeasured(frame);
  bits.addTruth(frame.ground_truth);
  return bits.take();
}

std::vector<std::vector<std::uint32_t>> bitsOfAll(const FrameView& frame, int num_instances) {
  std::vector<std::vector<std::uint32_t>> bits;
  for (int i = 0; i < num_instances; ++i) bits.push_back(bitsOf(frame, i, num_instances));
  return bits;
}

void expectWellFormed(const FrameView& frame, const Sensor& sensor, int num_instances) {
  const auto n = static_cast<std::size_t>(num_instances), taxels = n * static_cast<std::size_t>(numTaxels(sensor));
  EXPECT_EQ(frame.tactile_image.size(), taxels);
  expectFinite(frame.saturated, n, "saturated");
  expectFeaturesWellFormed(frame, n);
  const GroundTruthView& truth = frame.ground_truth;
  expectFeaturesWellFormed(truth, n);
  expectFinite(truth.tactile_normal_force, taxels, "tactile_normal_force");
  expectFinite(truth.tactile_shear_force, 2 * taxels, "tactile_shear_force");
  expectFinite(truth.penetration_depth, taxels, "penetration_depth");
  expectFinite(truth.contact_wrench, 6 * n, "contact_wrench");
  expectFinite(truth.over_penetration, n, "over_penetration");
  expectFinite(truth.load_offset, n, "load_offset");
  EXPECT_EQ(truth.load_reached.size(), n);
}

void expectMatches(const FrameView& frame, int instance, const Sensor& sensor, const FrameEnvelope& envelope) {
  const int num_instances = static_cast<int>(frame.saturated.size());
  const GroundTruthView& truth = frame.ground_truth;
  const auto force = sliceOf(truth.tactile_normal_force, instance, num_instances);
  const auto counts = sliceOf(frame.tactile_image, instance, num_instances);
  SCOPED_TRACE("instance " + std::to_string(instance));

  // A mean of up to 64 depths.
  expectInside(sliceOf(truth.penetration_depth, instance, num_instances), envelope.mean_penetration, 64 * kUlp, 0, "penetration_depth");
  // The PSF sums up to 81 products with weights rounded once, on top of the envelope's own rounding.
  expectInside(force, envelope.spread_force, 100 * kUlp, 0, "tactile_normal_force");
  const double lever = largestCoordinateOf(sensor);
  const double absolute = kRelativeMoment * envelope.total_high + kAbsoluteForce;
  const auto wrench = sliceOf(truth.contact_wrench, instance, num_instances);
  expectInside(
      wrench.first(3),
      {{envelope.wrench.low.begin(), envelope.wrench.low.begin() + 3}, {envelope.wrench.high.begin(), envelope.wrench.high.begin() + 3}}, 0,
      absolute, "contact force");
  expectInside(
      wrench.last(3),
      {{envelope.wrench.low.begin() + 3, envelope.wrench.low.end()}, {envelope.wrench.high.begin() + 3, envelope.wrench.high.end()}}, 0,
      absolute * lever, "contact torque");
  expectInside(sliceOf(truth.over_penetration, instance, num_instances), envelope.over_penetration, 4 * kUlp, 0, "over_penetration");

  // Readout of the device's own forces: x = gain F - trigger and its powers up to five, each rounded relative to the terms; or a linear
  // piece, whose slope multiplies the rounding of x.
  const Readout& readout = sensor.readout;
  double steepest = 0;  // counts/N
  for (std::size_t k = 0; k < readout.curve_points.size(); ++k) {
    const CurvePoint from = k > 0 ? readout.curve_points[k - 1] : CurvePoint{}, to = readout.curve_points[k];
    steepest = std::max(steepest, readout.output_scale * (to.counts - from.counts) / (to.force - from.force));
  }
  std::size_t num_wrong = 0;
  double area_slack = 0;
  std::vector<std::size_t> patch_of;
  for (std::size_t p = 0; p < sensor.patches.size(); ++p) {
    patch_of.insert(patch_of.end(), static_cast<std::size_t>(sensor.patches[p].num_rows) * sensor.patches[p].num_cols, p);
  }
  for (std::size_t t = 0; t < counts.size(); ++t) {
    const double gain = reference::gainOf(readout, t), trigger = reference::triggerOf(readout, t);
    const double value = reference::analogueOutput(readout, force[t], gain, trigger, 0);
    const double size = std::max(reference::analogueOutput(readout, force[t], gain, -std::abs(trigger), 0),
                                 steepest * (gain * force[t] + std::abs(trigger)));
    const auto clip = [&](double v) { return std::clamp(std::round(v), 0.0, static_cast<double>(readout.saturation)); };
    num_wrong += !(counts[t] >= clip(value - 32 * kUlp * size) && counts[t] <= clip(value + 32 * kUlp * size));
    if (std::abs(force[t] - trigger) <= 2 * kUlp * trigger) {
      const GridPatch& patch = sensor.patches[patch_of[t]];
      area_slack += patch.pitch[0] * patch.pitch[1];  // on its trigger: may count either way
    }
  }
  EXPECT_EQ(num_wrong, 0u) << "counts of so many taxels are not the readout of their forces";
  EXPECT_NEAR(frame.saturated[instance], reference::saturatedFraction(sensor, counts), 4 * kUlp);

  const std::vector<double> force_in_double(force.begin(), force.end());
  expectFeatures(truth, instance, sensor, reference::cleanFeatures(sensor, force_in_double), kRelativeMoment, area_slack, "clean features");
  expectFeatures(frame, instance, sensor, reference::measuredFeatures(sensor, counts), kRelativeInverse, 0, "measured features");
}

double looseness(const Sensor& sensor, const FrameEnvelope& envelope) {
  double sum = 0;
  for (std::size_t n = 0; n < envelope.penetration.low.size(); ++n) {
    sum += envelope.penetration.high[n] - envelope.penetration.low[n];
  }
  return sum / static_cast<double>(envelope.penetration.low.size()) / sensor.skin.thickness;
}

void expectMedianAtMost(std::vector<double> values, double max) {
  if (values.empty()) return;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  EXPECT_LE(*middle, max);
}

}  // namespace taxelsim::support
