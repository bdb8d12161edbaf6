// Invalid contact points and options are refused with an error that names them, and change nothing.
#include "simulation/comparison.h"
#include "support/input_error.h"
#include "support/random_scene.h"
#include "support/test.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

using support::inputError;

constexpr double kDt = 1e-3;  // s
constexpr OutputOptions kNoDepth{.penetration_depth = false};

using Contacts = std::vector<ContactPoint>;

class ContactErrors : public ::testing::Test {
 protected:
  Model model_{support::sharedDevice(), {.sensor = support::gridSensor(), .objects = {Object(Sphere{0.005})}}};
  Simulator simulator_{model_, {.num_instances = 2, .outputs = kNoDepth, .max_contacts = 3}};
};

TEST_F(ContactErrors, RejectsInvalidContacts) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInfinity = std::numeric_limits<double>::infinity();
  for (const ContactPoint& bad :
       {ContactPoint{{0, 0, 0}, -1}, ContactPoint{{0, 0, 0}, kNan}, ContactPoint{{0, 0, 0}, kInfinity}, ContactPoint{{0, 0, 0}, 1e300},
        ContactPoint{{kNan, 0, 0}, 1}, ContactPoint{{0, -kInfinity, 0}, 1}, ContactPoint{{0, 0, 1e7}, 1}}) {
    const Contacts contacts{{{0, 0, 0}, 1}, bad};
    EXPECT_NE(inputError([&] { simulator_.setContacts(1, contacts); }).find("contact 1 of instance 1"), std::string::npos);
    inputError([&] { simulator_.setContacts(contacts, std::vector<int>{0, 0, 2}); });
  }
}

TEST_F(ContactErrors, RejectsInvalidCounts) {
  const Contacts four(4);
  EXPECT_NE(inputError([&] { simulator_.setContacts(0, four); }).find("max_contacts is 3"), std::string::npos);
  inputError([&] { simulator_.setContacts(four, std::vector<int>{0, 0, 4}); });
  inputError([&] { simulator_.setContacts(four, std::vector<int>{0, 4}); });
  inputError([&] { simulator_.setContacts(four, std::vector<int>{1, 2, 4}); });
  inputError([&] { simulator_.setContacts(four, std::vector<int>{0, 2, 3}); });
  inputError([&] { simulator_.setContacts(four, std::vector<int>{0, 3, 2}); });
  inputError([&] { simulator_.setContacts(four, std::vector<int>{0, -1, 4}); });
  EXPECT_NO_THROW(simulator_.setContacts(four, std::vector<int>{0, 2, 4}));
  inputError([&] { simulator_.setContacts(2, {}); });
  inputError([&] { simulator_.setContacts(-1, {}); });
}

TEST_F(ContactErrors, RejectedInputChangesNothing) {
  simulator_.setContacts(0, Contacts{{{0, 0, 0}, 1}});
  inputError([&] { simulator_.setContacts(Contacts{{{0, 0, 0}, 2}, {{0, 0, 0}, -2}}, std::vector<int>{0, 1, 2}); });
  EXPECT_EQ(support::stepOnce(simulator_, kDt).ground_truth.total_force[0], 1);
}

TEST_F(ContactErrors, RejectsObjectsTogetherWithContacts) {
  inputError([&] { simulator_.setObjects(std::vector<int>{0, 0}, std::vector<Pose>(2)); });
  inputError([&] { simulator_.setObjects(0, std::vector<int>{0}, std::vector<Pose>(1)); });
  inputError([&] { simulator_.setLoad(0, 1); });
  inputError([&] { simulator_.setLoads(std::vector<float>{1, 1}); });
  Simulator with_objects(model_, {});
  inputError([&] { with_objects.setContacts(0, {}); });
  inputError([&] { with_objects.setContacts({}, std::vector<int>{0, 0}); });
}

TEST_F(ContactErrors, RejectsInvalidOptions) {
  inputError([&] { Simulator(model_, {.outputs = kNoDepth, .max_contacts = -1}); });
  inputError([&] { Simulator(model_, {.outputs = kNoDepth, .max_contacts = kMaxContacts + 1}); });
  EXPECT_NE(inputError([&] { Simulator(model_, {.max_contacts = 1}); }).find("penetration_depth"), std::string::npos);
  for (const double band : {-1e-3, 2.0, std::numeric_limits<double>::quiet_NaN()}) {
    inputError([&] { Simulator(model_, {.outputs = kNoDepth, .max_contacts = 1, .contact_band = band}); });
  }
}

}  // namespace
}  // namespace taxelsim
