#include "support/relaxation_cases.h"

#include "support/random_scene.h"
#include "support/test.h"

namespace taxelsim::support {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kStiffness = 1.73e8;  // k0, N/m^3
constexpr double kSide = 12e-3;        // m, of the array
constexpr double kArea = kSide * kSide;
// Tolerance where the path within a step, or the grid under a sphere, is not exact.
constexpr double kClose = 0.005;
constexpr double kCarried = 0.001;  // of a load

Sensor skinOf(std::vector<RelaxationTerm> terms, double exponent = 1, int taxels = 2) {
  Sensor sensor = gridSensor({.num_rows = taxels,
                              .num_cols = taxels,
                              .pitch_x = kSide / taxels,
                              .pitch_y = kSide / taxels,
                              .samples_per_taxel = 4,
                              .thickness = 2e-3,
                              .law = {kStiffness / std::pow(1e-3, exponent - 1), exponent, 0}});
  sensor.skin.relaxation = std::move(terms);
  return sensor;
}

// Fine enough for a sphere.
Sensor fineSkinOf(std::vector<RelaxationTerm> terms) {
  return skinOf(std::move(terms), 1, 12);
}

// k(t) / k0, and its integral from 0 to t.
double kernel(const Sensor& sensor, double t) {
  double g = 1;
  for (const auto& [fraction, time] : sensor.skin.relaxation) g -= fraction * -std::expm1(-t / time);
  return g;
}
double integralOfKernel(const Sensor& sensor, double t) {
  double settled = 1, sum = 0;
  for (const auto& [fraction, time] : sensor.skin.relaxation) {
    settled -= fraction;
    sum += fraction * time * -std::expm1(-t / time);
  }
  return settled * t + sum;
}

// Creep compliance times k0 of a skin with one term: 1/Einf - E1 / (Einf (Einf + E1)) e^(-t / tc), tc = time (Einf + E1) / Einf, Einf + E1
// = 1.
double compliance(const RelaxationTerm& term, double t) {
  const double settled = 1 - term.fraction;
  return 1 / settled - term.fraction / settled * std::exp(-t * settled / term.time);
}

// A half-space over the whole array, `depth` deep (m).
const Object& flat() {
  static const Object object(HalfSpace{});
  return object;
}
Press flatAt(double depth, double dt) {
  return {{.position = {0, 0, -depth}}, dt};
}

double capOf(double radius, double depth) {
  return depth > 0 ? kPi * depth * depth * (radius - depth / 3) : 0;
}

const std::vector<RelaxationTerm> kTerms{{0.3, 0.05}, {0.2, 1}, {0.1, 11}, {0.05, 0.002}};

}  // namespace

void RelaxationCases::stepOfDepth() const {
  constexpr double kDepth = 0.8e-3;
  for (const double exponent : {1.0, 1.5, 3.0}) {
    for (std::size_t num_terms = 0; num_terms <= kTerms.size(); ++num_terms) {
      const Sensor sensor = skinOf({kTerms.begin(), kTerms.begin() + static_cast<std::ptrdiff_t>(num_terms)}, exponent);
      std::vector<Press> steps;
      for (const double dt : {0.7, 1e-4, 1e-3, 0.02, 0.003, 0.4, 3.0, 30.0}) steps.push_back(flatAt(kDepth, dt));
      const std::vector<Pressed> pressed = simulate(sensor, flat(), steps);
      const double instantaneous = kStiffness * 1e-3 * std::pow(kDepth / 1e-3, exponent) * kArea;
      double t = 0;
      for (std::size_t n = 0; n < steps.size(); ++n) {
        if (n > 0) t += steps[n].dt;
        EXPECT_NEAR(pressed[n].force / (instantaneous * kernel(sensor, t)), 1, exponent * depth_error / kDepth + 1e-5) << n;
      }
    }
  }
}

// Times from 1e-6 to 1e6 of a step, and terms with nearly all of the stiffness.
void RelaxationCases::anyTimes() const {
  constexpr double kDepth = 0.8e-3;
  int number = 0;
  for (const double dt : {1e-9, 1e-3, 1e3}) {
    for (const double ratio : {1e-6, 1e-3, 1.0, 1e3, 1e6}) {
      for (const double left : {1e-6, 0.5}) {
        if (few && number++ % 3 != 0) continue;
        const Sensor sensor = skinOf({{1 - left, dt * ratio}, {left / 2, 3 * dt}});
        const std::vector<Pressed> pressed = simulate(sensor, flat(), std::vector<Press>(30, flatAt(kDepth, dt)));
        for (std::size_t n = 0; n < pressed.size(); ++n) {
          const double expected = kStiffness * kDepth * kArea * kernel(sensor, static_cast<double>(n) * dt);
          EXPECT_NEAR(pressed[n].force / expected, 1, depth_error / kDepth + kClose) << dt << " " << ratio << " " << left << " " << n;
        }
        // Then released.
        std::vector<Press> steps(3, flatAt(kDepth, dt));
        steps.resize(6, flatAt(-kDepth, dt));
        for (const Pressed& after : simulate(sensor, flat(), steps)) EXPECT_GE(after.smallest, 0);
      }
    }
  }
}

void RelaxationCases::ramp() const {
  constexpr double kRate = 1e-3;  // m/s
  const Sensor sensor = skinOf({kTerms.begin(), kTerms.begin() + 3});
  std::vector<Press> steps;
  double t = 0;
  for (const double dt : {0.0, 0.2, 0.01, 0.09, 0.3, 0.05, 0.6}) {
    t += dt;
    steps.push_back(flatAt(kRate * t, std::max(dt, 1e-3)));
  }
  const std::vector<Pressed> pressed = simulate(sensor, flat(), steps);
  t = 0;
  for (std::size_t n = 1; n < steps.size(); ++n) {
    t += steps[n].dt;
    EXPECT_NEAR(pressed[n].force / (kStiffness * kArea * kRate * integralOfKernel(sensor, t)), 1, 2 * depth_error / (kRate * t) + 1e-5)
        << n;
  }
}

void RelaxationCases::growingSphere() const {
  constexpr double kRadius = 10e-3, kDepth = 1e-3, kTime = 1;
  constexpr int kNumSteps = 60;
  const Sensor sensor = fineSkinOf({kTerms.begin(), kTerms.begin() + 3});
  // Fast, then slow: the contact always grows.
  const auto depthAt = [](double t) { return kDepth * std::sin(kPi / 2 * t / kTime); };
  std::vector<Press> steps;
  for (int n = 0; n <= kNumSteps; ++n) {
    steps.push_back({{.position = {0.11e-3, -0.07e-3, kRadius - depthAt(kTime * n / kNumSteps)}}, kTime / kNumSteps});
  }
  const std::vector<Pressed> pressed = simulate(sensor, Object(Sphere{kRadius}), steps);
  for (int n = kNumSteps / 4; n <= kNumSteps; ++n) {
    // The midpoint rule over the volume's own steps.
    constexpr int kCells = 4000;
    const double t = kTime * n / kNumSteps;
    double force = 0;
    for (int i = 0; i < kCells; ++i) {
      const double from = t * i / kCells, to = t * (i + 1) / kCells;
      force += kStiffness * kernel(sensor, t - (from + to) / 2) * (capOf(kRadius, depthAt(to)) - capOf(kRadius, depthAt(from)));
    }
    EXPECT_NEAR(pressed[static_cast<std::size_t>(n)].force / force, 1, kClose + 2 * depth_error / depthAt(t)) << n;
  }
}

void RelaxationCases::deadLoadOnAFlat() const {
  constexpr double kLoad = 4;  // N
  for (const RelaxationTerm term : {RelaxationTerm{0.4, 0.5}, RelaxationTerm{0.8, 0.02}}) {
    const Sensor sensor = skinOf({term});
    const std::vector<Pressed> pressed = simulate(sensor, flat(), std::vector<Press>(120, {{.position = {0, 0, 0.01}}, 0.01, kLoad}));
    for (std::size_t n = 0; n < pressed.size(); ++n) {
      const double depth = kLoad / (kStiffness * kArea) * compliance(term, 0.01 * static_cast<double>(n));
      EXPECT_TRUE(pressed[n].reached);
      EXPECT_NEAR(pressed[n].force / kLoad, 1, kCarried);
      EXPECT_NEAR(-0.01 - pressed[n].offset, depth, kClose * depth + 2 * depth_error);
    }
  }
}

void RelaxationCases::deadLoadOnASphere() const {
  constexpr double kRadius = 10e-3, kLoad = 1, kDt = 0.02;
  const RelaxationTerm term{0.5, 0.3};
  const Sensor sensor = fineSkinOf({term});
  const std::vector<Press> steps(60, {{.position = {0.11e-3, -0.07e-3, 0.03}}, kDt, kLoad});
  const std::vector<Pressed> pressed = simulate(sensor, Object(Sphere{kRadius}), steps);
  for (std::size_t n = 0; n < pressed.size(); ++n) {
    const double volume = kLoad / kStiffness * compliance(term, kDt * static_cast<double>(n));
    const double parabolic = std::sqrt(volume / (kPi * kRadius));
    double depth = parabolic;  // then the cap's own
    for (int i = 0; i < 20; ++i) depth = std::sqrt(volume / (kPi * (kRadius - depth / 3)));
    EXPECT_NEAR(pressed[n].force / kLoad, 1, kCarried);
    EXPECT_NEAR(kRadius - 0.03 - pressed[n].offset, depth, kClose * depth + 2 * depth_error) << n;
  }
}

// Held until settled, then released: the skin recovers instantly by the remaining stiffness, and the rest with the creep time.
void RelaxationCases::freeRecovery() const {
  constexpr double kDent = 1e-3, kShort = 1e-6;
  const RelaxationTerm term{0.6, 0.3};
  const double settled = 1 - term.fraction;
  const Sensor sensor = skinOf({term});
  for (const double wait : {0.01, 0.3, 1.0}) {
    std::vector<Press> steps{flatAt(kDent, 1), flatAt(kDent, 40 * term.time), flatAt(-1e-3, kShort)};
    constexpr int kNumWaits = 50;
    for (int n = 0; n < kNumWaits; ++n) steps.push_back(flatAt(-1e-3, wait / kNumWaits));
    const double dent = term.fraction * kDent * std::exp(-wait * settled / term.time);
    const double deeper = 1.2e-3;
    steps.push_back(flatAt(dent - 0.01 * kDent, kShort));  // not yet at the skin
    steps.push_back(flatAt(deeper, kShort));
    const std::vector<Pressed> pressed = simulate(sensor, flat(), steps);
    EXPECT_NEAR(pressed[1].force / (kStiffness * kArea * kDent * settled), 1, kClose);
    for (std::size_t n = 2; n + 1 < pressed.size(); ++n) EXPECT_EQ(pressed[n].force, 0) << n;
    EXPECT_NEAR(pressed.back().force / (kStiffness * kArea * (deeper - dent)), 1, kClose) << wait;
  }
}

// Half way back faster than the skin recovers, into the dent again, away for long, and again: never a negative force, less in the dent,
// finally as at first.
void RelaxationCases::pressedAgain() const {
  constexpr double kRadius = 10e-3;
  for (const auto& terms : {std::vector<RelaxationTerm>{{0.7, 0.1}}, kTerms}) {
    const Sensor sensor = fineSkinOf(terms);
    const auto at = [&](double depth, double dt) { return Press{{.position = {0.11e-3, -0.07e-3, kRadius - depth}}, dt}; };
    std::vector<Press> steps{at(1e-3, 1)};
    for (int n = 0; n < 20; ++n) steps.push_back(at(1e-3, 0.1));
    for (const double depth : {0.9e-3, 0.8e-3, 0.5e-3, 0.2e-3, -1e-3, 0.6e-3, 1e-3}) steps.push_back(at(depth, 1e-3));
    for (int n = 0; n < 40; ++n) steps.push_back(at(-1e-3, 10));
    steps.push_back(at(1e-3, 1e-7));
    const std::vector<Pressed> pressed = simulate(sensor, Object(Sphere{kRadius}), steps);
    for (const Pressed& step : pressed) EXPECT_GE(step.smallest, 0);
    const double first = pressed.front().force, in_the_dent = pressed[27].force;
    EXPECT_EQ(pressed[25].force, 0);
    EXPECT_LT(in_the_dent, 0.9 * first);
    EXPECT_GT(in_the_dent, 0);
    EXPECT_NEAR(pressed.back().force / first, 1, kClose);
  }
}

// Always pressed, d = d0 + a sin wt: after the first cycles one loses pi a^2 k0 A E'', E'' = fraction w time / (1 + (w time)^2).
void RelaxationCases::lossOfACycle() const {
  constexpr double kMean = 1e-3, kAmplitude = 0.2e-3;
  constexpr int kPerCycle = 100, kCycles = 6;
  const RelaxationTerm term{0.5, 0.1};
  const Sensor sensor = skinOf({term});
  for (const double times : {0.3, 1 / std::sqrt(2.0), 1.0, 4.0}) {  // w time
    const double omega = times / term.time, dt = 2 * kPi / omega / kPerCycle;
    const auto depthAt = [&](int n) { return kMean + kAmplitude * std::sin(2 * kPi * n / kPerCycle); };
    std::vector<Press> steps{flatAt(kMean, 1), flatAt(kMean, 40 * term.time)};
    for (int n = 1; n <= kCycles * kPerCycle; ++n) steps.push_back(flatAt(depthAt(n), dt));
    const std::vector<Pressed> pressed = simulate(sensor, flat(), steps);
    double work = 0;
    for (int n = (kCycles - 1) * kPerCycle + 1; n <= kCycles * kPerCycle; ++n) {
      const auto k = static_cast<std::size_t>(n + 1);
      work += (pressed[k].force + pressed[k - 1].force) / 2 * (depthAt(n) - depthAt(n - 1));
    }
    const double loss = kPi * kAmplitude * kAmplitude * kStiffness * kArea * term.fraction * times / (1 + times * times);
    // Depths that are off do not sum up over a closed loop: a part of their share, of a force that is the mean's.
    EXPECT_NEAR(work / loss, 1, kClose + 2 * depth_error / kAmplitude) << times;
  }
}

// A closed path of a skin that is at rest at both ends dissipates energy.
void RelaxationCases::cyclesLose() const {
  constexpr double kRadius = 10e-3;
  for (std::uint64_t seed = 0; seed < 6; ++seed) {
    Random random(seed);
    const Sensor sensor = fineSkinOf({{0.4, std::pow(10, random.uniform(-3, 0))}, {0.3, std::pow(10, random.uniform(-2, 1))}});
    std::vector<double> depths{-0.1e-3};
    for (int n = 0; n < 60; ++n) {
      // In steps small enough for the trapezoid rule.
      const double from = depths.back(), to = random.uniform(-0.2e-3, 1.2e-3);
      const int count = random.integer(2, 12);
      for (int i = 1; i <= count; ++i) depths.push_back(from + (to - from) * i / count);
    }
    depths.push_back(-0.1e-3);
    std::vector<Press> steps;
    for (const double depth : depths) steps.push_back({{.position = {0.11e-3, -0.07e-3, kRadius - depth}}, 0.01});
    const std::vector<Pressed> pressed = simulate(sensor, Object(Sphere{kRadius}), steps);
    double work = 0, most = 0;
    for (std::size_t n = 1; n < depths.size(); ++n) {
      EXPECT_GE(pressed[n].smallest, 0);
      work += (pressed[n].force + pressed[n - 1].force) / 2 * (depths[n] - depths[n - 1]);
      most = std::max(most, work);
    }
    EXPECT_GT(work, 0.1 * most) << seed;
  }
}

namespace {

// 16 x 16 nodes, 0.75 mm apart. Of springs what is relaxed here is exact; a layer is solved, on the device to this share of the depth.
Sensor layerOf(std::vector<RelaxationTerm> terms, ElasticLayer::Base base) {
  Sensor sensor = skinOf(std::move(terms), 1, 4);
  sensor.skin.law = ElasticLayer{.elastic_modulus = 1e6, .poisson_ratio = 0.49, .base = base, .iterations = 200, .tolerance = 2e-5};
  return sensor;
}

Sensor withoutRelaxation(Sensor sensor) {
  sensor.skin.relaxation.clear();
  return sensor;
}

}  // namespace

// Under a punch that stays in place all pressures stay in proportion, so that the layer is one spring: k(t) at a constant depth, J(t) under
// a load, and of a dent that was long held the share of its term recovers with the time of creep.
void RelaxationCases::layerUnderAPunch() const {
  constexpr double kDepth = 0.4e-3, kLoad = 2;
  const Object punch(Cylinder{3e-3, 10e-3});
  const auto at = [](double depth, double dt) { return Press{{.position = {0.11e-3, -0.07e-3, 5e-3 - depth}}, dt}; };
  const double slack = kClose + 2 * depth_error / kDepth;
  for (const auto base : {ElasticLayer::Base::kBonded, ElasticLayer::Base::kHalfSpace}) {
    const Sensor sensor = layerOf(kTerms, base);
    std::vector<Press> steps;
    for (const double dt : {0.7, 1e-4, 1e-3, 0.02, 0.003, 0.4, 3.0, 30.0}) steps.push_back(at(kDepth, dt));
    const std::vector<Pressed> held = simulate(sensor, punch, steps);
    double t = 0;
    for (std::size_t n = 1; n < steps.size(); ++n) {
      t += steps[n].dt;
      EXPECT_NEAR(held[n].force / (held[0].force * kernel(sensor, t)), 1, slack) << n;
    }
    const double stiffness = held[0].force / kDepth;
    const RelaxationTerm term{0.6, 0.3};
    const double settled = 1 - term.fraction;
    const Sensor creeping = layerOf({term}, base);
    const std::vector<Pressed> loaded = simulate(creeping, punch, std::vector<Press>(40, {at(0, 0.02).X_SO, 0.02, kLoad}));
    for (std::size_t n = 0; n < loaded.size(); ++n) {
      const double depth = kLoad / stiffness * compliance(term, 0.02 * static_cast<double>(n));
      EXPECT_TRUE(loaded[n].reached);
      EXPECT_NEAR(loaded[n].force / kLoad, 1, kCarried);
      EXPECT_NEAR(-loaded[n].offset, depth, slack * depth + 2 * depth_error) << n;
    }

    constexpr double kShort = 1e-6, kWait = 0.3;
    constexpr int kNumWaits = 30;
    steps = {at(kDepth, 1), at(kDepth, 40 * term.time), at(0.9 * term.fraction * kDepth, kShort), at(-1e-3, kShort)};
    for (int n = 0; n < kNumWaits; ++n) steps.push_back(at(-1e-3, kWait / kNumWaits));
    const double dent = term.fraction * kDepth * std::exp(-kWait * settled / term.time);
    steps.push_back(at(dent - 0.05 * kDepth, kShort));  // not yet at the skin
    steps.push_back(at(kDepth, kShort));
    const std::vector<Pressed> recovers = simulate(creeping, punch, steps);
    EXPECT_NEAR(recovers[1].force / (held[0].force * settled), 1, slack);
    for (std::size_t n = 2; n + 1 < recovers.size(); ++n) EXPECT_EQ(recovers[n].force, 0) << n;
    EXPECT_NEAR(recovers.back().force / (stiffness * (kDepth - dent)), 1, slack);
  }
}

// Under a sphere the contact grows. By its pose, F(t) = int k(t - s) dF0(depth(s)), F0 being the force of the layer that does not relax;
// under a dead load, F0(depth(t)) = F J(t), of a half-space depth ~ (F J)^(2/3) by Hertz.
void RelaxationCases::layerUnderASphere() const {
  constexpr double kRadius = 10e-3, kDepth = 0.6e-3, kLoad = 0.5, kDt = 0.05;
  constexpr std::size_t kNumSteps = 16;
  const RelaxationTerm term{0.5, 0.3};
  const Object sphere(Sphere{kRadius});
  const auto at = [](double depth) { return Pose{.position = {0.11e-3, -0.07e-3, kRadius - depth}}; };
  // A step's path is straight in strain, the load's is at its ends: a sixth of the square of dt over the time of the term.
  const double slack = kClose + kDt * kDt / (6 * term.time * term.time);
  for (const auto base : {ElasticLayer::Base::kBonded, ElasticLayer::Base::kHalfSpace}) {
    const Sensor sensor = layerOf({term}, base), elastic = withoutRelaxation(sensor);
    std::vector<Press> steps, loads, as_compliant;
    for (std::size_t n = 0; n < kNumSteps; ++n) {
      const double t = kDt * static_cast<double>(n);
      steps.push_back({at(kDepth * std::sin(kPi / 2 * static_cast<double>(n + 1) / kNumSteps)), kDt});
      loads.push_back({at(0), kDt, kLoad});
      as_compliant.push_back({at(0), kDt, kLoad * compliance(term, t)});
    }
    const std::vector<Pressed> pressed = simulate(sensor, sphere, steps), at_once = simulate(elastic, sphere, steps);
    for (std::size_t n = 0; n < kNumSteps; ++n) {
      double force = kernel(sensor, kDt * static_cast<double>(n)) * at_once[0].force;
      for (std::size_t k = 1; k <= n; ++k) {
        const double from = kDt * static_cast<double>(n - k),
                     mean = (integralOfKernel(sensor, from + kDt) - integralOfKernel(sensor, from)) / kDt;
        force += mean * (at_once[k].force - at_once[k - 1].force);
      }
      EXPECT_NEAR(pressed[n].force / force, 1, slack + 2 * depth_error / kDepth) << n;
    }
    const std::vector<Pressed> loaded = simulate(sensor, sphere, loads), compliant = simulate(elastic, sphere, as_compliant);
    for (std::size_t n = 0; n < kNumSteps; ++n) {
      EXPECT_TRUE(loaded[n].reached);
      EXPECT_NEAR(loaded[n].force / kLoad, 1, kCarried);
      EXPECT_NEAR(loaded[n].offset / compliant[n].offset, 1, slack) << n;
      if (base != ElasticLayer::Base::kHalfSpace) continue;
      // Four to six nodes in the contact's radius, which a pressure meets one by one.
      constexpr double kGrid = 0.03;
      EXPECT_NEAR(loaded[n].offset / (loaded[0].offset * std::pow(compliance(term, kDt * static_cast<double>(n)), 2.0 / 3)), 1, kGrid) << n;
    }
  }
}

}  // namespace taxelsim::support
