#include "reference/pressure_transport.h"

#include <cmath>
#include <limits>

#include "base/vector3.h"
#include "reference/area_depth.h"

namespace taxelsim::reference {
namespace {

// Value between samples n - 1 and n of a row of `count` samples; at the rim extrapolated linearly, with one sample per taxel constant.
template <typename Values>
double onSide(int n, int count, int samples_per_taxel, Values value) {
  if (n > 0 && n < count) return (value(n - 1) + value(n)) / 2;
  const int rim = n == 0 ? 0 : count - 1, inside = n == 0 ? 1 : count - 2;
  return samples_per_taxel == 1 ? value(rim) : value(rim) + (value(rim) - value(inside)) / 2;
}

// J and the source -f' u_z0 of the header.
double fluxX(const Motion& m, double f, double G, double y) {
  return f * m.v[0] - G * m.w[1] - f * y * m.w[2];
}
double fluxY(const Motion& m, double f, double G, double x) {
  return f * m.v[1] + G * m.w[0] + f * x * m.w[2];
}
double source(const Motion& m, double stiffness, double x, double y) {
  return -stiffness * (m.v[2] + y * m.w[0] - x * m.w[1]);
}

}  // namespace

PressureField::PressureField(const Sensor& sensor, const GridPatch& patch, std::size_t first_sample, const Frame& frame)
    : s(sensor.samples_per_taxel),
      rows(patch.num_rows * s),
      cols(patch.num_cols * s),
      hx(patch.pitch[0] / s),
      hy(patch.pitch[1] / s),
      num_cols_(patch.num_cols),
      first_(first_sample),
      frame_(frame),
      thickness_(sensor.skin.thickness),
      law_(foundationOf(sensor.skin)),
      relaxes_(!sensor.skin.relaxation.empty()) {
  for (int u = 0; u < rows; ++u) {
    for (int v = 0; v < cols; ++v) frame.share.empty() ? addSample(u, v) : addCell(u, v);
  }
}

double PressureField::onRowSide(const std::vector<double>& values, int u, int v) const {
  return onSide(u, rows, s, [&](int row) { return at(values, row, v); });
}

double PressureField::onColumnSide(const std::vector<double>& values, int u, int v) const {
  return onSide(v, cols, s, [&](int column) { return at(values, u, column); });
}

std::size_t PressureField::index(int u, int v) const {
  const int taxel = u / s * num_cols_ + v / s;
  return first_ + static_cast<std::size_t>(taxel * s * s + u % s * s + v % s);
}

// Negative above the skin.
double PressureField::depthAt(int u, int v) const {
  return std::min(-frame_.heights[index(u, v)], thickness_);
}

double PressureField::elasticPressure(double d) const {
  return law_.normal_contact_stiffness * std::pow(std::clamp(d, 0.0, thickness_), law_.normal_exponent);
}

// Absolute depth difference to the neighbours within the taxel, the smaller of both sides, because the other side may cross a wall of the
// object. 0 if it is at least twice the sample spacing (a wall). Neighbours higher above the skin than the sample spacing are ignored.
double PressureField::depthStep(int u, int v, int du, int dv) const {
  double smallest = std::numeric_limits<double>::infinity();
  for (const int side : {-1, 1}) {
    const int nu = u + side * du, nv = v + side * dv;
    if (nu < 0 || nv < 0 || nu / s != u / s || nv / s != v / s) continue;
    const double d = depthAt(nu, nv);
    if (d > -reach()) smallest = std::min(smallest, std::abs(depthAt(u, v) - d));
  }
  return smallest < 2 * reach() ? smallest : 0;
}

// Mean of f' over depths uniformly distributed in an interval of `width` about d.
double PressureField::meanSlope(double d, double width) const {
  const double n = law_.normal_exponent;
  const double low = d - width / 2, high = d + width / 2;
  const auto slopeAt = [&](double depth) { return law_.normal_contact_stiffness * n * std::pow(depth, n - 1); };
  if (width < 1e-9) return d > 0 && d < thickness_ ? slopeAt(d) : 0;
  if (low <= 0) return elasticPressure(high) / width;
  if (high <= thickness_) return slopeAt(d);
  return low < thickness_ ? slopeAt((low + thickness_) / 2) * (thickness_ - low) / width : 0;
}

// Exponents other than 1: sums over the points of a cell.
void PressureField::addPoints(std::size_t n, bool is_full) {
  const double pressure = frame_.contact.pressure[n], share = frame_.share[n], exponent = law_.normal_exponent;
  double at_rest = 0, slope = 0, moment = 0;
  for (const CellPoint& point : frame_.points[n]) {
    at_rest += share * point.weight * elasticPressure(point.depth);
    slope += share * point.weight * law_.normal_contact_stiffness * exponent * std::pow(point.depth, exponent - 1);
    moment += share * point.weight * elasticPressure(point.depth) * point.depth / (exponent + 1);
  }
  const double ratio = pressure <= 0 ? 0 : relaxes_ ? pressure / at_rest : 1;  // of the relaxed to the instantaneous stiffness
  G.push_back(ratio * moment);
  stiffness.push_back(is_full ? 0 : ratio * slope);
}

// With area sampling.
void PressureField::addCell(int u, int v) {
  const std::size_t n = index(u, v);
  const double pressure = frame_.contact.pressure[n], d = frame_.penetration[n], share = frame_.share[n];
  const double ratio = pressure > 0 ? pressure / elasticPressure(d) : 0;  // of the relaxed to the instantaneous stiffness
  const bool is_full = share >= kLeastShareOfFull && d >= kFullDepth * thickness_ * share;
  f.push_back(pressure);
  if (law_.normal_exponent != 1) return addPoints(n, is_full);
  G.push_back(pressure > 0 ? pressure * d / (2 * share) : 0);
  stiffness.push_back(is_full ? 0 : (relaxes_ || pressure <= 0 ? ratio : 1) * share * law_.normal_contact_stiffness);
}

void PressureField::addSample(int u, int v) {
  const double pressure = frame_.contact.pressure[index(u, v)], d = depthAt(u, v);
  double stiffness_ratio = 1;  // of the relaxed to the instantaneous stiffness
  if (relaxes_) stiffness_ratio = d > 0 ? pressure / elasticPressure(d) : 0;
  if (d > 0 && pressure <= 0) stiffness_ratio = 0;  // released by a damper, or above a residual dent
  const double width = relaxes_ || d <= -reach() ? 0 : std::hypot(depthStep(u, v, 1, 0), depthStep(u, v, 0, 1));
  f.push_back(pressure);
  G.push_back(stiffness_ratio * std::max(d, 0.0) * elasticPressure(d) * law_.normal_exponent / (law_.normal_exponent + 1));
  stiffness.push_back(stiffness_ratio * meanSlope(d, width));
}

std::vector<double> taxelForceRates(const PressureField& field, const Motion& m) {
  const int num_rows = field.rows / field.s, num_cols = field.cols / field.s;
  std::vector<double> rates(static_cast<std::size_t>(num_rows * num_cols), 0);
  const auto rate = [&](int i, int j) -> double& { return rates[static_cast<std::size_t>(i * num_cols + j)]; };
  for (int i = 0; i <= num_rows; ++i) {
    for (int v = 0; v < field.cols; ++v) {
      const int u = i * field.s;
      const double flux = field.hy * fluxX(m, field.onRowSide(field.f, u, v), field.onRowSide(field.G, u, v), field.y(v));
      if (i > 0) rate(i - 1, v / field.s) -= flux;
      if (i < num_rows) rate(i, v / field.s) += flux;
    }
  }
  for (int j = 0; j <= num_cols; ++j) {
    for (int u = 0; u < field.rows; ++u) {
      const int v = j * field.s;
      const double flux = field.hx * fluxY(m, field.onColumnSide(field.f, u, v), field.onColumnSide(field.G, u, v), field.x(u));
      if (j > 0) rate(u / field.s, j - 1) -= flux;
      if (j < num_cols) rate(u / field.s, j) += flux;
    }
  }
  for (int u = 0; u < field.rows; ++u) {
    for (int v = 0; v < field.cols; ++v) {
      rate(u / field.s, v / field.s) += field.hx * field.hy * source(m, field.at(field.stiffness, u, v), field.x(u), field.y(v));
    }
  }
  return rates;
}

Vector3 momentRates(const PressureField& field, const Motion& m) {
  Vector3 rates{0, 0, 0};
  const auto lose = [&](double flux, double x, double y) { rates = subtract(rates, scale(flux, {1, x, y})); };
  for (int u = 0; u < field.rows; ++u) {
    for (int v = 0; v < field.cols; ++v) {
      const double area = field.hx * field.hy, x = field.x(u), y = field.y(v);
      const double f = field.at(field.f, u, v), G = field.at(field.G, u, v);
      rates = add(rates, scale(area * source(m, field.at(field.stiffness, u, v), x, y), {1, x, y}));
      rates = add(rates, {0, area * fluxX(m, f, G, y), area * fluxY(m, f, G, x)});
    }
  }
  for (const int u : {0, field.rows}) {
    for (int v = 0; v < field.cols; ++v) {
      const double x = field.x(u - 0.5), y = field.y(v), out = u == 0 ? -1 : 1;
      lose(out * field.hy * fluxX(m, field.onRowSide(field.f, u, v), field.onRowSide(field.G, u, v), y), x, y);
    }
  }
  for (const int v : {0, field.cols}) {
    for (int u = 0; u < field.rows; ++u) {
      const double x = field.x(u), y = field.y(v - 0.5), out = v == 0 ? -1 : 1;
      lose(out * field.hx * fluxY(m, field.onColumnSide(field.f, u, v), field.onColumnSide(field.G, u, v), x), x, y);
    }
  }
  return rates;
}

}  // namespace taxelsim::reference
