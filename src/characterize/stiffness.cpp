// Force against penetration depth: F = k integral of (depth - offset - h)^n over the indenter's section; paper, section III.C and figure 6.
#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "characterize/fits.h"
#include "characterize/footprint.h"
#include "characterize/least_squares.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

constexpr std::size_t kLeastRows = 4;
constexpr std::size_t kMaxRows = 20000;  // more are thinned evenly
constexpr std::size_t kMaxDots = 2000;

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
    const std::size_t count = std::min(kMaxRows, data.depth.size());
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
    FitFigure::Curve dots{.name = measurements[m]->name, .measured = true, .x = {}, .y = {}}, line{.name = "fitted", .x = {}, .y = {}};
    const std::size_t every = rows.size() / kMaxDots + 1;
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

}  // namespace

void fitStiffness(Measured measurements, Characterization& result) {
  const std::string file = measurements.front()->file.generic_string();
  auto* const law = std::get_if<Winkler>(&result.sensor.skin.law);
  if (law == nullptr) throw Error(ErrorKind::kInput, file + ": only skins of law winkler can be fitted to force against depth");
  const std::vector<Row> rows = rowsOf(measurements);
  double most_force = 0;
  for (const Row& row : rows) most_force = std::max(most_force, row.force);

  // Where contact may begin: from the start of the travel to where a tenth of the force is reached. The stiffness to begin with is that
  // which carries the largest force over the travel from the first depth that carries a hundredth of it.
  std::vector<FitParameter> parameters(1);
  double deepest = 0;
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
    if (!(force > 0) || !(travel > 0))
      throw Error(ErrorKind::kInput,
                  measurements[m]->file.generic_string() + ": nothing is pressed: the force or the depth is the same in all rows");
    parameters.push_back({.start = touch, .scale = travel, .low = first - 10 * travel, .high = last});
    deepest = std::max(deepest, last - touch);
    const double volume = volumeUnder(std::get<ForceDepth>(measurements[m]->data).indenter, law->normal_exponent, last - touch);
    parameters[0].start = volume > 0 ? force / volume : law->normal_contact_stiffness;
  }
  parameters[0].scale = parameters[0].start;
  parameters[0].low = 0;
  if (rows.size() < kLeastRows + measurements.size()) {
    throw Error(ErrorKind::kInput, file + ": " + std::to_string(rows.size()) + " rows are not enough: at least " +
                                       std::to_string(kLeastRows + measurements.size()));
  }
  const FitResult fit = fitRows(rows.size(), parameters, [&](std::size_t r, const double* p) {
    return p[0] * volumeUnder(*rows[r].indenter, law->normal_exponent, rows[r].depth - p[1 + rows[r].measurement]) - rows[r].force;
  });

  const auto add = [&](std::string parameter, std::string unit, std::size_t p) {
    const double half = fit.halfWidth(p);
    const bool determined = std::isfinite(half);
    result.estimates.push_back({.parameter = std::move(parameter),
                                .unit = std::move(unit),
                                .determined = determined,
                                .value = fit.values[p],
                                .low = fit.values[p] - half,
                                .high = fit.values[p] + half,
                                .remark = determined ? "" : "the rows do not tell stiffness and contact apart"});
    return determined;
  };
  const std::string unit = law->normal_exponent == 1 ? "N/m^3" : "Pa/m^" + numberText(law->normal_exponent);
  if (add("skin.normal_contact_stiffness", unit, 0)) law->normal_contact_stiffness = fit.values[0];
  for (std::size_t m = 0; m < measurements.size(); ++m) add(measurements[m]->name + ".contact_offset", "m", 1 + m);
  result.estimates.push_back({.parameter = "skin.thickness",
                              .unit = "m",
                              .remark = "pressed " + numberText(std::round(deepest * 1e6) / 1e3) +
                                        " mm deep without meeting its end: the sensor file's " +
                                        numberText(result.sensor.skin.thickness * 1e3) + " mm stay"});
  if (deepest > result.sensor.skin.thickness) {
    result.sensor.skin.thickness = deepest;
    result.estimates.back().remark =
        "pressed " + numberText(std::round(deepest * 1e6) / 1e3) + " mm deep, more than the sensor file's thickness: raised to that";
  }
  result.fits.push_back({.measurement = measurements.front()->name,
                         .unit = "N",
                         .rms = fit.residual_sd,
                         .num_rows = rows.size(),
                         .num_outliers = fit.num_outliers});
  result.figures.push_back(figureOf(measurements, rows, fit, law->normal_exponent));
}

}  // namespace taxelsim
