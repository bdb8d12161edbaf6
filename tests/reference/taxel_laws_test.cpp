// Laws with a response of the whole taxel, against closed forms and published numbers.
#include "reference/taxel_laws.h"

#include <complex>

#include "reference/frame.h"
#include "support/random_scene.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using reference::taxelResponse;
using reference::TaxelState;

// Scaling and squaring of a Taylor series in double, with a generous margin.
constexpr double kExact = 1e-10;

Sensor oneTaxel(const ContactLaw& law) {
  Sensor sensor = support::gridSensor({.num_rows = 1, .num_cols = 1});
  sensor.skin.law = law;
  return sensor;
}

// Spring force of a taxel after each of num_steps steps of dt (s) under a step of `force` (N).
std::vector<double> stepResponse(const MassSpringDamper& law, double force, double dt, int num_steps) {
  const Sensor sensor = oneTaxel(law);
  std::vector<TaxelState> state{{0, 0}};
  std::vector<double> response;
  for (int n = 0; n < num_steps; ++n) {
    taxelResponse(sensor, std::vector{force}, dt, state);
    response.push_back(state[0][0]);
  }
  return response;
}

TEST(MassSpringDamperTwin, UnderdampedStepResponseMatchesClosedForm) {
  for (const double damping : {0.0, 0.02, 0.130, 0.25}) {
    const MassSpringDamper law{.normal_contact_stiffness = 1, .damping = damping};
    const double wn = std::sqrt(law.stiffness / law.mass), zeta = damping / (2 * law.mass * wn), wd = wn * std::sqrt(1 - zeta * zeta);
    const double dt = 1e-3;
    const std::vector<double> response = stepResponse(law, 2, dt, 200);
    for (std::size_t n = 0; n < response.size(); ++n) {
      const double t = dt * static_cast<double>(n + 1);
      EXPECT_NEAR(response[n], 2 * (1 - std::exp(-zeta * wn * t) * (std::cos(wd * t) + zeta * wn / wd * std::sin(wd * t))), kExact);
    }
  }
}

TEST(MassSpringDamperTwin, OverdampedStepResponseMatchesClosedForm) {
  const MassSpringDamper law{.normal_contact_stiffness = 1, .damping = 1};
  const double a = law.damping / (2 * law.mass), root = std::sqrt(a * a - law.stiffness / law.mass), fast = a + root, slow = a - root;
  const std::vector<double> response = stepResponse(law, 1, 1e-3, 300);
  for (std::size_t n = 0; n < response.size(); ++n) {
    const double t = 1e-3 * static_cast<double>(n + 1);
    EXPECT_NEAR(response[n], 1 - (fast * std::exp(-slow * t) - slow * std::exp(-fast * t)) / (fast - slow), 1e-9);
  }
}

// Parameters of SkinSim: 20.4 Hz, damping ratio 0.508. Overshoot exp(-pi zeta / sqrt(1 - zeta^2)) = 15.7 %, settling time to 2 %: 62.4 ms.
TEST(MassSpringDamperTwin, SkinSimTaxelHasOvershootAndSettlingTime) {
  const double dt = 1e-4;
  const std::vector<double> response = stepResponse({.normal_contact_stiffness = 1}, 1, dt, 2000);
  EXPECT_NEAR(*std::max_element(response.begin(), response.end()), 1.157, 5e-4);
  std::size_t settled = response.size();
  while (std::abs(response[settled - 1] - 1) < 0.02) --settled;
  EXPECT_NEAR(static_cast<double>(settled) * dt, 62.4e-3, 1e-4);
}

// Sine input held over short steps: |H| = 1 / sqrt((1 - r^2)^2 + (2 zeta r)^2).
TEST(MassSpringDamperTwin, SineResponseMatchesTransferFunction) {
  const MassSpringDamper law{.normal_contact_stiffness = 1};
  const double wn = std::sqrt(law.stiffness / law.mass), zeta = law.damping / (2 * law.mass * wn);
  const Sensor sensor = oneTaxel(law);
  for (const double r : {0.2, 0.7, 1.0, 2.0}) {
    const double period = 2 * std::numbers::pi / (r * wn), dt = period / 2000;
    std::vector<TaxelState> state{{0, 0}};
    double largest = 0;
    const int num_steps = 2000 * 12;  // transients have decayed to e^-12 in the last two periods
    for (int n = 0; n < num_steps; ++n) {
      taxelResponse(sensor, std::vector{std::sin(r * wn * (n + 0.5) * dt)}, dt, state);
      if (n > num_steps - 4000) largest = std::max(largest, std::abs(state[0][0]));
    }
    EXPECT_NEAR(largest, 1 / std::hypot(1 - r * r, 2 * zeta * r), 1e-4) << r;
  }
}

TEST(MassSpringDamperTwin, StartsInEquilibriumWithTheFirstForce) {
  const Sensor sensor = oneTaxel(MassSpringDamper{.normal_contact_stiffness = 1});
  std::vector<TaxelState> state;
  for (int n = 0; n < 5; ++n) EXPECT_EQ(taxelResponse(sensor, std::vector{0.7}, 0.01, state)[0], 0.7);
}

// The shear reading is clamped to the friction cone of the spring force.
TEST(MassSpringDamperTwin, ShearStaysInTheConeOfTheSpringForce) {
  Sensor sensor = oneTaxel(MassSpringDamper{.normal_contact_stiffness = 1});
  sensor.skin.friction = {1e8, 0.5};
  const auto shear = [&](double force) {
    return reference::taxelShear(sensor, std::vector{reference::Shear{0.3, -0.4}}, std::vector{force})[0];
  };
  EXPECT_EQ(shear(1), (reference::Shear{0.3, -0.4}));
  EXPECT_EQ(shear(7), (reference::Shear{0.3, -0.4}));
  EXPECT_NEAR(shear(0.2)[0], 0.06, kExact);
  EXPECT_NEAR(shear(0.2)[1], -0.08, kExact);
  EXPECT_EQ(shear(0), (reference::Shear{0, 0}));
}

// The PSF spreads the lagging readings; the wrench is that of the contact. In equilibrium both equal those of law `winkler`.
TEST(MassSpringDamperTwin, FrameSpreadsTheLaggingShear) {
  Sensor sensor = support::gridSensor();
  sensor.skin.friction = {1e8, 0.6};
  sensor.psf = gaussianPsf(0.5, 3);
  Sensor lagging = sensor;
  lagging.skin.law = MassSpringDamper{.normal_contact_stiffness = 1.73e8};
  const Object ball(Sphere{0.01});
  reference::Frame undelayed, lagged;
  double smallest_ratio = 1;
  for (int n = 0; n < 40; ++n) {
    const Pose X_SO{.position = {n < 2 ? 0.0 : 0.2e-3, 0, n == 0 ? 0.03 : 0.0092}};
    const double dt = n < 5 ? 2e-3 : 0.05;
    const auto next = [&](const Sensor& tested, const reference::Frame& before) {
      return reference::simulateFrame(
          tested, {.objects = {{&ball, X_SO}}, .taxel_state = before.taxel_state, .previous_friction = before.shear.state, .dt = dt});
    };
    undelayed = next(sensor, undelayed);
    lagged = next(lagging, lagged);
    EXPECT_EQ(lagged.wrench, undelayed.wrench);
    double shear = 0, undelayed_shear = 0;
    for (std::size_t t = 0; t < lagged.spread_force.size(); ++t) {
      EXPECT_LE(std::hypot(lagged.spread_shear[t][0], lagged.spread_shear[t][1]), 0.6 * lagged.spread_force[t] + kExact);
      shear += lagged.spread_shear[t][0];
      undelayed_shear += undelayed.spread_shear[t][0];
    }
    if (undelayed_shear > 0) smallest_ratio = std::min(smallest_ratio, shear / undelayed_shear);
    if (n == 39) {
      EXPECT_NEAR(shear, undelayed_shear, 1e-9 + 1e-9 * undelayed_shear);
    }
  }
  EXPECT_LT(smallest_ratio, 0.5) << "the mass lags";
}

TEST(DeformationMaskTwin, WeightsMatchRobWorkSim) {
  const std::array<double, 3> weights = reference::maskWeights();
  EXPECT_NEAR(weights[0], 0.52464, 5e-6);
  EXPECT_NEAR(weights[1], 0.10387, 5e-6);
  EXPECT_NEAR(weights[2], 0.01497, 5e-6);
  EXPECT_NEAR(weights[0] + 4 * weights[1] + 4 * weights[2], 1, kExact);
  // The mask is zero from 1.19095 taxels on, so the 3 x 3 neighbourhood contains it.
  EXPECT_NEAR(-0.34766355 + 1.22429907 / (1 + std::pow(4.0 / 3 * 1.19095, 2)), 0, 1e-5);
}

TEST(DeformationMaskTwin, ConservesForceAndSaturatesTaxels) {
  Sensor sensor = support::gridSensor({.num_rows = 3, .num_cols = 4});
  const double area = sensor.patches[0].pitch[0] * sensor.patches[0].pitch[1];
  sensor.skin.law = DeformationMask{};
  for (const int source : {0, 1, 5}) {  // corner, border, middle
    for (const double force : {0.5, 20.0}) {
      std::vector<double> pressed(12, 0);
      pressed[static_cast<std::size_t>(source)] = force;
      std::vector<TaxelState> state;
      const std::vector<double> response = taxelResponse(sensor, pressed, 0, state);
      double sum = 0;
      for (const double f : response) sum += f;
      EXPECT_NEAR(sum, force, kExact * force);
      const double cell = 250e3 * area;  // 2.89 N
      const double unclipped = response[static_cast<std::size_t>(source)] / force;
      if (force * 0.52464 < cell)
        EXPECT_GT(unclipped, 0.52) << source;
      else
        EXPECT_LT(unclipped, 0.52) << source;
    }
  }
}

}  // namespace
}  // namespace taxelsim
