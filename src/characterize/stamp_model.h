// The model of images under flat stamps with dead weights, which lie where they lie. A stamp presses an elastic foundation (Skin) as deep
// as carries the weight; of a taxel's cells, samples_per_taxel per side, counts what the stamp covers. The forces spread as a Gaussian, and
// of what a taxel gets, F, it reads
//   counts = clip(ReadoutModel::output(gain press scale F - trigger)),
// its gain, about 1, being common to all images and `press`, about 1, to all taxels of an image.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "base/vector3.h"
#include "characterize/creep.h"
#include "characterize/least_squares.h"
#include "characterize/readout_model.h"
#include "reference/samples.h"
#include "taxelsim/measurement.h"

namespace taxelsim {

// A stamp's own parameters: x, y (m), yaw (rad), slopes of its face along x and y of S, gain of this press.
namespace stamp_own {
inline constexpr std::size_t kX = 0, kY = 1, kYaw = 2, kSlopeX = 3, kSlopeY = 4, kPress = 5;
}  // namespace stamp_own

// Parameters that all stamps share: sigma (taxels; m of a list), scale (counts/N), trigger (counts), logarithm of the stiffness, then what
// ReadoutModel has for its curve, then the gains of all taxels.
namespace stamp_shared {
inline constexpr std::size_t kSigma = 0, kScale = 1, kTrigger = 2, kStiffness = 3, kCurve = 4;
}  // namespace stamp_shared

struct Stamp {
  const Measurement* measurement = nullptr;
  const StampImages* data = nullptr;
  CreepSeries sum{};                  // of counts
  std::vector<double> image{};        // (num_taxels), counts
  std::vector<std::size_t> taxels{};  // that are fitted
};

struct StampModel {
  explicit StampModel(const Sensor& sensor);

  std::size_t gainsAt() const { return stamp_shared::kCurve + curve.lag(); }  // where the gains begin
  bool isListOfTaxels() const { return isTaxelList(*sensor); }
  // Standard size of sigma: 1 taxel, or a taxel's length.
  double sigmaUnit() const { return isListOfTaxels() ? sensor->patches[0].pitch[0] : 1; }

  // Which readings are fitted: all of live taxels, or those between the ends.
  void chooseTaxels(bool all);
  // Whether a taxel reads anything in any image.
  bool isLoaded(std::size_t taxel) const;

  const Sensor* sensor;
  Winkler foundation;
  std::vector<reference::Sample> samples;
  std::vector<std::array<double, 2>> half_cell;  // (patches), m
  std::vector<Pose> X_PS;                        // (patches)
  Eigen::MatrixXd squared_distance;              // (num_taxels x num_taxels), taxels^2 or m^2; infinite beyond the reach
  std::vector<double> gain;                      // (num_taxels), as far as known; 0: dead
  std::vector<Stamp> stamps;
  ReadoutModel curve;  // its bends and divider, the end of the range and the noise
  bool is_plane;
  bool with_gains = false;
  bool with_tilt = false;
  double press_spread = 0;  // of the gain of a press; 0: not fitted
};

inline constexpr double kGainDeviation = 0.1;  // of taxels' gains about 1, before anything was measured

struct StampFit {
  GroupedFit fit;                          // groups: stamps; with gains one more, of what was known of these
  std::vector<std::vector<double>> force;  // (stamps, num_taxels): after the spread, N, with the gain of the press
  std::optional<GroupedFit> curve{};       // that the curve's bends were found by: with presses alike
};

// A fit of the model, begun at these values; shared ones that it lacks begin at none.
StampFit fitStampModel(const StampModel& model, const std::vector<double>& shared_start, const std::vector<std::vector<double>>& own_start);

// What a taxel counts, before noise and clipping, of a force after the spread (N) times a gain.
double outputOf(const StampModel& model, const std::vector<double>& shared_values, double force);

}  // namespace taxelsim
