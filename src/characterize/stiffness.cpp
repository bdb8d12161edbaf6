// Fits the stiffness of an elastic foundation to force against penetration depth: F = k integral of (depth - offset - h)^n over the
// indenter's cross section; paper, section III.C and figure 6.
#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "characterize/fits.h"
#include "characterize/footprint.h"
#include "characterize/least_squares.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

constexpr std::size_t kLeastDepths = 4;
constexpr std::size_t kMaxDepths = 20000;  // of a measurement; longer ones are subsampled evenly
constexpr std::size_t kMaxDepthDots = 2000;

struct Row {
  const Indenter* indenter;
  std::size_t measurement;
  double depth;  // m
  double force;  // N
};

std::vector<Row> rowsOf(Measured measurements) {
  std::vector<Row> rows;
  for (std::size_t m = 0; m < measurements.size(); ++m) {
    const auto& data = std::get<ForceDepth>(measurements[m]->data);
    const std::size_t count = std::min(kMaxDepths, data.depth.size());
    for (std::size_t k = 0; k < count; ++k) {
      const std::size_t r = k * data.depth.size() / count;
      rows.push_back({&data.indenter, m, data.depth[r], data.force[r]});
    }
  }
  return rows;
}

FitFigure figureOf(Measured measurements, const std::vector<Row>& rows, const FitResult& fit, double exponent) {
  FitFigure figure{.title = "Force against penetration depth", .x_label = "depth, mm", .y_label = "force, N", .curves = {}};
  for (std::size_t m = 0; m < measurements.size(); ++m) {
    const auto& data = std::get<ForceDepth>(measurements[m]->data);
    FitFigure::Curve dots{.name = measurements[m]->name, .measured = true, .x = {}, .y = {}}, line{.name = "fit", .x = {}, .y = {}};
    const std::size_t every = rows.size() / kMaxDepthDots + 1;
    double deepest = 0;
    for (std::size_t r = 0; r < rows.size(); ++r) {
      if (rows[r].measurement != m) continue;
      const double depth = rows[r].depth - fit.values[1 + m];
      deepest = std::max(deepest, depth);
      if (r % every != 0) continue;
      dots.x.push_back(depth * 1e3);
      dots.y.push_back(rows[r].force);
    }
    for (int k = 0; k <= 50; ++k) {
      const double depth = deepest * k / 50;
      line.x.push_back(depth * 1e3);
      line.y.push_back(fit.values[0] * volumeUnder(data.indenter, exponent, depth));
    }
    figure.curves.push_back(std::move(dots));
    figure.curves.push_back(std::move(line));
  }
  return figure;
}

// Start values and bounds: stiffness, then the contact offset of each measurement. The offset starts at the first depth with more than 1 %
// of the largest force; the stiffness then follows from the largest force.
struct Start {
  std::vector<FitParameter> parameters = std::vector<FitParameter>(1);
  double deepest = 0;  // m, after contact
};

Start startOf(Measured measurements, const std::vector<Row>& rows, const Winkler& law) {
  Start start;
  FitParameter& stiffness = start.parameters[0];
  std::vector<FitParameter> offsets;
  for (std::size_t m = 0; m < measurements.size(); ++m) {
    double first = 1e300, last = -1e300, touch = 1e300, force = 0;
    for (const Row& row : rows) {
      if (row.measurement != m) continue;
      first = std::min(first, row.depth), last = std::max(last, row.depth), force = std::max(force, row.force);
    }
    for (const Row& row : rows) {
      if (row.measurement == m && row.force > 0.01 * force) touch = std::min(touch, row.depth);
    }
    const double travel = last - first;
    if (!(force > 0) || !(travel > 0)) {
      throw Error(ErrorKind::kInput,
                  measurements[m]->file.generic_string() + ": no press: the force or the depth is constant, or no force is above 0");
    }
    offsets.push_back({.start = touch, .scale = travel, .low = first - 10 * travel, .high = last});
    start.deepest = std::max(start.deepest, last - touch);
    const double volume = volumeUnder(std::get<ForceDepth>(measurements[m]->data).indenter, law.normal_exponent, last - touch);
    stiffness.start = volume > 0 ? force / volume : law.normal_contact_stiffness;
  }
  stiffness.scale = stiffness.start;
  stiffness.low = 0;
  start.parameters.insert(start.parameters.end(), offsets.begin(), offsets.end());
  return start;
}

// False if the value is not identifiable.
bool report(const FitResult& fit, std::size_t p, std::string parameter, std::string unit, Characterization& result) {
  const double half = fit.halfWidth(p);
  const bool determined = std::isfinite(half);
  result.estimates.push_back({.parameter = std::move(parameter),
                              .unit = std::move(unit),
                              .determined = determined,
                              .value = fit.values[p],
                              .low = fit.values[p] - half,
                              .high = fit.values[p] + half,
                              .remark = determined ? "" : "stiffness and contact offset cannot be separated"});
  return determined;
}

// A skin is at least as thick as it was pressed deep.
void reportThickness(double deepest, Characterization& result) {
  double& thickness = result.sensor.skin.thickness;
  const std::string pressed = "pressed " + numberText(std::round(deepest * 1e6) / 1e3) + " mm deep";
  const bool is_thicker = deepest > thickness;
  result.estimates.push_back(
      {.parameter = "skin.thickness",
       .unit = "m",
       .remark = is_thicker ? pressed + ", more than the thickness in the sensor file; thickness raised to this depth"
                            : pressed + " without reaching the base; keeps the sensor file's " + numberText(thickness * 1e3) + " mm"});
  if (is_thicker) thickness = deepest;
}

}  // namespace

void fitStiffness(Measured measurements, Characterization& result) {
  const std::string file = measurements.front()->file.generic_string();
  auto* const law = std::get_if<Winkler>(&result.sensor.skin.law);
  if (law == nullptr) throw Error(ErrorKind::kInput, file + ": force_depth needs a sensor with skin.law winkler");
  const std::vector<Row> rows = rowsOf(measurements);
  const Start start = startOf(measurements, rows, *law);
  if (rows.size() < kLeastDepths + measurements.size()) {
    throw Error(ErrorKind::kInput, file + ": " + std::to_string(rows.size()) + " rows found, at least " +
                                       std::to_string(kLeastDepths + measurements.size()) + " needed");
  }
  const FitResult fit = fitRows(rows.size(), start.parameters, [&](std::size_t r, const double* p) {
    return p[0] * volumeUnder(*rows[r].indenter, law->normal_exponent, rows[r].depth - p[1 + rows[r].measurement]) - rows[r].force;
  });
  const std::string unit = law->normal_exponent == 1 ? "N/m^3" : "Pa/m^" + numberText(law->normal_exponent);
  if (report(fit, 0, "skin.normal_contact_stiffness", unit, result)) law->normal_contact_stiffness = fit.values[0];
  for (std::size_t m = 0; m < measurements.size(); ++m) report(fit, 1 + m, measurements[m]->name + ".contact_offset", "m", result);
  reportThickness(start.deepest, result);
  result.fits.push_back({.measurement = namesOf(measurements),
                         .unit = "N",
                         .rms = fit.residual_sd,
                         .num_rows = rows.size(),
                         .num_outliers = fit.num_outliers});
  result.figures.push_back(figureOf(measurements, rows, fit, law->normal_exponent));
}

}  // namespace taxelsim
