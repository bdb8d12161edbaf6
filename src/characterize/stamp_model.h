// Model of images under flat stamps with dead weights at unknown poses. A stamp sinks into an elastic foundation (Skin) until it carries
// the weight; a taxel's force is summed over its cells (samples_per_taxel per side) that the stamp covers. A Gaussian spreads the forces,
// and a taxel with force F reads
//   counts = clip(ReadoutModel::output(gain press scale F - trigger)).
// `gain`, about 1, is the same in all images; `press`, about 1, is the same for all taxels of an image.
#pragma once

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

// Indices of a stamp's own parameters: x, y (m), yaw (rad), slopes of its face along x and y of S, gain of this press.
namespace stamp_own {
inline constexpr std::size_t kX = 0, kY = 1, kYaw = 2, kSlopeX = 3, kSlopeY = 4, kPress = 5;
}  // namespace stamp_own

// Indices of the shared parameters: sigma (taxels; m for a list), scale (counts/N), trigger (counts), log(stiffness), curve parameters of
// ReadoutModel, gains of all taxels.
namespace stamp_shared {
inline constexpr std::size_t kSigma = 0, kScale = 1, kTrigger = 2, kStiffness = 3, kCurve = 4;
}  // namespace stamp_shared

struct Stamp {
  const Measurement* measurement = nullptr;
  const StampImages* data = nullptr;
  CreepSeries sum{};                  // of counts
  std::vector<double> image{};        // (num_taxels), counts
  std::vector<std::size_t> taxels{};  // fitted taxels
};

struct StampModel {
  explicit StampModel(const Sensor& sensor);

  std::size_t gainsAt() const { return stamp_shared::kCurve + curve.lag(); }  // index of the first gain
  bool isListOfTaxels() const { return isTaxelList(*sensor); }
  // Unit of sigma: 1 taxel, or the length of a taxel (m).
  double sigmaUnit() const { return isListOfTaxels() ? sensor->patches[0].pitch[0] : 1; }

  // Selects the readings to fit: those of all live taxels, or unclipped ones only.
  void chooseTaxels(bool all);
  // True if a live taxel reads more than 0 in any image.
  bool isLoaded(std::size_t taxel) const;

  const Sensor* sensor;
  Winkler foundation;
  std::vector<reference::Sample> samples;
  std::vector<std::array<double, 2>> half_cell;  // (patches), m
  std::vector<Pose> X_PS;                        // (patches)
  std::vector<double> gain;                      // (num_taxels), prior values; 0: dead
  std::vector<Stamp> stamps;
  ReadoutModel curve;  // curve, end of the range and noise
  bool is_plane;
  bool with_gains = false;
  bool with_tilt = false;
  double press_spread = 0;  // prior standard deviation of press gains; 0: not fitted
};

inline constexpr double kGainDeviation = 0.1;  // prior standard deviation of taxel gains

struct StampFit {
  GroupedFit fit;                          // groups: stamps, and with gains one more for their prior
  std::vector<std::vector<double>> force;  // (stamps, num_taxels), N: after the spread, times the press gain
  std::optional<GroupedFit> curve{};       // fit that determined the curve, with equal press gains
};

// Fits the model from these start values; missing shared values get defaults.
StampFit fitStampModel(const StampModel& model, const std::vector<double>& shared_start, const std::vector<std::vector<double>>& own_start);

// Output (counts) before noise and clipping for a force (N) after the spread, times the gains.
double outputOf(const StampModel& model, const std::vector<double>& shared_values, double force);

}  // namespace taxelsim
