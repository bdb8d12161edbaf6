#include "differential/check_contacts.h"

#include <gtest/gtest-spi.h>

#include "base/vector3.h"
#include "reference/elastic_layer.h"
#include "reference/taxel_laws.h"
#include "simulation/layer_scene.h"
#include "support/random_scene.h"
#include "support/test.h"

namespace taxelsim::support {
namespace {

constexpr double kDt = 1e-3;          // s
constexpr double kSmallReach = 0.1;   // m: the reach that kShift and kMarginZ hold for
constexpr double kTorusReach = 0.03;  // m: likewise kTorusMarginZ
// Matrix, state and force of a step of the masses, rounded to float32: about eight roundings relative to the largest force, twice.
constexpr double kMassStep = 16 * kUlp;
// The published weights of the mask, and those of the device, have five digits.
constexpr double kMaskWeights = 2e-5;

struct LawCheck {
  const ContactSet& set;
  const FrameView& frame;
  std::vector<std::vector<float>> pressed;  // (num_contacts x num_taxels), N: contact forces; for laws with a response of the taxels
};

// Largest distance of a point of the placed objects, that may touch the skin, from either origin: coordinates are rounded relative to it. A
// half-space is a plane; its distance counts.
double reachOf(const Sensor& sensor, const std::vector<reference::PlacedObject>& placed) {
  double reach = extentOf(sensor);
  for (const reference::PlacedObject& object : placed) reach = std::max(reach, 2 * length(object.X_SO.position) + extentOf(sensor));
  return reach;
}

// The tolerances of comparison.h are those of small objects; roundings of coordinates grow in proportion to these.
Rounding roundingWithin(const Sensor& sensor, const std::vector<reference::PlacedObject>& placed) {
  Rounding rounding = roundingFor(sensor, placed);
  const double reach = reachOf(sensor, placed);
  const bool has_torus = rounding.margin_z == kTorusMarginZ;
  rounding.shift *= std::max(1.0, reach / kSmallReach);
  rounding.margin_z *= std::max(1.0, reach / (has_torus ? kTorusReach : kSmallReach));
  return rounding;
}

bool hasResponse(const Sensor& sensor) {
  return std::holds_alternative<MassSpringDamper>(sensor.skin.law) || std::holds_alternative<DeformationMask>(sensor.skin.law);
}

std::span<const float> forcesOf(const FrameView& frame, std::size_t i, std::size_t num_taxels) {
  return frame.ground_truth.tactile_normal_force.subspan(i * num_taxels, num_taxels);
}

// Contact forces under a law with a response of the taxels, from a skin of plain springs.
ContactSet onPlainSprings(ContactSet set) {
  set.sensor.skin.law = Winkler{foundationOf(set.sensor.skin).normal_contact_stiffness, 1, 0};
  return set;
}

void checkResponse(const LawCheck& check, std::size_t i) {
  const Sensor& sensor = check.set.sensor;
  const std::vector<double> pressed(check.pressed[i].begin(), check.pressed[i].end());
  std::vector<reference::TaxelState> state;
  const std::vector<double> expected = reference::taxelResponse(sensor, pressed, kDt, state);
  const bool is_mask = std::holds_alternative<DeformationMask>(sensor.skin.law);
  double largest = 0, total = 0;
  for (const double force : pressed) {
    largest = std::max(largest, force);
    total += force;
  }
  const double slack = (is_mask ? kMaskWeights * total : kMassStep * largest) + kAbsoluteForce;
  const std::span<const float> forces = forcesOf(check.frame, i, expected.size());
  for (std::size_t t = 0; t < expected.size(); ++t) EXPECT_NEAR(forces[t], expected[t], slack) << "response of taxel " << t;
}

// Returns the looseness of the bounds.
double checkSprings(const LawCheck& check, std::size_t i) {
  const Sensor& sensor = check.set.sensor;
  const auto placed = check.set.touches[i].placed(check.set.objects);
  FrameEnvelope envelope = frameEnvelope(sensor, placed, roundingWithin(sensor, placed));
  if (std::holds_alternative<Proximity>(sensor.skin.law)) {  // depth without force
    envelope.wrench = {std::vector<double>(6, 0), std::vector<double>(6, 0)};
  }
  expectMatches(check.frame, static_cast<int>(i), sensor, envelope);
  return looseness(sensor, envelope);
}

void checkLayer(const LawCheck& check, std::size_t i) {
  const Sensor& sensor = check.set.sensor;
  const auto placed = check.set.touches[i].placed(check.set.objects);
  const reference::LayerContact twin = reference::layerContact(sensor, placed);
  const double margin_z = kMarginZ * std::max(1.0, reachOf(sensor, placed) / kSmallReach);
  const double deepest = *std::max_element(twin.overlap.begin(), twin.overlap.end());
  const double solution = 40 * kTightTolerance;  // see forceSlack() of layer_scene.h
  const double force = twin.total_force + twin.off_array_load;
  const double slack = deepest > margin_z ? std::min(1.0, solution + 2 * margin_z / deepest) * force + kAbsoluteForce
                                          : force + foundationOf(sensor.skin).normal_contact_stiffness * margin_z * 1e-4 + kAbsoluteForce;
  const std::span<const float> forces = forcesOf(check.frame, i, twin.taxel_force.size());
  // A deflection between contacts changes no more than the largest one at them; a steep face moves sideways, too.
  const Bounded overlap = frameEnvelope(sensor, placed, roundingWithin(sensor, placed)).penetration;
  double depth_slack = 2 * margin_z;
  for (std::size_t n = 0; n < overlap.low.size(); ++n)
    if (overlap.low[n] > 0) depth_slack = std::max(depth_slack, overlap.high[n] - overlap.low[n]);
  for (std::size_t t = 0; t < forces.size(); ++t) {
    EXPECT_NEAR(forces[t], twin.taxel_force[t], slack) << "taxel " << t;
    EXPECT_NEAR(check.frame.ground_truth.penetration_depth[i * forces.size() + t], twin.mean_penetration[t], depth_slack) << "taxel " << t;
  }
  for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(check.frame.ground_truth.contact_wrench[6 * i + k], twin.wrench[k], slack) << "force";
}

// The first failed expectation of `body` as one text; nothing if all hold.
template <typename Body>
std::string firstFailure(Body body) {
  ::testing::TestPartResultArray results;
  {
    const ::testing::ScopedFakeTestPartResultReporter reporter(::testing::ScopedFakeTestPartResultReporter::INTERCEPT_ONLY_CURRENT_THREAD,
                                                               &results);
    body();
  }
  for (int n = 0; n < results.size(); ++n)
    if (results.GetTestPartResult(n).failed()) return results.GetTestPartResult(n).message();
  return {};
}

// Steps all contacts of the set and passes the frame on, which ends with the simulator.
template <typename Body>
void stepAll(const ContactSet& set, Body body) {
  const Model model(sharedDevice(), {.sensor = set.sensor, .objects = set.objects});
  Simulator simulator(
      model, {.num_instances = static_cast<int>(set.touches.size()), .num_slots = static_cast<int>(set.touches.front().ids.size())});
  body(stepOnce(simulator, set.touches, kDt));
}

template <typename Check>
std::vector<ContactResult> resultsOf(const ContactSet& set, const FrameView& frame, Check check) {
  const int num_contacts = static_cast<int>(set.touches.size());
  std::vector<ContactResult> results;
  const std::string ill_formed = firstFailure([&] { expectWellFormed(frame, set.sensor, num_contacts); });
  for (int i = 0; i < num_contacts; ++i) {
    const auto instance = static_cast<std::size_t>(i);
    results.push_back({ill_formed, bitsOf(frame, i, num_contacts), frame.ground_truth.total_force[instance]});
    if (ill_formed.empty()) results.back().problem = firstFailure([&] { results.back().looseness = check(instance); });
  }
  return results;
}

}  // namespace

std::vector<ContactResult> checkContacts(const ContactSet& set) {
  std::vector<ContactResult> results;
  LawCheck check{set, {}, {}};
  std::vector<ContactResult> on_springs;
  if (hasResponse(set.sensor)) {
    const ContactSet springs = onPlainSprings(set);
    stepAll(springs, [&](const FrameView& frame) {
      const LawCheck plain{springs, frame, {}};
      on_springs = resultsOf(springs, frame, [&](std::size_t i) { return checkSprings(plain, i); });
      const auto num_taxels = static_cast<std::size_t>(numTaxels(set.sensor));
      for (std::size_t i = 0; i < set.touches.size(); ++i) {
        const std::span<const float> forces = forcesOf(frame, i, num_taxels);
        check.pressed.emplace_back(forces.begin(), forces.end());
      }
    });
  }
  const bool is_layer = std::holds_alternative<ElasticLayer>(set.sensor.skin.law);
  stepAll(set, [&](const FrameView& frame) {
    const LawCheck with_frame{set, frame, check.pressed};
    results = resultsOf(set, frame, [&](std::size_t i) {
      if (!is_layer && with_frame.pressed.empty()) return checkSprings(with_frame, i);
      is_layer ? checkLayer(with_frame, i) : checkResponse(with_frame, i);
      return 0.0;
    });
  });
  for (std::size_t i = 0; i < on_springs.size(); ++i) {
    if (results[i].problem.empty()) results[i].problem = on_springs[i].problem;
    results[i].looseness = on_springs[i].looseness;
  }
  return results;
}

}  // namespace taxelsim::support
