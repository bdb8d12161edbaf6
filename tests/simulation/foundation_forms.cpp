#include "simulation/foundation_forms.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "sensor/pasternak.h"
#include "simulation/comparison.h"
#include "simulation/foundation_law.h"
#include "support/random_scene.h"
#include "taxelsim/stiffness.h"

namespace taxelsim {
namespace {

constexpr double kDt = 1e-3;  // s
constexpr Pasternak kLaw{.normal_contact_stiffness = kStiffness, .shear_stiffness = kStiffness * kDecay * kDecay};

}  // namespace

Form pin(double radius, double error) {
  constexpr double kLength = 0.01, kDepth = 1e-3;
  return {Cylinder{radius, kLength}, kLength / 2, kDepth, kDepth * pasternakPunchStiffness(kLaw, radius), error};
}

Form sphere(double a, double error) {
  constexpr double kRadius = 5e-3;
  const double edge = std::sqrt(kRadius * kRadius - a * a), slope = a / edge;
  const double depth = kRadius - edge + slope * kDecay / besselRatio(a / kDecay);
  const double volume =
      std::numbers::pi * a * a * (depth - kRadius) + 2 * std::numbers::pi / 3 * (std::pow(kRadius, 3) - std::pow(edge, 3));
  return {Sphere{kRadius}, kRadius, depth, kStiffness * volume + 2 * std::numbers::pi * kLaw.shear_stiffness * a * slope, error};
}

std::vector<double> worstErrors(const Sensor& sensor, const std::vector<Form>& forms) {
  constexpr int kPlaces = 50;
  std::vector<Object> objects;
  std::vector<support::Touch> touches;
  support::Random random(3);
  for (const Form& form : forms) {
    const int id = static_cast<int>(objects.size());
    objects.push_back(form.object);
    for (int n = 0; n < kPlaces; ++n) {
      touches.push_back({{id}, {{{random.uniform(-2e-3, 2e-3), random.uniform(-2e-3, 2e-3), form.tip - form.depth}, {1, 0, 0, 0}}}});
    }
  }
  const Model model(support::sharedDevice(), {.sensor = sensor, .objects = objects});
  Simulator simulator(model, {.num_instances = static_cast<int>(touches.size())});
  support::setTouches(simulator, touches);
  simulator.step(kDt);
  const FrameView frame = simulator.read();
  std::vector<double> worst(forms.size(), 0);
  for (std::size_t i = 0; i < touches.size(); ++i) {
    double& error = worst[i / kPlaces];
    error = std::max(error, std::abs(frame.ground_truth.total_force[i] / forms[i / kPlaces].force - 1));
  }
  return worst;
}

void expectForms(const Sensor& sensor, const std::vector<Form>& forms) {
  const std::vector<double> worst = worstErrors(sensor, forms);
  for (std::size_t k = 0; k < forms.size(); ++k) {
    EXPECT_LT(worst[k], forms[k].error) << "form " << k;
    ::testing::Test::RecordProperty("form_" + std::to_string(k), std::to_string(worst[k]));
  }
}

}  // namespace taxelsim
