#include "episodes/draw.h"

#include "episodes/example_scene.h"
#include "support/input_error.h"
#include "support/test.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

// m: a few roundings of positions below 1 m.
constexpr double kRounding = 1e-15;

EpisodeDraw drawEpisode(const Scene& scene, std::uint64_t episode) {
  return EpisodeDrawer(scene).draw(episode);
}

Vector3 lowestInSensor(const Scene& scene, const EpisodeDraw& draw) {
  return draw.X_SO * lowestPoint(scene.objects[draw.object].object, draw.X_SO.rotation);
}

bool within(double value, const Range& range) {
  return value >= range.min - kRounding && value <= range.max + kRounding;
}

TEST(DrawEpisode, LowestPointIsAtTheDrawnPosition) {
  const Scene scene = exampleScene();
  for (std::uint64_t episode = 0; episode < 200; ++episode) {
    const EpisodeDraw draw = drawEpisode(scene, episode);
    const Vector3 lowest = lowestInSensor(scene, draw);
    EXPECT_TRUE(within(lowest[0], scene.randomization.x)) << episode;
    EXPECT_TRUE(within(lowest[1], scene.randomization.y)) << episode;
    EXPECT_NEAR(lowest[2], 0, kRounding) << episode;
    EXPECT_TRUE(draw.load_driven);
    EXPECT_EQ(draw.depth, 0);
    EXPECT_TRUE(within(draw.load, *scene.randomization.load)) << episode;
    // float32.
    EXPECT_NEAR(draw.variation.gain, 1, 0.1 + 1e-7);
    EXPECT_NEAR(draw.variation.gain_spread, 0.025, 0.025 + 1e-7);
    EXPECT_NEAR(draw.variation.noise, 2.5, 2.5 + 1e-6);
  }
}

TEST(DrawEpisode, DepthDrivenObjectIsAtTheDrawnDepth) {
  Scene scene = exampleScene();
  scene.randomization.load.reset();
  scene.randomization.depth = Range{0.4e-3, 0.8e-3};
  for (std::uint64_t episode = 0; episode < 50; ++episode) {
    const EpisodeDraw draw = drawEpisode(scene, episode);
    EXPECT_FALSE(draw.load_driven);
    EXPECT_EQ(draw.load, 0);
    EXPECT_TRUE(within(draw.depth, *scene.randomization.depth));
    EXPECT_NEAR(lowestInSensor(scene, draw)[2], -draw.depth, kRounding);
  }
}

TEST(DrawEpisode, DegenerateRangesGiveExactValues) {
  Scene scene = exampleScene();
  scene.randomization = {.x = {0.001, 0.001}, .y = {-0.002, -0.002}, .yaw = {0, 0}, .tilt = {0, 0}, .load = Range{2, 2}, .depth = {}};
  scene.objects.erase(scene.objects.begin());
  const EpisodeDraw draw = drawEpisode(scene, 7);
  EXPECT_EQ(draw.X_SO, (Pose{{0.001, -0.002, 0.01}, {1, 0, 0, 0}}));
  EXPECT_EQ(draw.load, 2);
  EXPECT_EQ(draw.variation.gain, 1);
  EXPECT_EQ(draw.variation.gain_spread, 0);
  EXPECT_EQ(draw.variation.noise, 0);
}

// R_SO = Rz(yaw) R_tilt R_orientation. Without tilt the axis of the bar is in the plane of the skin, at the yaw angle from y; with tilt its
// slope is at most the tilt.
TEST(DrawEpisode, OrientationHasTheDrawnYawAndTilt) {
  Scene scene = exampleScene();
  scene.objects.resize(1);
  scene.randomization.tilt = {0, 0};
  scene.randomization.yaw = {0.3, 0.3};
  Vector3 axis = rotate(drawEpisode(scene, 0).X_SO.rotation, {0, 0, 1});
  EXPECT_NEAR(axis[0] * std::cos(0.3) + axis[1] * std::sin(0.3), 0, kRounding);
  EXPECT_NEAR(axis[2], 0, kRounding);

  scene.randomization.tilt = {0.2, 0.2};
  double steepest = 0;
  for (std::uint64_t episode = 0; episode < 200; ++episode) {
    axis = rotate(drawEpisode(scene, episode).X_SO.rotation, {0, 0, 1});
    EXPECT_LE(std::abs(axis[2]), std::sin(0.2) + kRounding);
    steepest = std::max(steepest, std::abs(axis[2]));
  }
  EXPECT_GT(steepest, 0.9 * std::sin(0.2));
}

TEST(DrawEpisode, DependsOnSeedAndEpisodeOnly) {
  Scene scene = exampleScene();
  const EpisodeDraw first = drawEpisode(scene, 3);
  drawEpisode(scene, 100);
  EXPECT_EQ(drawEpisode(scene, 3).X_SO, first.X_SO);
  EXPECT_NE(drawEpisode(scene, 4).X_SO, first.X_SO);
  // Independent of the number of episodes and the rates.
  scene.num_episodes = 1000;
  scene.simulation_rate = 7;
  EXPECT_EQ(drawEpisode(scene, 3).X_SO, first.X_SO);
  scene.seed = 12;
  EXPECT_NE(drawEpisode(scene, 3).X_SO, first.X_SO);
}

TEST(DrawEpisode, ChoosesObjectsByWeight) {
  const Scene scene = exampleScene();
  constexpr int kDraws = 4000;
  int bars = 0;
  for (int episode = 0; episode < kDraws; ++episode) bars += drawEpisode(scene, episode).object == 0;
  // Weights 3 : 1. Five standard deviations of a binomial proportion: 5 sqrt(0.75 0.25 / 4000) = 0.034.
  EXPECT_NEAR(bars / double{kDraws}, 0.75, 0.034);
}

TEST(DrawEpisode, NeverChoosesWeightZero) {
  Scene scene = exampleScene();
  scene.objects[0].weight = 0;
  SceneObject last = scene.objects[1];
  last.weight = 0;
  scene.objects.push_back(last);
  for (int episode = 0; episode < 200; ++episode) EXPECT_EQ(drawEpisode(scene, episode).object, 1);
}

// The order of the draws is part of the data set format: these values change only with a new major version.
TEST(DrawEpisode, MatchesStoredValues) {
  const EpisodeDraw draw = drawEpisode(exampleScene(), 5);
  EXPECT_EQ(draw.object, 0);
  EXPECT_NEAR(draw.X_SO.position[0], 0.045720666936503729, 1e-12);
  EXPECT_NEAR(draw.X_SO.position[1], 0.016096372954544726, 1e-12);
  EXPECT_NEAR(draw.X_SO.position[2], 0.0081454418807579143, 1e-12);
  EXPECT_NEAR(draw.X_SO.rotation[0], 0.57647565732013428, 1e-12);
  EXPECT_FLOAT_EQ(draw.load, 3.05140281f);
  EXPECT_FLOAT_EQ(draw.variation.gain, 1.05711508f);
  EXPECT_FLOAT_EQ(draw.variation.gain_spread, 0.0171751231f);
  EXPECT_FLOAT_EQ(draw.variation.noise, 2.1429491f);
}

TEST(DrawEpisode, ErrorWithoutLowestPointNamesFileAndEpisode) {
  Scene scene = exampleScene();
  scene.objects = {{Object(HalfSpace{}), 1, axisAngle({1, 0, 0}, 3.0)}};
  EXPECT_THAT(support::inputError([&] { drawEpisode(scene, 42); }), ::testing::HasSubstr("example.yaml: episode 42"));
}

}  // namespace
}  // namespace taxelsim
