#include "episodes/true_edge.h"

#include "episodes/draw.h"
#include "episodes/example_scene.h"
#include "support/test.h"

namespace taxelsim {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kRadius = 0.05;  // m
constexpr int kNumPoints = 360;
constexpr double kRounding = 1e-12;  // relative
// A chord of n per circle is up to r (1 - cos(pi / n)) inside its arc, and up to pi / n away from its tangent.
const double kSagitta = kRadius * (1 - std::cos(kPi / kNumPoints));
const double kTurn = kPi / kNumPoints + kRounding;

SceneObject ring() {
  SceneObject object{.object = Object("ring", Sphere{.radius = kRadius})};
  for (int k = 0; k < kNumPoints; ++k) {
    const double angle = 2 * kPi * k / kNumPoints;
    object.contour.push_back({kRadius * std::cos(angle), kRadius * std::sin(angle), 0.002});
  }
  return object;
}

double lineDifference(double a, double b) {
  return std::abs(std::remainder(a - b, kPi));
}

TEST(TrueEdge, ProjectsADirection) {
  SceneObject bar{.object = Object("bar", Cylinder{.radius = 0.01, .length = 0.1})};
  bar.edge = Vector3{0, 0, 1};
  const TrueEdge edge(bar);
  // Along -y at zero yaw; the angle is that of a line, modulo pi.
  const Quaternion R_before_yaw = axisAngle({1, 0, 0}, kPi / 2);
  for (const double yaw : {-1.2, 0.0, 0.3, 1.5}) {
    const ProjectedEdge projected = edge.project({{1, 2, 3}, axisAngle({0, 0, 1}, yaw) * R_before_yaw});
    EXPECT_NEAR(lineDifference(projected.angle, yaw + kPi / 2), 0, kRounding);
    EXPECT_GT(projected.angle, -kPi / 2);
    EXPECT_LE(projected.angle, kPi / 2);
    EXPECT_TRUE(std::isnan(projected.distance));
  }
  EXPECT_TRUE(std::isnan(edge.project({}).angle));  // perpendicular to the plane
}

TEST(TrueEdge, ProjectsARingContour) {
  const TrueEdge edge(ring());
  const double lap = 2 * kNumPoints * kRadius * std::sin(kPi / kNumPoints);
  EXPECT_NEAR(edge.contourLength(), lap, kRounding);
  for (const double angle : {0.2, 1.7, 3.0, 5.9}) {
    for (const double distance : {-0.01, 0.0, 0.004}) {  // inside, on and outside
      // Origin of S at that angle and distance from the ring, with a yaw of the sensor.
      constexpr double kYaw = 0.4;
      const Pose X_OS{{(kRadius + distance) * std::cos(angle), (kRadius + distance) * std::sin(angle), 0.02}, axisAngle({0, 0, 1}, kYaw)};
      const ProjectedEdge projected = edge.project(inverse(X_OS));
      EXPECT_NEAR(projected.distance, std::abs(distance), kSagitta + kRounding);
      EXPECT_LE(lineDifference(projected.angle, angle + kPi / 2 - kYaw), kTurn);
      EXPECT_NEAR(projected.arc, angle * kRadius, lap / kNumPoints);
      const TrueEdge::ContourPoint point = edge.at(projected.arc);
      EXPECT_NEAR(std::hypot(point.point[0], point.point[1]), kRadius, kSagitta + kRounding);
      EXPECT_EQ(point.point[2], 0.002);
      EXPECT_LE(lineDifference(std::atan2(point.direction[1], point.direction[0]), angle + kPi / 2), kTurn);
    }
  }
  // Ends of the contour.
  EXPECT_NEAR(edge.at(0).point[0], kRadius, kRounding);
  EXPECT_NEAR(edge.at(edge.contourLength()).point[0], kRadius, kRounding);
}

TEST(TrueEdge, EpisodesStartOnTheContour) {
  Scene scene = exampleScene();
  scene.objects = {ring()};
  scene.randomization.tilt = {0, 0};
  const EpisodeDrawer drawer(scene);
  const TrueEdge edge(scene.objects[0]);
  std::vector<double> arcs;
  for (std::uint64_t episode = 0; episode < 200; ++episode) {
    const EpisodeDraw draw = drawer.draw(episode);
    // The distance is at most the random offset, for any yaw.
    const ProjectedEdge projected = edge.project(draw.X_SO);
    EXPECT_LE(projected.distance, std::hypot(scene.randomization.x.max, scene.randomization.y.max) + kRounding);
    EXPECT_NEAR(draw.X_SO.position[2], -0.002, kRounding);  // the contour is at the height of the skin
    arcs.push_back(projected.arc / edge.contourLength());
  }
  std::sort(arcs.begin(), arcs.end());
  // Kolmogorov-Smirnov: 99.9 % quantile 0.138 for 200 uniform numbers; the random offset adds its angle on the ring.
  const double offset = std::hypot(scene.randomization.x.max, scene.randomization.y.max) / kRadius / (2 * kPi);
  for (std::size_t k = 0; k < arcs.size(); ++k) EXPECT_NEAR(arcs[k], static_cast<double>(k) / 200, 0.138 + offset);
}

}  // namespace
}  // namespace taxelsim
