#include "reference/tactile_jacobian.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "base/vector3.h"
#include "reference/psf.h"
#include "sensor/regions.h"

namespace taxelsim::reference {
namespace {

// What the balance of force asks of every sample of one patch, in the order of a grid: u along x, v along y.
class Field {
 public:
  Field(const Sensor& sensor, const GridPatch& patch, std::size_t first_sample, const Frame& frame)
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
      for (int v = 0; v < cols; ++v) addSample(u, v);
    }
  }

  double x(double u) const { return (u - (rows - 1) / 2.0) * hx; }
  double y(double v) const { return (v - (cols - 1) / 2.0) * hy; }
  double at(const std::vector<double>& values, int u, int v) const { return values[static_cast<std::size_t>(u * cols + v)]; }

  // On the side before row u (0 to rows) at column v, and before column v (0 to cols) at row u.
  double beforeRow(const std::vector<double>& values, int u, int v) const {
    return between(u, rows, [&](int row) { return at(values, row, v); });
  }
  double beforeColumn(const std::vector<double>& values, int u, int v) const {
    return between(v, cols, [&](int column) { return at(values, u, column); });
  }

  const int s, rows, cols;
  const double hx, hy;                  // m
  std::vector<double> f, G, stiffness;  // (rows x cols): f, G and the mean of f' over the sample's cell; Pa, Pa m, Pa/m

 private:
  std::size_t index(int u, int v) const {
    const int taxel = u / s * num_cols_ + v / s;
    return first_ + static_cast<std::size_t>(taxel * s * s + u % s * s + v % s);
  }

  // < 0 over the skin.
  double depthAt(int u, int v) const { return std::min(-frame_.heights[index(u, v)], thickness_); }

  double elastic(double d) const { return law_.normal_contact_stiffness * std::pow(std::clamp(d, 0.0, thickness_), law_.normal_exponent); }

  double reach() const { return s > 1 ? std::max(hx, hy) : 0; }

  // How much depth differs from the neighbours in the same taxel, the less of the two sides: the other may be a wall, and whatever is twice
  // as high as samples lie apart is. What lies farther over the skin than they do is not looked at.
  double step(int u, int v, int du, int dv) const {
    double least = std::numeric_limits<double>::infinity();
    for (const int side : {-1, 1}) {
      const int nu = u + side * du, nv = v + side * dv;
      if (nu < 0 || nv < 0 || nu / s != u / s || nv / s != v / s) continue;
      const double d = depthAt(nu, nv);
      if (d > -reach()) least = std::min(least, std::abs(depthAt(u, v) - d));
    }
    return least < 2 * reach() ? least : 0;
  }

  // The mean of f' over depths spread evenly about d.
  double meanSlope(double d, double width) const {
    const double n = law_.normal_exponent;
    const double low = d - width / 2, high = d + width / 2;
    const auto slopeAt = [&](double depth) { return law_.normal_contact_stiffness * n * std::pow(depth, n - 1); };
    if (width < 1e-9) return d > 0 && d < thickness_ ? slopeAt(d) : 0;
    if (low <= 0) return elastic(high) / width;  // the part from 0 on
    if (high <= thickness_) return slopeAt(d);
    return low < thickness_ ? slopeAt((low + thickness_) / 2) * (thickness_ - low) / width : 0;
  }

  void addSample(int u, int v) {
    const double pressure = frame_.contact.pressure[index(u, v)], d = depthAt(u, v);
    double share = 1;  // of its stiffness, which a sample still has
    if (relaxes_) share = d > 0 ? pressure / elastic(d) : 0;
    if (d > 0 && pressure <= 0) share = 0;  // a damper or a dent lets go
    const double width = relaxes_ || d <= -reach() ? 0 : std::hypot(step(u, v, 1, 0), step(u, v, 0, 1));
    f.push_back(pressure);
    G.push_back(share * std::max(d, 0.0) * elastic(d) * law_.normal_exponent / (law_.normal_exponent + 1));
    stiffness.push_back(share * meanSlope(d, width));
  }

  template <typename Values>
  double between(int n, int count, Values value) const {
    if (n > 0 && n < count) return (value(n - 1) + value(n)) / 2;
    const int rim = n == 0 ? 0 : count - 1, inside = n == 0 ? 1 : count - 2;
    return s == 1 ? value(rim) : value(rim) + (value(rim) - value(inside)) / 2;
  }

  int num_cols_;
  std::size_t first_;
  const Frame& frame_;
  double thickness_;
  Winkler law_;
  bool relaxes_;
};

// An object's, about the origin of P, in P.
struct Motion {
  Vector3 v, w;
};

// J and f' u_z of the header.
double flowX(const Motion& m, double f, double G, double y) {
  return f * m.v[0] - G * m.w[1] - f * y * m.w[2];
}
double flowY(const Motion& m, double f, double G, double x) {
  return f * m.v[1] + G * m.w[0] + f * x * m.w[2];
}
double source(const Motion& m, double stiffness, double x, double y) {
  return -stiffness * (m.v[2] + y * m.w[0] - x * m.w[1]);
}

// Per taxel of the patch, N.
std::vector<double> taxelRates(const Field& field, const Motion& m) {
  const int num_rows = field.rows / field.s, num_cols = field.cols / field.s;
  std::vector<double> rates(static_cast<std::size_t>(num_rows * num_cols), 0);
  const auto rate = [&](int i, int j) -> double& { return rates[static_cast<std::size_t>(i * num_cols + j)]; };
  for (int i = 0; i <= num_rows; ++i) {
    for (int v = 0; v < field.cols; ++v) {
      const int u = i * field.s;
      const double flow = field.hy * flowX(m, field.beforeRow(field.f, u, v), field.beforeRow(field.G, u, v), field.y(v));
      if (i > 0) rate(i - 1, v / field.s) -= flow;
      if (i < num_rows) rate(i, v / field.s) += flow;
    }
  }
  for (int j = 0; j <= num_cols; ++j) {
    for (int u = 0; u < field.rows; ++u) {
      const int v = j * field.s;
      const double flow = field.hx * flowY(m, field.beforeColumn(field.f, u, v), field.beforeColumn(field.G, u, v), field.x(u));
      if (j > 0) rate(u / field.s, j - 1) -= flow;
      if (j < num_cols) rate(u / field.s, j) += flow;
    }
  }
  for (int u = 0; u < field.rows; ++u) {
    for (int v = 0; v < field.cols; ++v) {
      rate(u / field.s, v / field.s) += field.hx * field.hy * source(m, field.at(field.stiffness, u, v), field.x(u), field.y(v));
    }
  }
  return rates;
}

// Of the integrals of the pressure times 1, x and y over the patch; what flows inside moves the moments, what flows through the rim is
// gone.
Vector3 momentRates(const Field& field, const Motion& m) {
  Vector3 rates{0, 0, 0};
  const auto lose = [&](double flow, double x, double y) { rates = subtract(rates, scale(flow, {1, x, y})); };
  for (int u = 0; u < field.rows; ++u) {
    for (int v = 0; v < field.cols; ++v) {
      const double area = field.hx * field.hy, x = field.x(u), y = field.y(v);
      const double f = field.at(field.f, u, v), G = field.at(field.G, u, v);
      rates = add(rates, scale(area * source(m, field.at(field.stiffness, u, v), x, y), {1, x, y}));
      rates = add(rates, {0, area * flowX(m, f, G, y), area * flowY(m, f, G, x)});
    }
  }
  for (const int u : {0, field.rows}) {
    for (int v = 0; v < field.cols; ++v) {
      const double x = field.x(u - 0.5), y = field.y(v), out = u == 0 ? -1 : 1;
      lose(out * field.hy * flowX(m, field.beforeRow(field.f, u, v), field.beforeRow(field.G, u, v), y), x, y);
    }
  }
  for (const int v : {0, field.cols}) {
    for (int u = 0; u < field.rows; ++u) {
      const double x = field.x(u), y = field.y(v - 0.5), out = v == 0 ? -1 : 1;
      lose(out * field.hx * flowY(m, field.beforeColumn(field.f, u, v), field.beforeColumn(field.G, u, v), x), x, y);
    }
  }
  return rates;
}

// An elastic layer's nodes.
class LayerField {
 public:
  LayerField(const Sensor& sensor, const LayerContact& contact)
      : layer_(makeLayer(sensor)), contact_(contact), samples_(layerSamples(sensor, layer_.nodes)), thickness_(sensor.skin.thickness) {}

  // Of the pressures, Pa, as an object moves.
  std::vector<double> pressureRates(const Motion& m) const {
    std::vector<double> rates(samples_.size(), 0);
    for (int u = 0; u < layer_.nodes.num_rows; ++u) {
      for (int v = 0; v < layer_.nodes.num_cols; ++v) {
        const std::size_t n = index(u, v);
        const double d = contact_.overlap[n];
        if (contact_.solution.pressure[n] <= 0 || d >= thickness_) continue;
        const Vector3& p = samples_[n].position_P;
        const Vector3 velocity = add(m.v, cross(m.w, {p[0], p[1], -d}));
        rates[n] = -velocity[2] - velocity[0] * slope(u, v, 1, 0) - velocity[1] * slope(u, v, 0, 1);
      }
    }
    return reference::pressureRates(layer_, contact_, rates);
  }

  const std::vector<Sample>& samples() const { return samples_; }

 private:
  static constexpr double kSteepest = 2;  // what is steeper is a wall

  std::size_t index(int u, int v) const { return static_cast<std::size_t>(u * layer_.nodes.num_cols + v); }
  double depthAt(int u, int v) const {
    const bool inside = u >= 0 && v >= 0 && u < layer_.nodes.num_rows && v < layer_.nodes.num_cols;
    return inside ? contact_.overlap[index(u, v)] : -std::numeric_limits<double>::infinity();
  }
  // Of d along x or y: the mean of what both neighbours tell.
  double slope(int u, int v, int du, int dv) const {
    const double spacing = layer_.nodes.spacing[du == 1 ? 0 : 1];
    double sum = 0, count = 0;
    for (const int side : {-1, 1}) {
      const double one = side * (depthAt(u + side * du, v + side * dv) - depthAt(u, v)) / spacing;
      if (std::abs(one) >= kSteepest) continue;
      sum += one;
      ++count;
    }
    return count > 0 ? sum / count : 0;
  }

  Layer layer_;
  const LayerContact& contact_;
  std::vector<Sample> samples_;
  double thickness_;
};

// Forces of the taxels, N, and the integrals of the pressure times 1, x and y, margin included.
struct LayerRates {
  std::vector<double> taxel_force;
  Vector3 moments{0, 0, 0};
};
LayerRates layerRates(const LayerField& field, const Motion& m, std::size_t num_taxels) {
  LayerRates rates{std::vector<double>(num_taxels, 0), {0, 0, 0}};
  const std::vector<double> pressures = field.pressureRates(m);
  for (std::size_t n = 0; n < pressures.size(); ++n) {
    const Sample& sample = field.samples()[n];
    const double force = pressures[n] * sample.area;
    rates.moments = add(rates.moments, scale(force, {1, sample.position_P[0], sample.position_P[1]}));
    if (sample.taxel != kNoTaxel) rates.taxel_force[static_cast<std::size_t>(sample.taxel)] += force;
  }
  return rates;
}

// What the objects do, seen from P, where the sensor moves by coordinate k of its twist.
Motion seenFromPatch(const Pose& X_SP, std::size_t k) {
  Vector3 v{0, 0, 0}, w{0, 0, 0};
  (k < 3 ? v : w)[k % 3] = -1;
  const Quaternion R_PS = inverse(X_SP).rotation;
  return {rotate(R_PS, add(v, cross(w, X_SP.position))), rotate(R_PS, w)};
}

// What the law's taxels make of a change of the forces of contact, at rest: only the mask's are not these forces themselves.
std::vector<double> responseRates(const Sensor& sensor, std::span<const double> pressed, const std::vector<double>& rates) {
  if (!std::holds_alternative<DeformationMask>(sensor.skin.law)) return rates;
  // It is straight on both sides of saturation but for its scale, so that the error is of the step's square.
  constexpr double kStep = 1e-5;
  double largest = 0, fastest = 0;
  for (std::size_t t = 0; t < rates.size(); ++t) {
    largest = std::max(largest, pressed[t]);
    fastest = std::max(fastest, std::abs(rates[t]));
  }
  if (largest <= 0 || fastest <= 0) return std::vector<double>(rates.size(), 0);
  const double step = kStep * largest / fastest;
  const auto responseAt = [&](double by) {
    std::vector<double> moved(pressed.begin(), pressed.end());
    for (std::size_t t = 0; t < moved.size(); ++t) moved[t] += by * rates[t];
    std::vector<TaxelState> none;
    return taxelResponse(sensor, moved, 0, none);
  };
  std::vector<double> low = responseAt(-step), high = responseAt(step);
  for (std::size_t t = 0; t < high.size(); ++t) high[t] = (high[t] - low[t]) / (2 * step);
  return high;
}

// A row's image: forces, and how much each changes with the spread force.
struct Image {
  std::vector<double> force, weight;
};

Image cleanImage(const Frame& frame) {
  return {frame.spread_force, std::vector<double>(frame.spread_force.size(), 1)};
}

Image measuredImage(const Sensor& sensor, const Frame& frame, const ReadoutDraw& draw) {
  const Readout& readout = sensor.readout;
  const double most = nominalForce(readout, readout.saturation);
  Image image;
  for (std::size_t t = 0; t < frame.spread_force.size(); ++t) {
    const double gain = gainOf(readout, t) * (draw.gain.empty() ? 1 : draw.gain[t]);
    const double trigger = triggerOf(readout, t), x = gain * frame.spread_force[t] - trigger;
    const bool is_dead = !draw.dead.empty() && draw.dead[t];
    // Without a trigger the first force counts, too, which a contact is about to bring over a side.
    const bool follows = !is_dead && (x > 0 || trigger == 0) && x + readout.trigger < most;
    image.force.push_back(!is_dead && x > 0 ? std::min(x + readout.trigger, most) : 0);
    image.weight.push_back(follows ? gain : 0);
  }
  return image;
}

// Taxels of a row, with their places in its plane C.
struct Row {
  Pose X_SC;
  std::vector<std::size_t> taxels;
  std::vector<Vector3> places;  // m, in C
};

FeatureJacobian featuresOf(const Row& row, const Image& image, const std::vector<ByTwist>& by_twist) {
  FeatureJacobian result;
  double force = 0;
  Vector3 center{0, 0, 0};
  for (std::size_t n = 0; n < row.taxels.size(); ++n) {
    force += image.force[row.taxels[n]];
    center = add(center, scale(image.force[row.taxels[n]], row.places[n]));
  }
  result.total_force = force;
  if (force <= 1e-20) return result;
  center = scale(1 / force, center);
  result.center = row.X_SC * center;
  double xx = 0, xy = 0, yy = 0;
  for (std::size_t n = 0; n < row.taxels.size(); ++n) {
    const Vector3 p = subtract(row.places[n], center);
    const double share = image.force[row.taxels[n]] / force;
    xx += share * p[0] * p[0], xy += share * p[0] * p[1], yy += share * p[1] * p[1];
  }
  Features axes;
  setAxes({xx, xy, yy}, axes);
  result.edge_confidence = axes.edge_confidence;
  result.trace = xx + yy;
  for (std::size_t k = 0; k < 6; ++k) {
    double of_force = 0, of_xx = 0, of_xy = 0, of_yy = 0;
    Vector3 of_first{0, 0, 0};
    for (std::size_t n = 0; n < row.taxels.size(); ++n) {
      const std::size_t t = row.taxels[n];
      const double rate = image.weight[t] * by_twist[t][k];
      const Vector3 p = subtract(row.places[n], center);
      of_force += rate;
      of_first = add(of_first, scale(rate, p));
      of_xx += rate * p[0] * p[0], of_xy += rate * p[0] * p[1], of_yy += rate * p[1] * p[1];
    }
    result.total_force_by_twist[k] = of_force;
    const Vector3 of_center_S = rotate(row.X_SC.rotation, scale(1 / force, of_first));
    for (std::size_t axis = 0; axis < 3; ++axis) result.center_of_pressure[axis][k] = of_center_S[axis];
    // d alpha = d(1/2 atan2(2 xy, xx - yy)).
    const double difference = xx - yy, square = difference * difference + 4 * xy * xy;
    const double of_difference = (of_xx - of_yy - difference * of_force) / force, of_cross = (of_xy - xy * of_force) / force;
    if (axes.eigenvalues[0] - axes.eigenvalues[1] > 1e-12) {
      result.edge_angle[k] = (difference * of_cross - xy * of_difference) / square;
    }
  }
  return result;
}

}  // namespace

TactileJacobian tactileJacobian(const Sensor& sensor, const Frame& frame, const ReadoutDraw& draw) {
  TactileJacobian result;
  const std::size_t num_taxels = frame.contact.taxel_force.size();
  result.taxel_force.resize(num_taxels);
  result.spread_force.resize(num_taxels);
  std::array<std::vector<double>, 6> rates;
  const auto addWrench = [&](const Pose& X_SP, const Vector3& moments, std::size_t k) {
    const Vector3 force_S = rotate(X_SP.rotation, {0, 0, -moments[0]});
    const Vector3 torque_S = add(rotate(X_SP.rotation, {-moments[2], moments[1], 0}), cross(X_SP.position, force_S));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      result.contact_wrench[axis][k] += force_S[axis];
      result.contact_wrench[axis + 3][k] += torque_S[axis];
    }
  };
  const bool is_layer = std::holds_alternative<ElasticLayer>(sensor.skin.law);
  if (is_layer) {
    const LayerField field(sensor, frame.layer);
    const Pose& X_SP = sensor.patches.front().X_SP;
    for (std::size_t k = 0; k < 6; ++k) {
      const LayerRates of_layer = layerRates(field, seenFromPatch(X_SP, k), num_taxels);
      rates[k] = of_layer.taxel_force;
      addWrench(X_SP, of_layer.moments, k);
    }
  }
  std::size_t first_sample = 0;
  for (const GridPatch& patch : sensor.patches) {
    if (is_layer) break;
    const Field field(sensor, patch, first_sample, frame);
    first_sample += static_cast<std::size_t>(field.rows) * static_cast<std::size_t>(field.cols);
    for (std::size_t k = 0; k < 6; ++k) {
      const Motion motion = seenFromPatch(patch.X_SP, k);
      const std::vector<double> of_patch = taxelRates(field, motion);
      rates[k].insert(rates[k].end(), of_patch.begin(), of_patch.end());
      if (std::holds_alternative<Proximity>(sensor.skin.law)) continue;  // nothing presses
      addWrench(patch.X_SP, momentRates(field, motion), k);
    }
  }
  for (std::size_t k = 0; k < 6; ++k) {
    const std::vector<double> spread_rates = spread(sensor, responseRates(sensor, frame.contact.taxel_force, rates[k]));
    for (std::size_t t = 0; t < num_taxels; ++t) {
      result.taxel_force[t][k] = rates[k][t];
      result.spread_force[t][k] = spread_rates[t];
    }
  }

  const Image clean = cleanImage(frame), measured = measuredImage(sensor, frame, draw);
  const auto addRow = [&](const Row& row, FeatureJacobian& of_clean, FeatureJacobian& of_measured) {
    of_clean = featuresOf(row, clean, result.spread_force);
    of_measured = featuresOf(row, measured, result.spread_force);
  };
  const std::vector<Vector3> positions = taxelPositions(sensor);
  Row all{sensor.patches.size() == 1 ? sensor.patches.front().X_SP : Pose{}, {}, {}};
  for (std::size_t t = 0; t < num_taxels; ++t) {
    all.taxels.push_back(t);
    all.places.push_back(inverse(all.X_SC) * positions[t]);
  }
  addRow(all, result.clean, result.measured);
  std::size_t first = 0;
  for (int p = 0; p < numFeaturePatches(sensor); ++p) {
    const GridPatch& patch = sensor.patches[static_cast<std::size_t>(p)];
    Row row{patch.X_SP, {}, {}};
    for (int n = 0; n < patch.num_rows * patch.num_cols; ++n, ++first) {
      row.taxels.push_back(first);
      row.places.push_back(inverse(patch.X_SP) * positions[first]);
    }
    addRow(row, result.clean_patches.emplace_back(), result.measured_patches.emplace_back());
  }
  return result;
}

}  // namespace taxelsim::reference
