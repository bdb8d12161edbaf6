// Images over time under a flat stamp with a dead weight that lies where it lies: its place, turn and tilt are fitted together with what
// all measurements share, the spread, the readout's scale and trigger, on curved skins the stiffness.
//
// The image of a measurement is the median, taxel by taxel, of the frames from 4.5 to 5.5 s after the touch. The stamp presses an elastic
// foundation (Skin) as deep as carries the weight; of a taxel's cells, samples_per_taxel per side, counts what the stamp covers.
#include <algorithm>
#include <cmath>
#include <functional>

#include "base/text.h"
#include "base/vector3.h"
#include "characterize/clipped_mean.h"
#include "characterize/creep.h"
#include "characterize/fits.h"
#include "characterize/footprint.h"
#include "characterize/least_squares.h"
#include "reference/readout.h"
#include "reference/samples.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

constexpr double kWindowBegin = 4.5, kWindowEnd = 5.5;  // s after the touch
constexpr double kSteady = 5;                           // s after the touch: what the image stands for
constexpr double kStill = 2;                            // counts
constexpr double kLeastSlope = 0.3;                     // cosine between stamp and taxel below which it is not touched
constexpr double kMostTilt = 0.05;                      // rad
constexpr double kGainDeviation = 0.1;                  // of taxels' gains about 1, before anything was measured
constexpr double kMostGain = 0.5;                       // off 1: more is an outlier
constexpr std::size_t kLeastImagesForGains = 6;
constexpr int kGainRounds = 12;
constexpr int kMaxKernelReach = kMaxKernelSize / 2;
// Of the trigger, and counts: what a reading at 5 s exceeds that showed from the onset.
constexpr double kClearOfTrigger = 0.5, kClearCounts = 20;
constexpr double kPlane = 1e-6;  // m and rad: a skin more even than that is plane

// Of a stamp: x, y (m), yaw (rad), slopes of its face along x and y of S, gain of this press.
constexpr std::size_t kX = 0, kY = 1, kYaw = 2, kSlopeX = 3, kSlopeY = 4, kPress = 5;
// Shared: sigma (taxels or m), scale (counts/N), trigger (counts), logarithm of the stiffness.
constexpr std::size_t kSigma = 0, kScale = 1, kTrigger = 2, kStiffness = 3;

struct Stamp {
  const Measurement* measurement = nullptr;
  const StampImages* data = nullptr;
  CreepSeries sum;                  // of counts
  std::vector<double> image;        // (num_taxels), counts
  std::vector<std::size_t> taxels;  // that are fitted
};

struct Model {
  const Sensor* sensor = nullptr;
  Winkler foundation{};
  std::vector<reference::Sample> samples{};
  std::vector<std::array<double, 2>> half_cell{};  // (patches), m
  std::vector<Pose> X_PS{};                        // (patches)
  Eigen::MatrixXd squared_distance{};              // (num_taxels x num_taxels), taxels^2 or m^2; infinite beyond the reach
  std::vector<double> gain{};                      // (num_taxels)
  std::vector<Stamp> stamps{};
  double noise = 0;   // counts
  double top = 4095;  // counts
  bool is_plane = true;
  bool with_tilt = false;
  double press_spread = 0;  // of the gain of a press; 0: not fitted
};

struct Fit {
  GroupedFit fit;
  std::vector<std::vector<double>> mean;  // (stamps, num_taxels): output before it is clipped, counts, without the taxels' own gains
};

CreepSeries sumOf(const Measurement& measurement, const Images& images) {
  CreepSeries sum{.file = measurement.file.generic_string(), .time = images.time, .values = {}};
  for (std::size_t row = 0; row < images.time.size(); ++row) {
    double total = 0;
    for (std::size_t t = 0; t < images.num_taxels; ++t) total += images.counts[row * images.num_taxels + t];
    sum.values.push_back(total);
  }
  return sum;
}

Stamp stampOf(const Measurement& measurement) {
  Stamp stamp{.measurement = &measurement, .data = &std::get<StampImages>(measurement.data), .sum = {}, .image = {}, .taxels = {}};
  const Images& images = stamp.data->images;
  stamp.sum = sumOf(measurement, images);
  if (*std::max_element(stamp.sum.values.begin(), stamp.sum.values.end()) <= kStill) {
    throw Error(ErrorKind::kInput, stamp.sum.file + ": nothing touches: all counts together never exceed 2");
  }
  const Onset onset = onsetOf(stamp.sum);
  for (std::size_t t = 0; t < images.num_taxels; ++t) {
    std::vector<double> counts;
    for (std::size_t row = onset.first_row; row < onset.end_row; ++row) {
      const double after = images.time[row] - onset.start;
      if (after >= kWindowBegin && after <= kWindowEnd) counts.push_back(images.counts[row * images.num_taxels + t]);
    }
    if (counts.empty()) {
      throw Error(ErrorKind::kInput, stamp.sum.file + ": no frame under load from " + numberText(kWindowBegin) + " to " +
                                         numberText(kWindowEnd) + " s after the touch");
    }
    stamp.image.push_back(medianOf(std::move(counts)));
  }
  return stamp;
}

// Between taxels of one grid in taxels, without those that no kernel reaches; between taxels of a list along the skin.
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

// Force on each taxel, N, under a stamp that is pressed as deep as carries its load; all 0 where it meets no taxel.
std::vector<double> forcesUnder(const Model& model, const Stamp& stamp, const double* own, double stiffness) {
  const Vector3 n_S{-own[kSlopeX], -own[kSlopeY], 1};
  const Polygon outline = moved(sectionOf(stamp.data->indenter, 0), {own[kX], own[kY]}, own[kYaw]);
  const std::size_t num_patches = model.X_PS.size();
  std::vector<Polygon> outline_P(num_patches);
  std::vector<Vector3> n_P(num_patches), middle_P(num_patches);
  std::vector<std::array<double, 2>> low_P(num_patches, {1e300, 1e300}), high_P(num_patches, {-1e300, -1e300});
  for (std::size_t p = 0; p < num_patches; ++p) {
    n_P[p] = rotate(model.X_PS[p].rotation, n_S);
    middle_P[p] = model.X_PS[p] * Vector3{own[kX], own[kY], 0};
    if (n_P[p][2] < kLeastSlope) continue;
    for (const auto& corner : outline) {
      const double z = own[kSlopeX] * (corner[0] - own[kX]) + own[kSlopeY] * (corner[1] - own[kY]);
      const Vector3 corner_P = model.X_PS[p] * Vector3{corner[0], corner[1], z};
      outline_P[p].push_back({corner_P[0], corner_P[1]});
      for (std::size_t axis = 0; axis < 2; ++axis) {
        low_P[p][axis] = std::min(low_P[p][axis], corner_P[axis]);
        high_P[p][axis] = std::max(high_P[p][axis], corner_P[axis]);
      }
    }
  }
  struct Cell {
    int taxel;
    double area;    // m^2, covered
    double height;  // m, of the face over the skin along the taxel's normal, before the stamp is let down
    double rate;    // m of height per m down
  };
  std::vector<Cell> cells;
  double deepest = -1e300;
  for (const reference::Sample& sample : model.samples) {
    const auto p = static_cast<std::size_t>(sample.patch);
    if (outline_P[p].empty()) continue;
    const double x = sample.position_P[0], y = sample.position_P[1];
    const auto& half = model.half_cell[p];
    if (x + half[0] <= low_P[p][0] || x - half[0] >= high_P[p][0] || y + half[1] <= low_P[p][1] || y - half[1] >= high_P[p][1]) continue;
    const double area = overlap(outline_P[p], {x - half[0], y - half[1]}, {x + half[0], y + half[1]});
    if (area <= 0) continue;
    const Vector3& n = n_P[p];
    const double height = middle_P[p][2] - (n[0] * (x - middle_P[p][0]) + n[1] * (y - middle_P[p][1])) / n[2];
    cells.push_back({sample.taxel, area, height, 1 / n[2]});
    deepest = std::max(deepest, -height * n[2]);
  }
  std::vector<double> force(model.gain.size(), 0.0);
  if (cells.empty()) return force;
  const double exponent = model.foundation.normal_exponent;
  // Force and its growth per m down: convex, so that Newton's steps from a depth that is too large never pass the right one.
  const auto press = [&](double down) {
    std::array<double, 2> sum{0, 0};
    for (const Cell& cell : cells) {
      const double depth = down * cell.rate - cell.height;
      if (depth <= 0) continue;
      const double below = exponent == 1 ? 1 : std::pow(depth, exponent - 1);
      sum[0] += cell.area * stiffness * below * depth;
      sum[1] += cell.area * stiffness * exponent * below * cell.rate;
    }
    return sum;
  };
  double high = -deepest + 1e-4;
  while (press(high)[0] < stamp.data->load && high < 1) high = -deepest + 2 * (high + deepest);
  for (int round = 0; round < 30; ++round) {
    const auto [sum, growth] = press(high);
    const double step = (sum - stamp.data->load) / growth;
    if (!(step > 1e-13)) break;
    high -= step;
  }
  for (const Cell& cell : cells) {
    const double depth = high * cell.rate - cell.height;
    if (depth > 0) force[static_cast<std::size_t>(cell.taxel)] += cell.area * stiffness * std::pow(depth, exponent);
  }
  const double off = stamp.data->load / std::max(press(high)[0], 1e-300);
  for (double& value : force) value *= off;
  return force;
}

// What the derivatives ask for again and again: weights per source, columns of sum 1, of the sigmas asked for last, and forces under each
// stamp where it lay last.
class Memory {
 public:
  explicit Memory(const Model& model) : model_(model), squared_distance_(model.squared_distance), pressed_(model.stamps.size()) {}

  const std::vector<double>& forces(std::size_t stamp, const double* own, double stiffness) {
    const std::array<double, 6> at{own[kX], own[kY], own[kYaw], own[kSlopeX], own[kSlopeY], stiffness};
    Pressed& pressed = pressed_[stamp];
    if (pressed.force.empty() || pressed.at != at) pressed = {at, forcesUnder(model_, model_.stamps[stamp], own, stiffness)};
    return pressed.force;
  }

  const Eigen::MatrixXd& weights(double sigma) {
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

 private:
  struct Pressed {
    std::array<double, 6> at{};
    std::vector<double> force{};  // (num_taxels), N
  };

  const Model& model_;
  const Eigen::MatrixXd& squared_distance_;
  std::vector<Pressed> pressed_;  // (stamps)
  std::vector<std::pair<double, Eigen::MatrixXd>> last_;
};

std::vector<double> outputsOf(std::size_t stamp, const double* shared, const double* own, Memory& memory) {
  const std::vector<double>& force = memory.forces(stamp, own, std::exp(shared[kStiffness]));
  const Eigen::MatrixXd& weights = memory.weights(shared[kSigma]);
  Eigen::VectorXd spread = Eigen::VectorXd::Zero(weights.rows());
  for (std::size_t t = 0; t < force.size(); ++t) {
    if (force[t] > 0) spread += force[t] * weights.col(static_cast<Eigen::Index>(t));
  }
  std::vector<double> outputs;
  for (const double value : spread) outputs.push_back(own[kPress] * shared[kScale] * value);
  return outputs;
}

void chooseTaxels(Model& model, bool all) {
  for (Stamp& stamp : model.stamps) {
    stamp.taxels.clear();
    for (std::size_t t = 0; t < stamp.image.size(); ++t) {
      if (model.gain[t] > 0 && (all || (stamp.image[t] > 0 && stamp.image[t] < model.top))) stamp.taxels.push_back(t);
    }
  }
}

Fit fitStamps(const Model& model, const std::vector<double>& shared, const std::vector<std::vector<double>>& own) {
  // A parameter that stays is one whose bounds are its value.
  const auto fixed = [](double value) { return FitParameter{.start = value, .scale = 1, .low = value, .high = value}; };
  const auto free = [](double value, double scale, double low, double high) {
    return FitParameter{.start = value, .scale = scale, .low = low, .high = high};
  };
  const double unit = isTaxelList(*model.sensor) ? model.sensor->patches[0].pitch[0] : 1;
  GroupedProblem problem{.shared = {}, .own = {}, .num_rows = {}, .noise = model.noise, .residuals = {}};
  problem.shared = {
      free(shared[kSigma], 0.1 * unit, 0.15 * unit, 4 * unit), free(shared[kScale], shared[kScale], 0, 1e12),
      free(shared[kTrigger], 10, 0, 1e6),
      model.is_plane ? fixed(shared[kStiffness]) : free(shared[kStiffness], 1, shared[kStiffness] - 5, shared[kStiffness] + 5)};
  for (std::size_t g = 0; g < model.stamps.size(); ++g) {
    const Stamp& stamp = model.stamps[g];
    const std::vector<double>& at = own[g];
    const bool round = stamp.data->indenter.shape == Indenter::Shape::kFlatPin;
    const auto slope = [&](std::size_t p) { return model.with_tilt ? free(at[p], 1e-3, -kMostTilt, kMostTilt) : fixed(at[p]); };
    problem.own.push_back({free(at[kX], 1e-3, -1, 1), free(at[kY], 1e-3, -1, 1), round ? fixed(0) : free(at[kYaw], 0.1, -0.8, 0.8),
                           slope(kSlopeX), slope(kSlopeY), model.press_spread > 0 ? free(at[kPress], 0.1, 0.2, 5) : fixed(1)});
    problem.num_rows.push_back(stamp.taxels.size() + (model.press_spread > 0 ? 1 : 0));
  }
  Memory memory(model);
  problem.residuals = [&](std::size_t g, const double* shared_values, const double* own_values, double* residuals) {
    const Stamp& stamp = model.stamps[g];
    const std::vector<double> outputs = outputsOf(g, shared_values, own_values, memory);
    for (std::size_t k = 0; k < stamp.taxels.size(); ++k) {
      const std::size_t t = stamp.taxels[k];
      residuals[k] =
          clippedMean(model.gain[t] * outputs[t] - shared_values[kTrigger], std::max(kLeastNoise, model.noise), model.top) - stamp.image[t];
    }
    // What is known of a press before: its gain is 1, give or take.
    if (model.press_spread > 0) residuals[stamp.taxels.size()] = model.noise * (own_values[kPress] - 1) / model.press_spread;
  };
  Fit result{.fit = fitGroups(problem), .mean = {}};
  for (std::size_t g = 0; g < model.stamps.size(); ++g) {
    result.mean.push_back(outputsOf(g, result.fit.shared.data(), result.fit.own[g].data(), memory));
  }
  return result;
}

// Standard deviation (counts) of readings that no end clips.
double noiseOf(const Model& model, const Fit& found) {
  double squares = 0, count = 0;
  for (std::size_t g = 0; g < model.stamps.size(); ++g) {
    for (std::size_t k = 0; k < model.stamps[g].taxels.size(); ++k) {
      const double counts = model.stamps[g].image[model.stamps[g].taxels[k]];
      if (found.fit.outlier[g][k] || counts <= 0 || counts >= model.top) continue;
      squares += found.fit.residual[g][k] * found.fit.residual[g][k];
      ++count;
    }
  }
  const double used = static_cast<double>(found.fit.num_rows - found.fit.num_outliers);
  const double freedom = std::max(1.0, count - (used - static_cast<double>(found.fit.degrees_of_freedom)));
  return std::max(kLeastNoise, std::sqrt(squares / freedom));
}

// Spread of the gain of presses, by how far each image's best scale is from 1; 0 where noise alone explains it.
double pressSpread(const Model& model, const Fit& found) {
  double squares = 0, expected = 0, chi = 0;
  const auto count = static_cast<double>(model.stamps.size());
  for (std::size_t g = 0; g < model.stamps.size(); ++g) {
    double product = 0, power = 0;
    for (const std::size_t t : model.stamps[g].taxels) {
      const double counts = model.stamps[g].image[t], mean = model.gain[t] * found.mean[g][t];
      if (counts <= 0 || counts >= model.top) continue;
      product += (counts + found.fit.shared[kTrigger]) * mean;
      power += mean * mean;
    }
    if (!(power > 0)) continue;
    const double off = product / power - 1, variance = model.noise * model.noise / power;
    squares += off * off, expected += variance, chi += off * off / variance;
  }
  const bool significant = model.stamps.size() >= 3 && chi > count + 4 * std::sqrt(2 * count);
  return significant ? std::sqrt(std::max(0.0, squares - expected) / (count - 1)) : 0;
}

// Gains with the prior 1 +- kGainDeviation, each by itself with all else as found. Standard deviations; infinite for taxels never loaded.
std::vector<double> fitGains(Model& model, const Fit& found) {
  const double prior = model.noise * model.noise / (kGainDeviation * kGainDeviation);
  std::vector<double> product(model.gain.size(), prior), power(model.gain.size(), prior), deviation;
  std::vector<bool> loaded(model.gain.size(), false);
  for (std::size_t g = 0; g < model.stamps.size(); ++g) {
    for (std::size_t k = 0; k < model.stamps[g].taxels.size(); ++k) {
      const std::size_t t = model.stamps[g].taxels[k];
      const double counts = model.stamps[g].image[t], mean = found.mean[g][t];
      // What a gain may explain is no outlier yet.
      const double off = std::abs(counts + found.fit.shared[kTrigger] - mean);
      if (off > kMostGain * mean + kFarNoise * model.noise || counts <= 0 || counts >= model.top) continue;
      product[t] += (counts + found.fit.shared[kTrigger]) * mean;
      power[t] += mean * mean;
      loaded[t] = true;
    }
  }
  double sum = 0, num = 0;
  for (std::size_t t = 0; t < loaded.size(); ++t) {
    deviation.push_back(loaded[t] ? model.noise / std::sqrt(power[t]) : std::numeric_limits<double>::infinity());
    if (model.gain[t] > 0) model.gain[t] = loaded[t] ? product[t] / power[t] : 1;
    if (loaded[t]) sum += model.gain[t] * (power[t] - prior), num += power[t] - prior;
  }
  // Their mean, by what they carried, is the scale's.
  for (std::size_t t = 0; t < loaded.size(); ++t) {
    if (loaded[t]) model.gain[t] *= num / sum;
  }
  return deviation;
}

std::vector<std::vector<double>> startOf(const Model& model) {
  const std::vector<Vector3> positions = taxelPositions(*model.sensor);
  std::vector<std::vector<double>> own;
  for (const Stamp& stamp : model.stamps) {
    double x = 0, y = 0, sum = 0;
    for (std::size_t t = 0; t < stamp.image.size(); ++t) {
      x += stamp.image[t] * positions[t][0], y += stamp.image[t] * positions[t][1], sum += stamp.image[t];
    }
    own.push_back({x / sum, y / sum, 0, 0, 0, 1});
  }
  return own;
}

void add(Characterization& result, std::string parameter, std::string unit, double value, double half, std::string remark,
         std::string doubt) {
  const bool determined = std::isfinite(half) && doubt.empty();
  if (doubt.empty() && !determined) doubt = "the images do not tell it";
  result.estimates.push_back({.parameter = std::move(parameter),
                              .unit = std::move(unit),
                              .determined = determined,
                              .value = value,
                              .low = value - half,
                              .high = value + half,
                              .remark = determined ? std::move(remark) : std::move(doubt)});
}

FitFigure figureOf(const Model& model, const Fit& found) {
  FitFigure figure{.title = "Readings under stamps", .x_label = "as fitted, counts", .y_label = "counts", .curves = {}};
  double most = 0;
  for (std::size_t g = 0; g < model.stamps.size(); ++g) {
    FitFigure::Curve dots{.name = model.stamps[g].measurement->name, .measured = true, .x = {}, .y = {}};
    for (std::size_t k = 0; k < model.stamps[g].taxels.size(); ++k) {
      const double counts = model.stamps[g].image[model.stamps[g].taxels[k]];
      dots.x.push_back(counts + found.fit.residual[g][k]);
      dots.y.push_back(counts);
      most = std::max(most, counts);
    }
    figure.curves.push_back(std::move(dots));
  }
  figure.curves.push_back({.name = "equal", .x = {0, most}, .y = {0, most}});
  return figure;
}

}  // namespace

void fitStampImages(Measured measurements, Characterization& result) {
  Model model{.sensor = &result.sensor, .foundation = foundationOf(result.sensor.skin)};
  const Sensor& sensor = result.sensor;
  const auto num_taxels = static_cast<std::size_t>(numTaxels(sensor));
  model.samples = reference::samplesOf(sensor);
  for (const GridPatch& patch : sensor.patches) {
    model.X_PS.push_back(inverse(patch.X_SP));
    model.half_cell.push_back({patch.pitch[0] / (2 * sensor.samples_per_taxel), patch.pitch[1] / (2 * sensor.samples_per_taxel)});
  }
  model.squared_distance = squaredDistances(sensor);
  model.is_plane = isPlane(sensor);
  model.top = sensor.readout.saturation;
  for (std::size_t t = 0; t < num_taxels; ++t) model.gain.push_back(reference::gainOf(sensor.readout, t));
  for (const int dead : result.dead_taxels) model.gain[static_cast<std::size_t>(dead)] = 0;
  for (const Measurement* measurement : measurements) model.stamps.push_back(stampOf(*measurement));

  // What reads between the ends first, then all.
  const double unit = isTaxelList(sensor) ? sensor.patches[0].pitch[0] : 1;
  double counts = 0, load = 0;
  for (const Stamp& stamp : model.stamps) {
    for (const double value : stamp.image) counts += value;
    load += stamp.data->load;
  }
  std::vector<double> shared{0.6 * unit, counts / load, 0, std::log(model.foundation.normal_contact_stiffness)};
  chooseTaxels(model, false);
  Fit found = fitStamps(model, shared, startOf(model));
  model.noise = noiseOf(model, found);
  chooseTaxels(model, true);
  found = fitStamps(model, found.fit.shared, found.fit.own);
  model.noise = noiseOf(model, found);

  std::vector<double> gain_deviation;
  const bool with_gains = model.stamps.size() >= kLeastImagesForGains;
  for (int round = 0; with_gains && round < kGainRounds; ++round) {
    gain_deviation = fitGains(model, found);
    found = fitStamps(model, found.fit.shared, found.fit.own);
    model.noise = noiseOf(model, found);
  }

  model.press_spread = pressSpread(model, found);
  if (model.press_spread > 0) {
    found = fitStamps(model, found.fit.shared, found.fit.own);
    model.noise = noiseOf(model, found);
  }

  // Tilt where it is worth two further numbers an image.
  model.with_tilt = true;
  Fit tilted = fitStamps(model, found.fit.shared, found.fit.own);
  const double tilted_noise = noiseOf(model, tilted);
  const double freedom = static_cast<double>(tilted.fit.degrees_of_freedom);
  if (isBetterFit(cutSquares(found.fit, tilted_noise), cutSquares(tilted.fit, tilted_noise), 2.0 * static_cast<double>(model.stamps.size()),
                  freedom)) {
    found = std::move(tilted);
    model.noise = tilted_noise;
    result.remarks.emplace_back("stamps lie tilted, by more than chance: their slopes are fitted");
  } else {
    model.with_tilt = false;
  }

  if (with_gains) gain_deviation = fitGains(model, found);

  // Over time: one taxel's trigger is missing from the sum for each that shows.
  const double trigger_counts = found.fit.shared[kTrigger];
  // Taxels near the trigger are left out: what they show begins late.
  std::vector<CreepSeries> series;
  for (std::size_t g = 0; g < model.stamps.size(); ++g) {
    const Stamp& stamp = model.stamps[g];
    series.push_back({.file = stamp.sum.file, .time = stamp.sum.time, .values = std::vector<double>(stamp.sum.time.size())});
    std::vector<std::size_t> clear;
    for (std::size_t k = 0; k < stamp.taxels.size(); ++k) {
      const double reading = stamp.image[stamp.taxels[k]];
      const bool is_clear = reading > kClearOfTrigger * trigger_counts + kClearCounts && reading < model.top;
      if (is_clear && !found.fit.outlier[g][k]) clear.push_back(stamp.taxels[k]);
    }
    if (clear.empty()) {
      result.remarks.push_back(stamp.measurement->name + ": no taxel reads well over the trigger, its creep is not fitted");
      series.pop_back();
      continue;
    }
    for (std::size_t row = 0; row < stamp.sum.time.size(); ++row) {
      for (const std::size_t t : clear) {
        const double reading = stamp.data->images.counts[row * num_taxels + t];
        if (reading > 0) series.back().values[row] += reading + trigger_counts;
      }
    }
  }
  CreepFit creep;
  if (!series.empty()) {
    creep = fitCreepTerms(series);
    addCreep(creep, series, measurements.front()->name, "of the sum over taxels, with the trigger of those that show", result);
  }
  double grown = creep.onsets.empty() ? 1 : 0;
  for (const Onset& onset : creep.onsets) {
    grown += creepFactor(creep.terms, kSteady - (onset.time - onset.start)) / static_cast<double>(creep.onsets.size());
  }

  const GroupedFit& fit = found.fit;
  Readout& readout = result.sensor.readout;
  const std::string over = std::to_string(model.stamps.size()) + (model.stamps.size() == 1 ? " image" : " images");
  const double sigma = fit.shared[kSigma], sigma_half = fit.halfWidth(kSigma), scale = fit.shared[kScale] / grown;
  const bool list = isTaxelList(sensor);
  add(result, list ? "psf.skin_gaussian.sigma" : "psf.gaussian.sigma", list ? "m" : "taxels", sigma, sigma_half, over,
      sigma > 0.2 * unit && sigma < 3.9 * unit ? "" : "the images do not tell it");
  if (result.estimates.back().determined) {
    if (list) {
      result.sensor.psf = Psf{.size = 1, .kernel = {1}, .sigma = sigma};
    } else {
      result.sensor.psf = gaussianPsf(sigma, gaussianKernelSize(sigma, std::max(3, result.sensor.psf.size)));
    }
  }
  double grown_half = 0;
  for (std::size_t i = 0; i < creep.terms.size(); ++i) grown_half += creep.fraction_half[i] * -std::expm1(-kSteady / creep.terms[i].time);
  add(result, "readout.curve.counts_per_newton", "counts/N", scale, std::hypot(fit.halfWidth(kScale), scale * grown_half) / grown,
      "before creep, which is " + numberText(std::round((grown - 1) * 1e4) / 100) + " % at 5 s", "");
  if (result.estimates.back().determined) readout.curve = {scale}, readout.output_scale = 1;
  const double trigger = trigger_counts / scale, trigger_half = fit.halfWidth(kTrigger) / scale;
  add(result, "readout.trigger", "N", trigger, trigger_half, over, trigger > trigger_half ? "" : "its interval reaches 0");
  if (result.estimates.back().determined) {
    readout.trigger = trigger;
    readout.taxel_trigger.clear();
  }
  if (model.press_spread > 0) {
    const double freedom_of_presses = static_cast<double>(model.stamps.size() - 1);
    add(result, "readout.press_gain_spread", "", model.press_spread,
        studentFactor(model.stamps.size() - 1) * model.press_spread / std::sqrt(2 * freedom_of_presses), "between the " + over, "");
    readout.press_gain_spread = std::min(model.press_spread, kMaxGainSpread);
  }
  if (!model.is_plane) {
    const double stiffness = std::exp(fit.shared[kStiffness]), half = stiffness * fit.halfWidth(kStiffness);
    add(result, "skin.normal_contact_stiffness", model.foundation.normal_exponent == 1 ? "N/m^3" : "Pa/m^n", stiffness, half,
        "by how far the stamp reaches over the curved skin", half < stiffness ? "" : "the images do not tell it");
    if (auto* const law = std::get_if<Winkler>(&result.sensor.skin.law); law != nullptr && result.estimates.back().determined) {
      law->normal_contact_stiffness = stiffness;
    }
  }
  if (with_gains) {
    readout.taxel_gain = model.gain;
    std::size_t num_unloaded = 0;
    for (std::size_t t = 0; t < num_taxels; ++t) {
      if (model.gain[t] <= 0) continue;
      if (!std::isfinite(gain_deviation[t])) {
        ++num_unloaded;
        continue;
      }
      add(result, "readout.taxel_gain[" + std::to_string(t) + "]", "", model.gain[t], 1.96 * gain_deviation[t], "", "");
    }
    if (num_unloaded > 0) {
      result.remarks.push_back(std::to_string(num_unloaded) +
                               " taxels never carried a load that shows: their gain is not told, it stays 1");
    }
  }
  for (std::size_t g = 0; g < model.stamps.size(); ++g) {
    const std::string& name = model.stamps[g].measurement->name;
    add(result, name + ".x", "m", fit.own[g][kX], fit.ownHalfWidth(g, kX), "", "");
    add(result, name + ".y", "m", fit.own[g][kY], fit.ownHalfWidth(g, kY), "", "");
    if (model.stamps[g].data->indenter.shape == Indenter::Shape::kStamp) {
      add(result, name + ".yaw", "rad", fit.own[g][kYaw], fit.ownHalfWidth(g, kYaw), "", "");
    }
    if (model.with_tilt) {
      add(result, name + ".slope_x", "", fit.own[g][kSlopeX], fit.ownHalfWidth(g, kSlopeX), "", "");
      add(result, name + ".slope_y", "", fit.own[g][kSlopeY], fit.ownHalfWidth(g, kSlopeY), "", "");
    }
  }
  result.fits.push_back({.measurement = measurements.front()->name,
                         .unit = "counts",
                         .rms = fit.residual_sd,
                         .num_rows = fit.num_rows,
                         .num_outliers = fit.num_outliers});
  result.figures.push_back(figureOf(model, found));
}

}  // namespace taxelsim
