#include "peers/taxel_stage.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <variant>

#include "taxelsim/error.h"

namespace taxelsim::bench {
namespace {

constexpr int kSide = 4;   // samples per taxel, per side
constexpr int kReach = 1;  // taxels, of the 3 x 3 PSF
constexpr float kPi = std::numbers::pi_v<float>;

// Sums over an image of forces.
struct Moments {
  Floats sum{}, x{}, y{}, xx{}, xy{}, yy{}, peak{};
  Ints touched{};

  void add(Floats f, float row_x, Floats col_y, Ints is_touched) {
    const Floats fx = f * row_x, fy = f * col_y;
    sum += f;
    x += fx;
    y += fy;
    xx += fx * row_x;
    xy += fx * col_y;
    yy += fy * col_y;
    peak = larger(peak, f);
    touched -= is_touched;
  }
};

PeerFeatures featuresOf(float sum, float x, float y, float xx, float xy, float yy, float peak, float area) {
  PeerFeatures features;
  features.total_force = sum;
  features.peak_force = peak;
  features.contact_area = area;
  if (sum <= 0) return features;
  const float inverse = 1 / sum, mx = x * inverse, my = y * inverse;
  xx = xx * inverse - mx * mx;
  xy = xy * inverse - mx * my;
  yy = yy * inverse - my * my;
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

}  // namespace

TaxelStage::TaxelStage(const Sensor& sensor) {
  checkSensor(sensor);
  const Winkler* law = std::get_if<Winkler>(&sensor.skin.law);
  const Readout& readout = sensor.readout;
  const bool plain = sensor.patches.size() == 1 && sensor.patches[0].X_SP == Pose{} && sensor.samples_per_taxel == kSide && law &&
                     law->normal_exponent == 1 && law->normal_damping == 0 && !hasFriction(sensor.skin) && sensor.skin.relaxation.empty() &&
                     sensor.psf.size == 2 * kReach + 1 && sensor.psf.normalization == Psf::Normalization::kPerSource &&
                     readout.curve.size() == 1 && readout.curve_limit == 0 && readout.curve_points.empty() && readout.noise == 0 &&
                     readout.taxel_gain.empty() && readout.taxel_trigger.empty() && readout.hysteresis_strength.empty() &&
                     readout.creep.empty() && readout.low_pass_time == 0 && readout.delay == 0 && readout.bias == 0 &&
                     readout.random_walk == 0 && readout.gain_spread == 0 && readout.press_gain_spread == 0 &&
                     readout.dead_taxel_probability == 0 && sensor.frame_rate == 0;
  if (!plain) {
    throw Error(ErrorKind::kInput, sensor.name +
                                       ": the peers do one grid patch at the origin with 4 x 4 samples, linear springs without friction, "
                                       "a 3 x 3 PSF per source and a straight, noiseless curve only");
  }
  const GridPatch& patch = sensor.patches[0];
  num_rows_ = patch.num_rows;
  num_cols_ = patch.num_cols;
  num_chunks_ = (num_cols_ + kLanes - 1) / kLanes;
  // The border of zeros at the start of a row also ends the previous row.
  row_length_ = (num_chunks_ + 1) * kLanes;
  pitch_x_ = static_cast<float>(patch.pitch[0]);
  pitch_y_ = static_cast<float>(patch.pitch[1]);
  thickness_ = static_cast<float>(sensor.skin.thickness);
  taxel_area_ = static_cast<float>(patch.pitch[0] * patch.pitch[1]);
  sample_force_ = static_cast<float>(law->normal_contact_stiffness * patch.pitch[0] * patch.pitch[1] / (kSide * kSide));
  gain_ = static_cast<float>(readout.output_scale * readout.curve[0]);
  inverse_gain_ = static_cast<float>(1 / (readout.output_scale * readout.curve[0]));
  trigger_ = static_cast<float>(readout.trigger);
  saturation_ = static_cast<float>(readout.saturation);
  for (int k = 0; k < 9; ++k) kernel_[k] = static_cast<float>(sensor.psf.kernel[k]);
  for (int i = 0; i < num_rows_; ++i) row_x_.push_back(static_cast<float>((i - (num_rows_ - 1) / 2.0) * patch.pitch[0]));
  for (int j = 0; j < num_chunks_ * kLanes; ++j)
    col_y_.push_back(j < num_cols_ ? static_cast<float>((j - (num_cols_ - 1) / 2.0) * patch.pitch[1]) : 0);
  inverse_divisor_.resize(scratch().force.size());
  for (int i = 0; i < num_rows_; ++i) {
    for (int j = 0; j < num_cols_; ++j) {
      double divisor = 0;
      for (int a = -kReach; a <= kReach; ++a) {
        for (int b = -kReach; b <= kReach; ++b) {
          const bool inside = i + a >= 0 && i + a < num_rows_ && j + b >= 0 && j + b < num_cols_;
          divisor += inside ? sensor.psf.kernel[(a + kReach) * 3 + b + kReach] : 0;
        }
      }
      inverse_divisor_[placeOf(i, j)] = static_cast<float>(1 / divisor);
    }
  }
}

TaxelStage::Scratch TaxelStage::scratch() const {
  const auto size = static_cast<std::size_t>((num_rows_ + 2) * row_length_ + kLanes);
  return {std::vector<float>(size), std::vector<float>(size)};
}

void TaxelStage::finish(Scratch& scratch, int first_row, int last_row, std::size_t instance, PeerFrame& frame) const {
  const auto num_taxels = static_cast<std::size_t>(numTaxels());
  std::uint32_t* image = frame.tactile_image.data() + instance * num_taxels;
  float* spread = frame.with_forces ? frame.spread_force.data() + instance * num_taxels : nullptr;
  if (first_row > last_row) {
    std::fill_n(image, num_taxels, 0);
    if (spread) std::fill_n(spread, num_taxels, 0.0f);
    frame.clean[instance] = frame.measured[instance] = {};
    return;
  }

  // Normalises the sources; the rows next to them stay 0.
  for (int i = first_row; i <= last_row; ++i) {
    const std::size_t row = placeOf(i, 0);
    for (int c = 0; c < num_chunks_; ++c) {
      const std::size_t k = row + static_cast<std::size_t>(c * kLanes);
      store(&scratch.scaled[k], load(&scratch.force[k]) * load(&inverse_divisor_[k]));
      store(&scratch.force[k], Floats{});
    }
  }
  const int begin = std::max(0, first_row - kReach), end = std::min(num_rows_ - 1, last_row + kReach);
  const auto before = static_cast<std::size_t>(begin * num_cols_), after = static_cast<std::size_t>((end + 1) * num_cols_);
  std::fill_n(image, before, 0);
  std::fill(image + after, image + num_taxels, 0);
  if (spread) {
    std::fill_n(spread, before, 0.0f);
    std::fill(spread + after, spread + num_taxels, 0.0f);
  }

  Moments clean, measured;
  for (int i = begin; i <= end; ++i) {
    for (int c = 0; c < num_chunks_; ++c) {
      const float* source = &scratch.scaled[placeOf(i, c * kLanes)];
      Floats f{};
      for (int a = -kReach; a <= kReach; ++a)
        for (int b = -kReach; b <= kReach; ++b) f += load(source - a * row_length_ - b) * kernel_[(a + kReach) * 3 + b + kReach];
      const int count = std::min(kLanes, num_cols_ - c * kLanes);
      const Floats y = load(&col_y_[static_cast<std::size_t>(c * kLanes)]);
      if (count < kLanes) f = select(Floats{0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15} < static_cast<float>(count), f, Floats{});
      // Rounds half away from zero.
      const Ints counts = toInts(smaller(larger((f - trigger_) * gain_, Floats{}), all(saturation_)) + 0.5f);
      const Ints reads = counts > 0;
      const Floats felt = select(reads, toFloats(counts) * inverse_gain_ + trigger_, Floats{});
      clean.add(f, row_x_[static_cast<std::size_t>(i)], y, f > trigger_);
      measured.add(felt, row_x_[static_cast<std::size_t>(i)], y, reads);
      const std::size_t place = static_cast<std::size_t>(i * num_cols_ + c * kLanes);
      storeFirst(image + place, counts, count);
      if (spread) storeFirst(spread + place, f, count);
    }
  }
  for (int i = first_row; i <= last_row; ++i) {
    for (int c = 0; c < num_chunks_; ++c) store(&scratch.scaled[placeOf(i, c * kLanes)], Floats{});
  }
  const Floats columns[kLanes] = {clean.sum,    clean.x,    clean.y,    clean.xx,    clean.xy,    clean.yy,    toFloats(clean.touched),
                                  measured.sum, measured.x, measured.y, measured.xx, measured.xy, measured.yy, toFloats(measured.touched)};
  const Floats s = sumsOf(columns);
  frame.clean[instance] = featuresOf(s[0], s[1], s[2], s[3], s[4], s[5], largestOf(clean.peak), s[6] * taxel_area_);
  frame.measured[instance] = featuresOf(s[7], s[8], s[9], s[10], s[11], s[12], largestOf(measured.peak), s[13] * taxel_area_);
}

}  // namespace taxelsim::bench
