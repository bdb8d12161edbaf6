// Model of images under flat stamps with dead weights at unknown poses. A stamp sinks into an elastic foundation (Skin) until it carries
// the weight; a taxel's force is summed over its cells (samples_per_taxel per side) that the stamp covers. A Gaussian spreads the forces,
// and a taxel with force F reads
//   counts = clip(ReadoutModel::output(gain press scale F - trigger - offset)).
// `gain`, about 1, and `offset`, about 0, belong to a taxel and are the same in all images; `press`, about 1, belongs to an image and is
// the same for all its taxels.
//
// Priors: log(gain) and offset are Gaussian, and their standard deviations are estimated from the fit itself (empirical Bayes). A stamp
// that is placed by hand is turned and tilted by a few degrees. Stamps of one fixture share one pose without tilt, which
// is a shared parameter. Gains of presses are independent, or depend on the load (press_prior.h); then they are shared parameters.
// A reading has the variance noise^2 + (relative_noise x fitted reading)^2.
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "base/vector3.h"
#include "characterize/creep.h"
#include "characterize/least_squares.h"
#include "characterize/press_prior.h"
#include "characterize/readout_model.h"
#include "reference/samples.h"
#include "taxelsim/measurement.h"

namespace taxelsim {

// Indices of a stamp's own parameters: x, y (m), yaw (rad), slopes of its face along x and y of S, gain of this press. The first five are
// the pose, which a fixture has, too.
namespace stamp_own {
inline constexpr std::size_t kPoseSize = 5;
inline constexpr std::size_t kX = 0, kY = 1, kYaw = 2, kSlopeX = 3, kSlopeY = 4, kPress = 5;
}  // namespace stamp_own

// Indices of the shared parameters: sigma (taxels; m for a list), scale (counts/N), trigger (counts), log(stiffness), growth of the gain
// (1/K) and of the trigger (counts/K) with the temperature, curve parameters of ReadoutModel, gains of all taxels, offsets of all taxels
// (counts), poses of the fixtures, and log(press gain) of each stamp if they depend on the load.
namespace stamp_shared {
inline constexpr std::size_t kSigma = 0, kScale = 1, kTrigger = 2, kStiffness = 3, kWarmGain = 4, kWarmTrigger = 5, kCurve = 6;
}  // namespace stamp_shared

struct Stamp {
  const Measurement* measurement = nullptr;
  const StampImages* data = nullptr;
  CreepSeries sum{};                  // of counts
  std::vector<double> image{};        // (num_taxels), counts
  std::vector<std::size_t> taxels{};  // fitted taxels
  std::vector<double> weight{};       // (num_taxels): noise / standard deviation of the reading; empty: 1
  std::optional<std::size_t> fixture{};
  double warmth = 0;  // K above the reference temperature

  double weightOf(std::size_t taxel) const { return weight.empty() ? 1 : weight[taxel]; }
};

struct StampModel {
  explicit StampModel(const Sensor& sensor);

  std::size_t gainsAt() const { return stamp_shared::kCurve + curve.lag(); }  // index of the first gain
  std::size_t offsetsAt() const { return gainsAt() + gain.size(); }
  std::size_t fixturesAt() const { return offsetsAt() + gain.size(); }
  std::size_t pressesAt() const { return fixturesAt() + stamp_own::kPoseSize * fixtures.size(); }
  std::vector<double> loads() const;  // (stamps), N
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
  ReadoutModel curve;                   // curve, end of the range and noise
  std::vector<std::string> fixtures{};  // names
  bool is_plane;
  bool with_gains = false;
  bool with_offsets = false;
  bool with_tilt = false;
  bool with_temperature = false;
  bool knows_gains = false;                 // another measurement determined them
  double gain_deviation = 0.5;              // prior standard deviation of log(gain)
  double offset_deviation = 100;            // counts: prior standard deviation of the offsets
  double press_spread = 0;                  // prior standard deviation of press gains; 0: not fitted
  std::optional<PressPrior> press_prior{};  // of press gains that depend on the load
};

struct StampFit {
  GroupedFit fit;                          // groups: stamps, and with gains one more for their prior
  std::vector<std::vector<double>> force;  // (stamps, num_taxels), N: after the spread, times the gains of press and temperature
  std::optional<GroupedFit> curve{};       // fit that determined the curve, with equal press gains
};

// Fits the model from these start values; missing shared values get defaults.
StampFit fitStampModel(const StampModel& model, const std::vector<double>& shared_start, const std::vector<std::vector<double>>& own_start);

// Output (counts) of a taxel under a stamp before noise and clipping, for a force (N) as in StampFit::force.
double outputOf(const StampModel& model, const Stamp& stamp, const std::vector<double>& shared, std::size_t taxel, double force);

// A stamp's parameters (stamp_own), with the pose of its fixture if it has one, and with its press gain.
std::array<double, 6> ownOf(const StampModel& model, std::size_t stamp, const double* shared, const double* own);

}  // namespace taxelsim
