// Experiments with grasps: decay of the force error against the theory of the control law, and the readings of the traces.
#include "support/test.h"
#include "taxelsim/device.h"
#include "taxelsim/error.h"
#include "taxelsim/experiment.h"

namespace taxelsim {
namespace {

GraspExperiment shipped() {
  return loadGraspExperiment(TAXELSIM_SOURCE_DIR "/scenes/experiments/gripper_gains.yaml");
}

// The jaw is flat on a face: a contact of constant stiffness, whose error decays by 1 - gain / rate.
TEST(GraspExperiment, TheJawDecaysAsInTheory) {
  const GraspExperiment experiment = shipped();
  const std::vector<GraspRun> runs = runGraspExperiment(Device::open(), experiment);
  ASSERT_EQ(runs.size(), 3u);
  for (std::size_t r = 0; r < runs.size(); ++r) {
    const GraspFingerTrace& jaw = runs[r].fingers.at(0);
    EXPECT_EQ(jaw.name, "left");
    EXPECT_DOUBLE_EQ(runs[r].expected_decay, 1 - experiment.gains[r] / 100);
    // The loop feels whole counts: each of 24 taxels is off by at most half a count, 1/4800 N, so that the command of a frame is off by at
    // most 24 / 4800 N / (0.1 target) of the least error of the fall.
    const double rounding = 24.0 / 4800 / (0.1 * jaw.target) * experiment.gains[r] / 100;
    EXPECT_NEAR(jaw.decay, runs[r].expected_decay, rounding) << experiment.gains[r];
  }
  EXPECT_EQ(runs[0].fingers[0].first_contact, runs[2].fingers[0].first_contact);  // no gain acts before it
  EXPECT_EQ(runs[0].fingers[0].overshoot, runs[2].fingers[0].overshoot);          // of the frame of the first contact
  EXPECT_GT(runs[0].fingers[0].settling_time, runs[1].fingers[0].settling_time);
  EXPECT_GT(runs[1].fingers[0].settling_time, runs[2].fingers[0].settling_time);
}

TEST(GraspExperiment, ReportsWhatTheTracesShow) {
  GraspExperiment experiment = shipped();
  experiment.gains = {20};
  const std::vector<GraspRun> runs = runGraspExperiment(Device::open(), experiment);
  const GraspRun& run = runs.at(0);
  ASSERT_EQ(run.time.size(), 150u);
  EXPECT_DOUBLE_EQ(run.time[149], 1.49);
  for (const GraspFingerTrace& finger : run.fingers) {
    ASSERT_EQ(finger.force.size(), 150u);
    const auto contact = static_cast<std::size_t>(std::lround(finger.first_contact * 100));
    EXPECT_GT(finger.force[contact], 0);
    EXPECT_EQ(finger.force[contact - 1], 0);
    const auto settled = static_cast<std::size_t>(std::lround(finger.settling_time * 100));
    for (std::size_t n = settled; n < 150; ++n) EXPECT_LE(std::abs(finger.force[n] - finger.target), 0.1 * finger.target);
    EXPECT_GT(std::abs(finger.force[settled - 1] - finger.target), 0.1 * finger.target);
  }
}

TEST(GraspExperiment, RefusesOtherScenesAndGains) {
  GraspExperiment experiment = shipped();
  experiment.gains = {101};
  EXPECT_THROW(runGraspExperiment(Device::open(), experiment), Error);
  experiment = shipped();
  experiment.scene.grasp.reset();
  EXPECT_THROW(runGraspExperiment(Device::open(), experiment), Error);
}

}  // namespace
}  // namespace taxelsim
