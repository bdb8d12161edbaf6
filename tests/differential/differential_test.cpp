// Random contacts on every driver: each output lies within derived bounds of the twin, so that two drivers differ by the width of these at
// most. A difference is shrunk to a small scene and printed. TAXELSIM_CASES=all: 10,000 contacts on 35 models; TAXELSIM_CASES=N: N on each
// of them. TAXELSIM_DIFFERENTIAL_OUT=FILE adds a line for each contact, with which compare_drivers.py compares drivers directly.
#include <iostream>

#include "base/sha256.h"
#include "differential/check_contacts.h"
#include "differential/shrink.h"
#include "support/cases.h"
#include "support/random_scene.h"
#include "support/test.h"

namespace taxelsim::support {
namespace {

constexpr int kNumModels = 35;
constexpr int kAllSpringContacts = 300, kAllLayerContacts = 200;  // of a model: 9,000 and 1,000 together
constexpr int kFewContacts = 6;
// Median width of the bounds in skin thicknesses: wider ones would prove little.
constexpr double kLoosestBounds = 0.01;
constexpr int kMaxShrunk = 5;  // differences of a model that are shrunk

bool isLayer(int number) {
  return static_cast<LawKind>(number % kNumLawKinds) == LawKind::kElasticLayer;
}

int numContacts(int number) {
  if (const int wanted = std::atoi(wantedCases().c_str()); wanted > 0) return wanted;
  return numCases(kFewContacts, isLayer(number) ? kAllLayerContacts : kAllSpringContacts);
}

// One contact of the set, alone.
ContactSet onlyContact(const ContactSet& set, std::size_t i) {
  return {set.sensor, set.objects, {set.touches[i]}};
}

// A shrunken set may be one that a model refuses.
bool differsFromTwin(const ContactSet& set) {
  try {
    return !checkContacts(set)[0].problem.empty();
  } catch (const std::exception&) {
    return false;
  }
}

void writeResults(int number, const std::vector<ContactResult>& results) {
  const char* file = std::getenv("TAXELSIM_DIFFERENTIAL_OUT");
  if (file == nullptr) return;
  std::ofstream out(file, std::ios::app);
  out.precision(9);
  for (std::size_t i = 0; i < results.size(); ++i)
    out << number << "," << i << "," << sha256Hex(std::as_bytes(std::span(results[i].values))).substr(0, 16) << ","
        << results[i].total_force << "\n";
}

class DifferentialSeeds : public ::testing::TestWithParam<int> {};

TEST_P(DifferentialSeeds, MatchesTheTwin) {
  const int number = GetParam();
  const ContactSet set = randomContacts(number, numContacts(number));
  const std::vector<ContactResult> results = checkContacts(set);
  writeResults(number, results);
  int num_different = 0, num_touching = 0;
  for (std::size_t i = 0; i < results.size(); ++i) {
    num_touching += results[i].total_force > 0;
    if (results[i].problem.empty()) continue;
    ADD_FAILURE() << "model " << number << ", contact " << i << ": " << results[i].problem;
    if (++num_different > kMaxShrunk) continue;
    const ContactSet small = shrink(onlyContact(set, i), differsFromTwin);
    std::cout << "Shrunk:\n" << sceneText(small) << checkContacts(small)[0].problem << std::endl;
  }
  std::vector<double> looseness;
  for (const ContactResult& result : results) looseness.push_back(result.looseness);
  expectMedianAtMost(looseness, kLoosestBounds);
  EXPECT_GE(5 * num_touching, static_cast<int>(results.size())) << "small objects fall between samples, but not so many";
}

// By default one model of plain springs, one of a law with a response of the taxels and one of an elastic layer.
INSTANTIATE_TEST_SUITE_P(Models, DifferentialSeeds,
                         !wantedCases().empty() ? ::testing::ValuesIn([] {
                           std::vector<int> all;
                           for (int n = 0; n < kNumModels; ++n) all.push_back(n);
                           return all;
                         }())
                                                : ::testing::ValuesIn(std::vector<int>{0, 10, 6}));

// A scene that the comparison found and shrunk: a ray that passes the tube of a torus at a gap of 1.1 um took too many steps and counted as
// a hit.
TEST(Differential, RaysPassATorusClosely) {
  ContactSet set{
      gridSensor({.num_rows = 4,
                  .num_cols = 1,
                  .pitch_x = 0.003424833990187551,
                  .pitch_y = 0.0011179592288175523,
                  .samples_per_taxel = 6,
                  .thickness = 0.002313257097600317}),
      {Torus{0.003703298318255254, 0.00056652582582242847}},
      {{{0}, {{{-0.005, -0.0028, 0.0029}, {0.70434243540043573, 0.35037031896644488, 0.50715057240425532, -0.3520520844868994}}}}}};
  set.sensor.patches[0].X_SP = {{0, 0.000745935652087794, -0.0005570349453118135},
                                {0.8912406222707335, -0.027246189368422713, 0.09856370290795793, 0.4418517792749594}};
  const ContactResult result = checkContacts(set)[0];
  EXPECT_EQ(result.problem, "");
  EXPECT_GT(result.total_force, 0);
}

// A made-up difference: a mesh whose lowest vertex is below the skin. Everything that it does not need goes.
TEST(Shrink, KeepsWhatTheDifferenceNeeds) {
  ContactSet set = randomContacts(0, 20);
  Random random(1);
  set.objects.push_back(icosphere(0.01, 2, 0, random));
  set.touches[0] = {{0, static_cast<int>(set.objects.size()) - 1}, {Pose{}, {{0.00123456, 0.00234567, 0.0098765}, random.rotation()}}};
  set.touches.resize(1);
  int num_calls = 0;
  const auto differs = [&](const ContactSet& s) {
    ++num_calls;
    for (std::size_t slot = 0; slot < s.touches[0].ids.size(); ++slot) {
      const int id = s.touches[0].ids[slot];
      const Mesh* mesh = id == kNoObject ? nullptr : std::get_if<Mesh>(&s.objects[static_cast<std::size_t>(id)].shape);
      if (mesh != nullptr && !mesh->triangles.empty() && s.touches[0].X_SO[slot].position[2] < 0.0099) return true;
    }
    return false;
  };
  const ContactSet small = shrink(set, differs);
  EXPECT_TRUE(differs(small));
  EXPECT_LE(num_calls, 201);
  ASSERT_EQ(small.touches[0].ids, std::vector<int>{0});
  ASSERT_EQ(small.objects.size(), 1u);
  EXPECT_EQ(std::get<Mesh>(small.objects[0].shape).triangles.size(), 1u);
  EXPECT_EQ(numTaxels(small.sensor), 1);
  EXPECT_EQ(small.sensor.samples_per_taxel, 1);
  EXPECT_EQ(small.touches[0].X_SO[0].rotation, (Quaternion{1, 0, 0, 0}));
  EXPECT_NEAR(small.touches[0].X_SO[0].position[0], 0.001, 1e-9);
  EXPECT_NE(sceneText(small).find("\nf "), std::string::npos) << sceneText(small);
}

}  // namespace
}  // namespace taxelsim::support
