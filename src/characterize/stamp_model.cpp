#include "characterize/stamp_model.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "characterize/clipped_mean.h"
#include "characterize/limits.h"
#include "characterize/stamp_press.h"
#include "reference/readout.h"

namespace taxelsim {
namespace {

using namespace stamp_own;
using namespace stamp_shared;

constexpr double kTurn = 0.052;      // rad, 3 degrees: standard deviation of the turn and the tilt of a stamp that is placed by hand
constexpr double kMostTilt = 0.15;   // slope
constexpr double kGainScale = 0.1;   // typical deviation of a gain
constexpr double kPlane = 1e-6;      // m and rad: deviation up to which a skin counts as plane
constexpr double kMostBend = 100;    // upper bound of the quadratic term at the end of the range, relative to the linear one
constexpr double kLeastGain = 0.01;  // of the nominal gain
constexpr double kLeastPress = 0.2, kMostPress = 5;
constexpr int kMaxKernelReach = kMaxKernelSize / 2;

// (num_taxels x num_taxels): taxels^2 within a grid, infinite beyond the largest kernel; m^2 along the skin for a list of taxels.
Eigen::MatrixXd squaredDistances(const Sensor& sensor) {
  const auto count = static_cast<Eigen::Index>(numTaxels(sensor));
  Eigen::MatrixXd squares = Eigen::MatrixXd::Constant(count, count, std::numeric_limits<double>::infinity());
  if (isTaxelList(sensor)) {
    const std::vector<Vector3> positions = taxelPositions(sensor), normals = taxelNormals(sensor);
    for (std::size_t a = 0; a < positions.size(); ++a) {
      for (std::size_t b = 0; b < positions.size(); ++b) {
        const double distance = skinDistance(positions[a], normals[a], positions[b], normals[b]);
        squares(static_cast<Eigen::Index>(a), static_cast<Eigen::Index>(b)) = distance * distance;
      }
    }
    return squares;
  }
  Eigen::Index first = 0;
  for (const GridPatch& patch : sensor.patches) {
    const Eigen::Index num = patch.num_rows * patch.num_cols;
    for (Eigen::Index a = 0; a < num; ++a) {
      for (Eigen::Index b = 0; b < num; ++b) {
        const Eigen::Index rows = a / patch.num_cols - b / patch.num_cols, cols = a % patch.num_cols - b % patch.num_cols;
        if (std::max(std::abs(rows), std::abs(cols)) > kMaxKernelReach) continue;
        squares(first + a, first + b) = static_cast<double>(rows * rows + cols * cols);
      }
    }
    first += num;
  }
  return squares;
}

bool isPlane(const Sensor& sensor) {
  const std::vector<Vector3> positions = taxelPositions(sensor), normals = taxelNormals(sensor);
  return std::all_of(positions.begin(), positions.end(), [&](const Vector3& p) {
    const Vector3& n = normals[static_cast<std::size_t>(&p - positions.data())];
    return length(cross(n, normals[0])) < kPlane && std::abs(dot(subtract(p, positions[0]), normals[0])) < kPlane;
  });
}

// Caches the last forces under each stamp and the kernel weights of the last sigmas: numerical derivatives change one parameter at a time.
class ForceCache {
 public:
  explicit ForceCache(const StampModel& model)
      : model_(model), squared_distance_(squaredDistances(*model.sensor)), pressed_(model.stamps.size()) {}

  // Force on each taxel after the spread, N.
  const std::vector<double>& spread(std::size_t stamp, const double* own, double stiffness, double sigma) {
    const std::array<double, 6> at{own[kX], own[kY], own[kYaw], own[kSlopeX], own[kSlopeY], stiffness};
    Pressed& pressed = pressed_[stamp];
    const bool is_same_pose = !pressed.force.empty() && pressed.at == at;
    if (is_same_pose && pressed.sigma == sigma) return pressed.spread;
    if (!is_same_pose) pressed.force = forcesUnder(model_, model_.stamps[stamp], own, stiffness);
    pressed.at = at;
    pressed.sigma = sigma;
    pressed.spread.assign(pressed.force.size(), 0);
    Eigen::Map<Eigen::VectorXd> sum(pressed.spread.data(), static_cast<Eigen::Index>(pressed.spread.size()));
    const Eigen::MatrixXd& weights = weightsOf(sigma);
    for (std::size_t t = 0; t < pressed.force.size(); ++t) {
      if (pressed.force[t] > 0) sum += pressed.force[t] * weights.col(static_cast<Eigen::Index>(t));
    }
    return pressed.spread;
  }

 private:
  struct Pressed {
    std::array<double, 6> at{};
    double sigma = 0;
    std::vector<double> force{}, spread{};  // (num_taxels), N
  };

  // (taxels x sources); columns sum to 1.
  const Eigen::MatrixXd& weightsOf(double sigma) {
    for (const auto& [known, matrix] : last_) {
      if (known == sigma) return matrix;
    }
    if (last_.size() > 4) last_.erase(last_.begin());
    Eigen::MatrixXd weights = (-squared_distance_.array() / (2 * sigma * sigma)).exp();
    const Eigen::RowVectorXd sums = weights.colwise().sum();
    for (Eigen::Index source = 0; source < weights.cols(); ++source) weights.col(source) /= sums[source];
    last_.emplace_back(sigma, std::move(weights));
    return last_.back().second;
  }

  const StampModel& model_;
  const Eigen::MatrixXd squared_distance_;  // (num_taxels x num_taxels)
  std::vector<Pressed> pressed_;            // (stamps)
  std::vector<std::pair<double, Eigen::MatrixXd>> last_;
};

// Equal bounds make a parameter constant.
FitParameter fixedAt(double value) {
  return {.start = value, .scale = 1, .low = value, .high = value};
}

FitParameter freeFrom(double value, double scale, double low, double high) {
  return {.start = value, .scale = scale, .low = low, .high = high};
}

std::vector<FitParameter> sharedParameters(const StampModel& model, const std::vector<double>& start) {
  const double unit = model.sigmaUnit();
  std::vector<FitParameter> parameters{
      freeFrom(start[kSigma], 0.1 * unit, 0.15 * unit, 4 * unit), freeFrom(start[kScale], start[kScale], 0, 1e12),
      freeFrom(start[kTrigger], 10, 0, 1e6),
      model.is_plane ? fixedAt(start[kStiffness]) : freeFrom(start[kStiffness], 1, start[kStiffness] - 5, start[kStiffness] + 5)};
  const auto ofTemperature = [&](std::size_t at, double scale, double most) {
    parameters.push_back(model.with_temperature ? freeFrom(at < start.size() ? start[at] : 0, scale, -most, most) : fixedAt(0));
  };
  ofTemperature(kWarmGain, 1e-3, kMostPerKelvin);
  ofTemperature(kWarmTrigger, 1, model.curve.top);
  // Press gains and curve parameters are confounded: the curve is constant while press gains are fitted.
  const auto curveParameter = [&](double high) {
    const double value = parameters.size() < start.size() ? start[parameters.size()] : 0;
    parameters.push_back(model.press_spread > 0 ? fixedAt(value) : freeFrom(value, 1, 0, high));
  };
  for (std::size_t k = 0; k < model.curve.num_bends; ++k) curveParameter(kMostBend);
  if (model.curve.divider) curveParameter(kMostOfLimit);
  for (std::size_t t = 0; t < model.gain.size(); ++t) {
    const double gain =
        model.with_gains && model.gain[t] > 0 && parameters.size() < start.size() ? start[parameters.size()] : model.gain[t];
    parameters.push_back(model.with_gains && model.isLoaded(t) ? freeFrom(gain, kGainScale, kLeastGain, 1 / kLeastGain) : fixedAt(gain));
  }
  for (std::size_t t = 0; t < model.gain.size(); ++t) {
    const double offset = model.with_offsets && parameters.size() < start.size() ? start[parameters.size()] : 0;
    parameters.push_back(model.with_offsets && model.isLoaded(t) ? freeFrom(offset, 10, -1e6, 1e6) : fixedAt(0));
  }
  return parameters;
}

// The parameters of a pose that starts at `at`.
std::vector<FitParameter> poseParameters(const double* at, bool round, bool with_tilt) {
  const auto slope = [&](std::size_t p) { return with_tilt ? freeFrom(at[p], 1e-3, -kMostTilt, kMostTilt) : fixedAt(0); };
  return {freeFrom(at[kX], 1e-3, -1, 1), freeFrom(at[kY], 1e-3, -1, 1), round ? fixedAt(0) : freeFrom(at[kYaw], 0.1, -0.8, 0.8),
          slope(kSlopeX), slope(kSlopeY)};
}

// Prior of a pose: 3 rows.
double* writePosePrior(const double* pose, double noise, double* residuals) {
  for (const std::size_t p : {kYaw, kSlopeX, kSlopeY}) *residuals++ = noise * pose[p] / kTurn;
  return residuals;
}
constexpr std::size_t kPosePriorRows = 3;

}  // namespace

StampModel::StampModel(const Sensor& a_sensor)
    : sensor(&a_sensor), foundation(foundationOf(a_sensor.skin)), samples(reference::samplesOf(a_sensor)), is_plane(isPlane(a_sensor)) {
  for (const GridPatch& patch : sensor->patches) {
    X_PS.push_back(inverse(patch.X_SP));
    half_cell.push_back({patch.pitch[0] / (2 * sensor->samples_per_taxel), patch.pitch[1] / (2 * sensor->samples_per_taxel)});
  }
  for (int t = 0; t < numTaxels(*sensor); ++t) gain.push_back(reference::gainOf(sensor->readout, static_cast<std::size_t>(t)));
  curve = {.top = static_cast<double>(sensor->readout.saturation), .noise = 0};
}

void StampModel::chooseTaxels(bool all) {
  for (Stamp& stamp : stamps) {
    stamp.taxels.clear();
    for (std::size_t t = 0; t < stamp.image.size(); ++t) {
      if (gain[t] > 0 && (all || (stamp.image[t] > 0 && stamp.image[t] < curve.top))) stamp.taxels.push_back(t);
    }
  }
}

std::vector<double> StampModel::loads() const {
  std::vector<double> loads;
  for (const Stamp& stamp : stamps) loads.push_back(stamp.data->load);
  return loads;
}

bool StampModel::isLoaded(std::size_t taxel) const {
  return gain[taxel] > 0 && std::any_of(stamps.begin(), stamps.end(), [&](const Stamp& stamp) { return stamp.image[taxel] > 0; });
}

double outputOf(const StampModel& model, const Stamp& stamp, const std::vector<double>& shared, std::size_t taxel, double force) {
  const double z = shared[model.gainsAt() + taxel] * shared[kScale] * force - shared[kTrigger] - shared[kWarmTrigger] * stamp.warmth -
                   shared[model.offsetsAt() + taxel];
  return model.curve.output(z, shared.data() + kCurve);
}

std::array<double, 6> ownOf(const StampModel& model, std::size_t stamp, const double* shared, const double* own) {
  std::array<double, 6> values{};
  std::copy_n(own, values.size(), values.begin());
  const std::optional<std::size_t>& fixture = model.stamps[stamp].fixture;
  if (fixture) std::copy_n(shared + model.fixturesAt() + kPoseSize * *fixture, kPoseSize, values.begin());
  if (model.press_prior) values[kPress] = std::exp(shared[model.pressesAt() + stamp]);
  return values;
}

namespace {

bool isRound(const Stamp& stamp) {
  return stamp.data->indenter.shape == Indenter::Shape::kFlatPin;
}

GroupedProblem problemOf(const StampModel& model, const std::vector<double>& shared_start,
                         const std::vector<std::vector<double>>& own_start) {
  GroupedProblem problem{
      .shared = sharedParameters(model, shared_start), .own = {}, .num_rows = {}, .noise = model.curve.noise, .residuals = {}};
  for (std::size_t f = 0; f < model.fixtures.size(); ++f) {
    const auto first = std::find_if(model.stamps.begin(), model.stamps.end(), [&](const Stamp& stamp) { return stamp.fixture == f; });
    const std::size_t at = model.fixturesAt() + kPoseSize * f;
    const double* const start =
        at < shared_start.size() ? &shared_start[at] : own_start[static_cast<std::size_t>(first - model.stamps.begin())].data();
    for (const FitParameter& parameter : poseParameters(start, isRound(*first), false)) problem.shared.push_back(parameter);
  }
  for (std::size_t g = 0; model.press_prior && g < model.stamps.size(); ++g) {
    const std::size_t at = model.pressesAt() + g;
    problem.shared.push_back(freeFrom(at < shared_start.size() ? shared_start[at] : 0, 0.1, std::log(kLeastPress), std::log(kMostPress)));
  }
  const bool has_own_press = model.press_spread > 0 && !model.press_prior;
  for (std::size_t g = 0; g < model.stamps.size(); ++g) {
    const std::vector<double>& at = own_start[g];
    const Stamp& stamp = model.stamps[g];
    std::vector<FitParameter>& own = problem.own.emplace_back(poseParameters(at.data(), isRound(stamp), model.with_tilt));
    if (stamp.fixture) own.assign(kPoseSize, fixedAt(0));
    own.push_back(has_own_press ? freeFrom(at[kPress], 0.1, kLeastPress, kMostPress) : fixedAt(1));
    problem.num_rows.push_back(stamp.taxels.size() + (has_own_press ? 1 : 0) + (stamp.fixture ? 0 : kPosePriorRows));
  }
  return problem;
}

}  // namespace

StampFit fitStampModel(const StampModel& model, const std::vector<double>& shared_start,
                       const std::vector<std::vector<double>>& own_start) {
  GroupedProblem problem = problemOf(model, shared_start, own_start);
  const std::size_t gains_at = model.gainsAt(), offsets_at = model.offsetsAt();
  std::vector<std::size_t> loaded;
  for (std::size_t t = 0; t < model.gain.size(); ++t) {
    if (model.isLoaded(t)) loaded.push_back(t);
  }
  // One more group holds the priors of the shared parameters.
  const std::size_t num_priors = ((model.with_gains ? 1U : 0U) + (model.with_offsets ? 1U : 0U)) * loaded.size() +
                                 kPosePriorRows * model.fixtures.size() + (model.press_prior ? model.stamps.size() : 0);
  Eigen::LLT<Eigen::MatrixXd> press_covariance;
  if (model.press_prior) press_covariance.compute(model.press_prior->covariance(model.loads()));
  if (num_priors > 0) {
    problem.own.emplace_back();
    problem.num_rows.push_back(num_priors);
  }
  ForceCache forces(model);
  const double noise = std::max(kLeastNoise, model.curve.noise);
  problem.residuals = [&](std::size_t g, const double* values, const double* own, double* residuals) {
    const double* const gains = values + gains_at;
    const double* const offsets = values + offsets_at;
    if (g == model.stamps.size()) {
      for (std::size_t k = 0; model.with_gains && k < loaded.size(); ++k) {
        *residuals++ = noise * std::log(gains[loaded[k]] / model.gain[loaded[k]]) / model.gain_deviation;
      }
      for (std::size_t k = 0; model.with_offsets && k < loaded.size(); ++k)
        *residuals++ = noise * offsets[loaded[k]] / model.offset_deviation;
      for (std::size_t f = 0; f < model.fixtures.size(); ++f) {
        residuals = writePosePrior(values + model.fixturesAt() + kPoseSize * f, noise, residuals);
      }
      if (!model.press_prior) return;
      const auto count = static_cast<Eigen::Index>(model.stamps.size());
      Eigen::Map<Eigen::VectorXd> whitened(residuals, count);
      whitened = noise * press_covariance.matrixL().solve(Eigen::Map<const Eigen::VectorXd>(values + model.pressesAt(), count));
      return;
    }
    const Stamp& stamp = model.stamps[g];
    const std::array<double, 6> at = ownOf(model, g, values, own);
    const std::vector<double>& force = forces.spread(g, at.data(), std::exp(values[kStiffness]), values[kSigma]);
    const double scale = at[kPress] * std::exp(values[kWarmGain] * stamp.warmth) * values[kScale];
    const double trigger = values[kTrigger] + values[kWarmTrigger] * stamp.warmth;
    for (const std::size_t t : stamp.taxels) {
      const double z = gains[t] * scale * force[t] - trigger - offsets[t];
      *residuals++ = stamp.weightOf(t) * (clippedMean(model.curve.output(z, values + kCurve), noise, model.curve.top) - stamp.image[t]);
    }
    if (!stamp.fixture) residuals = writePosePrior(own, noise, residuals);
    if (model.press_spread > 0 && !model.press_prior) *residuals = noise * (own[kPress] - 1) / model.press_spread;
  };
  StampFit result{.fit = fitGroups(problem), .force = {}};
  for (std::size_t g = 0; g < model.stamps.size(); ++g) {
    const std::array<double, 6> own = ownOf(model, g, result.fit.shared.data(), result.fit.own[g].data());
    result.force.push_back(forces.spread(g, own.data(), std::exp(result.fit.shared[kStiffness]), result.fit.shared[kSigma]));
    const double gain = own[kPress] * std::exp(result.fit.shared[kWarmGain] * model.stamps[g].warmth);
    for (double& force : result.force.back()) force *= gain;
  }
  return result;
}

}  // namespace taxelsim
