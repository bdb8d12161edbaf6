// Times of sensor frames, and how many steps a delay spans. Needs no device.
#include "simulation/clock.h"
#include "support/test.h"

namespace taxelsim {
namespace {

constexpr double kRate = 100;  // Hz

// Times (s) at which frames come in `num_steps` steps of dt.
std::vector<double> delivered(const FrameTiming& timing, double dt, int num_steps, std::uint64_t episode = 0) {
  Clock clock;
  std::vector<double> times;
  for (int step = 0; step < num_steps; ++step) {
    if (clock.frameDue(timing.rate)) {
      times.push_back(clock.time);
      clock.deliver(timing, episode);
    }
    clock.time += dt;
  }
  return times;
}

TEST(Clock, WithoutJitterFramesAreEven) {
  const std::vector<double> times = delivered({.rate = kRate}, 1e-3, 1001);
  ASSERT_EQ(times.size(), 101u);
  for (std::size_t k = 0; k < times.size(); ++k) EXPECT_NEAR(times[k], static_cast<double>(k) / kRate, 1e-9);
  EXPECT_EQ(delivered({}, 1e-3, 50).size(), 50u) << "a frame at every step";
}

TEST(Clock, JitterIsNormalAboutTheEvenInstants) {
  const double jitter = 1e-3, dt = 2e-5;  // s; a frame comes on average half a step after it is due
  const std::vector<double> times = delivered({.rate = kRate, .jitter = jitter, .seed = 3}, dt, 2'000'000);
  const auto n = static_cast<double>(times.size());
  ASSERT_NEAR(n, 4000, 1);  // order is kept where neighbours are ten standard deviations apart
  EXPECT_EQ(times[0], 0) << "a first frame comes at once";
  double mean = 0, square = 0, cube = 0;
  for (std::size_t k = 1; k < times.size(); ++k) {
    const double late = (times[k] - static_cast<double>(k) / kRate - dt / 2) / jitter;
    mean += late / n;
    square += late * late / n;
    cube += late * late * late / n;
  }
  // Five standard errors of the moments of a normal distribution: 1, 2 and 15 over n.
  EXPECT_NEAR(mean, 0, 5 / std::sqrt(n));
  EXPECT_NEAR(square, 1, 5 * std::sqrt(2 / n));
  EXPECT_NEAR(cube, 0, 5 * std::sqrt(15 / n));
}

TEST(Clock, JitterFollowsFromSeedAndEpisode) {
  const FrameTiming timing{.rate = kRate, .jitter = 2e-3, .seed = 3};
  const std::vector<double> times = delivered(timing, 1e-4, 5000, 7);
  EXPECT_EQ(delivered(timing, 1e-4, 5000, 7), times);
  EXPECT_NE(delivered(timing, 1e-4, 5000, 8), times);
  FrameTiming other = timing;
  other.seed = 4;
  EXPECT_NE(delivered(other, 1e-4, 5000, 7), times);
}

// With the widest jitter, at most one frame per step and no frame lost, for steps shorter and longer than a frame.
TEST(Clock, WideJitterKeepsOrder) {
  for (const double dt : {1e-4, 3e-3, 0.01, 0.7}) {
    const FrameTiming timing{.rate = kRate, .jitter = 1 / kRate, .seed = 5};
    Clock clock;
    std::uint32_t frames = 0;
    for (int step = 0; step < 3000; ++step, clock.time += dt) {
      if (!clock.frameDue(kRate)) continue;
      clock.deliver(timing, 1);
      EXPECT_GT(clock.frames, frames);
      frames = clock.frames;
      EXPECT_LT(std::abs(frames - clock.time * kRate), 10) << "periods; a normal number stays within 5.9";
      EXPECT_GT(clock.due, clock.time * kRate);
    }
    EXPECT_GT(frames, 0u);
  }
}

// Adds a step of dt and returns how many steps back a force of age `delay` lies.
std::uint32_t stepsBack(StepHistory& history, double dt, double delay) {
  history.add(dt);
  return history.stepsBack(delay);
}

TEST(StepHistory, CountsStepsBack) {
  StepHistory even;
  EXPECT_EQ(stepsBack(even, 0.01, 0), 0u);
  for (int n = 0; n < 40; ++n) stepsBack(even, 0.01, 0.03);
  EXPECT_EQ(stepsBack(even, 0.01, 0.03), 3u);
  EXPECT_EQ(stepsBack(even, 0.01, 0.031), 4u);
  EXPECT_EQ(stepsBack(even, 0.01, 0.32), 32u);
  EXPECT_EQ(stepsBack(even, 0.02, 0.03), 2u) << "one of 20 ms and one of 10";
  EXPECT_EQ(stepsBack(even, 0.02, 0.04), 2u);
}

TEST(StepHistory, StartsAtTheFirstStep) {
  StepHistory history;
  for (int n = 1; n < 3; ++n) EXPECT_GT(stepsBack(history, 0.01, 0.03), static_cast<std::uint32_t>(kMaxDelaySteps));
  EXPECT_EQ(stepsBack(history, 0.01, 0.03), 3u);
}

}  // namespace
}  // namespace taxelsim
