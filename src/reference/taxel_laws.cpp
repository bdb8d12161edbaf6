#include "reference/taxel_laws.h"

#include <algorithm>
#include <cmath>

#include "base/vector3.h"

namespace taxelsim::reference {
namespace {

using Matrix = std::array<double, 4>;  // 2 x 2, row-major

Matrix product(const Matrix& a, const Matrix& b) {
  return {a[0] * b[0] + a[1] * b[2], a[0] * b[1] + a[1] * b[3], a[2] * b[0] + a[3] * b[2], a[2] * b[1] + a[3] * b[3]};
}

// exp(A t) by scaling and squaring: Taylor series of A t / 2^n, squared n times.
Matrix exponential(const Matrix& A, double t) {
  int halvings = 0;
  double scale = t;
  while ((std::abs(A[0]) + std::abs(A[1]) + std::abs(A[2]) + std::abs(A[3])) * scale > 0.25) {
    scale /= 2;
    ++halvings;
  }
  Matrix sum{1, 0, 0, 1};
  Matrix term = sum;
  for (int n = 1; n <= 20; ++n) {
    term = product(term, {A[0] * scale / n, A[1] * scale / n, A[2] * scale / n, A[3] * scale / n});
    for (std::size_t k = 0; k < 4; ++k) sum[k] += term[k];
  }
  for (int n = 0; n < halvings; ++n) sum = product(sum, sum);
  return sum;
}

// Mask function of TactileArraySensor in RobWorkSim; `r`: 4/3 of the distance in taxel pitches.
double maskFunction(double r) {
  return std::max(0.0, -0.34766355 + 1.22429907 / (1 + r * r));
}

// Integral of the mask around the middle of one taxel of a list over the rectangle of another, by the midpoint rule, over the square of
// their mean size. The size is the square root of the area; distances run along the skin.
double maskIntegral(const GridPatch& source, const GridPatch& target) {
  const Vector3 n = rotate(source.X_SP.rotation, {0, 0, 1}), m = rotate(target.X_SP.rotation, {0, 0, 1});
  if (dot(n, m) <= 0) return 0;
  const double size = (std::sqrt(source.pitch[0] * source.pitch[1]) + std::sqrt(target.pitch[0] * target.pitch[1])) / 2;
  constexpr double kReach = 1.2;  // the mask ends at 1.191 taxels
  if (length(subtract(source.X_SP.position, target.X_SP.position)) > kReach * size + std::hypot(target.pitch[0], target.pitch[1])) return 0;
  constexpr int kCells = 40;
  double sum = 0;
  for (int i = 0; i < kCells; ++i) {
    for (int j = 0; j < kCells; ++j) {
      const Vector3 point_P{((i + 0.5) / kCells - 0.5) * target.pitch[0], ((j + 0.5) / kCells - 0.5) * target.pitch[1], 0};
      sum += maskFunction(4.0 / 3 * skinDistance(source.X_SP.position, n, target.X_SP * point_P, m) / size);
    }
  }
  return sum * target.pitch[0] * target.pitch[1] / (kCells * kCells * size * size);
}

// Readings of the taxels, one overload per law.
struct Respond {
  const Sensor& sensor;
  std::span<const double> pressed;
  double dt;
  std::vector<TaxelState>& state;

  std::vector<double> operator()(const Winkler&) const { return {pressed.begin(), pressed.end()}; }
  std::vector<double> operator()(const Proximity&) const { return {pressed.begin(), pressed.end()}; }
  std::vector<double> operator()(const ElasticLayer&) const { return {pressed.begin(), pressed.end()}; }
  std::vector<double> operator()(const LuGre&) const { return {pressed.begin(), pressed.end()}; }

  // m x" + c x' + k x = F in terms of the spring force k x. Time is scaled by the undamped natural frequency, so that the entries of A are
  // of order one.
  std::vector<double> operator()(const MassSpringDamper& law) const {
    const double rate = std::sqrt(law.stiffness / law.mass);
    const double damping = law.damping / (law.mass * rate);
    std::vector<double> response;
    if (state.empty()) {
      for (const double force : pressed) state.push_back({force, 0});
    } else {
      const Matrix step = exponential({0, 1, -1, -damping}, rate * dt);
      for (std::size_t t = 0; t < state.size(); ++t) {
        const double deviation = state[t][0] - pressed[t];
        const double scaled_rate = state[t][1] / rate;
        state[t] = {pressed[t] + step[0] * deviation + step[1] * scaled_rate, rate * (step[2] * deviation + step[3] * scaled_rate)};
      }
    }
    for (const TaxelState& taxel : state) response.push_back(std::max(taxel[0], 0.0));
    return response;
  }

  std::vector<double> operator()(const DeformationMask& law) const {
    const std::array<double, 3> weights = maskWeights();
    if (isTaxelList(sensor)) return rescaled(saturated(spreadOverList(), law));
    std::vector<double> response(pressed.size(), 0);
    std::size_t first = 0;
    for (const GridPatch& patch : sensor.patches) {
      const auto inside = [&](int i, int j) { return i >= 0 && i < patch.num_rows && j >= 0 && j < patch.num_cols; };
      const auto indexOf = [&](int i, int j) { return first + static_cast<std::size_t>(i) * patch.num_cols + j; };
      const auto weight = [&](int a, int b) { return weights[static_cast<std::size_t>(std::abs(a) + std::abs(b))]; };
      for (int i = 0; i < patch.num_rows; ++i) {
        for (int j = 0; j < patch.num_cols; ++j) {
          double total = 0;
          for (int a = -1; a <= 1; ++a) {
            for (int b = -1; b <= 1; ++b) total += inside(i + a, j + b) ? weight(a, b) : 0;
          }
          for (int a = -1; a <= 1; ++a) {
            for (int b = -1; b <= 1; ++b) {
              if (inside(i + a, j + b)) response[indexOf(i + a, j + b)] += pressed[indexOf(i, j)] * weight(a, b) / total;
            }
          }
        }
      }
      first += static_cast<std::size_t>(patch.num_rows) * patch.num_cols;
    }
    return rescaled(saturated(std::move(response), law));
  }

 private:
  // The mask over a list: a share of every force for every taxel, from all pairs.
  std::vector<double> spreadOverList() const {
    std::vector<double> response(pressed.size(), 0);
    for (std::size_t source = 0; source < pressed.size(); ++source) {
      std::vector<double> share;
      double total = 0;
      for (const GridPatch& target : sensor.patches) {
        share.push_back(maskIntegral(sensor.patches[source], target));
        total += share.back();
      }
      for (std::size_t t = 0; t < share.size(); ++t) response[t] += pressed[source] * share[t] / total;
    }
    return response;
  }

  std::vector<double> saturated(std::vector<double> response, const DeformationMask& law) const {
    std::size_t t = 0;
    for (const GridPatch& patch : sensor.patches) {
      for (int n = 0; n < patch.num_rows * patch.num_cols; ++n, ++t) {
        response[t] = std::min(response[t], law.saturation_pressure * patch.pitch[0] * patch.pitch[1]);
      }
    }
    return response;
  }

  std::vector<double> rescaled(std::vector<double> response) const {
    double pressed_sum = 0;
    double response_sum = 0;
    for (const double force : pressed) pressed_sum += force;
    for (const double force : response) response_sum += force;
    for (double& force : response) force *= response_sum > 0 ? pressed_sum / response_sum : 0;
    return response;
  }
};

}  // namespace

std::vector<double> taxelResponse(const Sensor& sensor, std::span<const double> pressed, double dt, std::vector<TaxelState>& state) {
  return std::visit(Respond{sensor, pressed, dt, state}, sensor.skin.law);
}

std::vector<Shear> taxelShear(const Sensor& sensor, std::span<const Shear> shear, std::span<const double> response) {
  std::vector<Shear> shear_reading(shear.begin(), shear.end());
  if (!std::holds_alternative<MassSpringDamper>(sensor.skin.law)) return shear_reading;
  for (std::size_t t = 0; t < shear_reading.size(); ++t) {
    const double size = std::hypot(shear_reading[t][0], shear_reading[t][1]);
    const double cap = sensor.skin.friction.friction_coefficient * response[t];
    if (size > cap) shear_reading[t] = {shear_reading[t][0] * cap / size, shear_reading[t][1] * cap / size};
  }
  return shear_reading;
}

std::array<double, 3> maskWeights() {
  constexpr int kCells = 400;
  std::array<double, 3> weights{};
  for (int a = 0; a <= 1; ++a) {
    for (int b = 0; b <= 1; ++b) {
      double sum = 0;
      for (int i = 0; i < kCells; ++i) {
        for (int j = 0; j < kCells; ++j) {
          const double x = a + (i + 0.5) / kCells - 0.5;
          const double y = b + (j + 0.5) / kCells - 0.5;
          sum += maskFunction(4.0 / 3 * std::hypot(x, y));
        }
      }
      weights[static_cast<std::size_t>(a + b)] = sum;
    }
  }
  const double total = weights[0] + 4 * weights[1] + 4 * weights[2];
  for (double& weight : weights) weight /= total;
  return weights;
}

}  // namespace taxelsim::reference
