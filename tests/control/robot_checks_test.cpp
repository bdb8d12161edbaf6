#include "control/robots.h"

#include "example_robots.h"
#include "support/test.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

TEST(CheckRobot, RejectsInvalidFields) {
  const double inf = std::numeric_limits<double>::infinity();
  std::vector<Manipulator> bad(20, lwr());
  int i = 0;
  bad[i++].joints.clear();
  bad[i++].joints.resize(kMaxJoints + 1);
  bad[i++].sensors.clear();
  bad[i++].joints[0].lower = 3;
  bad[i++].joints[0].lower = kNan;
  bad[i++].joints[0].max_velocity = 0;
  bad[i++].joints[0].initial_position = 3;
  bad[i++].joints[0].initial_position = kNan;
  bad[i++].sensors[0].chain[0].joint = 7;
  bad[i++].sensors[0].chain[0].multiplier = inf;
  bad[i++].sensors[0].chain[0].X_PJ.rotation = {1, 1, 0, 0};
  bad[i++].sensors[0].chain.resize(kMaxChainJoints + 1);
  bad[i++].sensors[0].X_JS.position[0] = kNan;
  bad[i++].X_WB.rotation = {0, 0, 0, 0};
  bad[i++].selection.fill(false);
  bad[i++].max_damping = 0;
  bad[i++].singular_threshold = 1.5;
  bad[i++].drive.position_step = -1;
  bad[i++].drive.position_step = kNan;
  bad[i++].drive.delay = -1;
  for (std::size_t k = 0; k < bad.size(); ++k) EXPECT_THROW(Robots(bad[k], 1), Error) << k;
  EXPECT_NO_THROW(Robots(lwr(), 1));
  EXPECT_THROW(panTilt({.tilt_height = kNan}), Error);
  EXPECT_THROW(panTilt({.sensors = {{"roll", {}}}}), Error);
  EXPECT_THROW(panTilt({.position_limits = {0.001, 0.002}}), Error);  // no multiple of the step within the limits
  EXPECT_THROW(panTilt({.max_velocity = -1}), Error);
}

}  // namespace
}  // namespace taxelsim
