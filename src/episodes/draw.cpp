#include "episodes/draw.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "base/philox.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

double drawRange(EpisodeRandom& random, const Range& range) {
  return random.uniform(range.min, range.max);
}

// Index drawn with probability proportional to its weight.
template <typename T>
int drawWeighted(EpisodeRandom& random, const std::vector<T>& choices) {
  double sum = 0;
  for (const T& choice : choices) sum += choice.weight;
  double left = random.uniform() * sum;
  int last = 0;  // the last index with a positive weight takes what rounding leaves over
  for (int i = 0; i < static_cast<int>(choices.size()); ++i) {
    if (choices[i].weight <= 0) continue;
    last = i;
    if (left < choices[i].weight) break;
    left -= choices[i].weight;
  }
  return last;
}

}  // namespace

int numFrames(const Scene& scene) {
  return scene.kind == Scene::Kind::kContacts ? 1 : scene.num_steps;
}

int numSensors(const Scene& scene) {
  const auto* manipulator = std::get_if<Manipulator>(&scene.robot);
  return manipulator ? static_cast<int>(manipulator->sensors.size()) : 1;
}

int numJoints(const Scene& scene) {
  const auto* manipulator = std::get_if<Manipulator>(&scene.robot);
  return manipulator ? static_cast<int>(manipulator->joints.size()) : 0;
}

int numRegions(const Scene& scene) {
  const auto readsRegion = [](const TactileServo& servo) { return servo.contact == ServoContact::kLargestRegion; };
  bool is_controlled = scene.grasp && scene.grasp->servo && readsRegion(scene.grasp->servo->servo);
  if (scene.kind == Scene::Kind::kServo) {
    is_controlled = std::any_of(scene.controllers.begin(), scene.controllers.end(),
                                [&](const SceneController& controller) { return readsRegion(controller.servo); });
  }
  return std::max(scene.max_regions, is_controlled ? 1 : 0);
}

Pose poseOf(const Mounting& mounting) {
  const Quaternion rotation =
      axisAngle({0, 0, 1}, mounting.yaw) * axisAngle({0, 1, 0}, mounting.pitch) * axisAngle({1, 0, 0}, mounting.roll);
  return {{mounting.x, mounting.y, 0}, rotation};
}

EpisodeDrawer::EpisodeDrawer(const Scene& scene) : scene_(scene) {
  lowest_.reserve(scene.objects.size());
  for (const SceneObject& entry : scene.objects) {
    lowest_.emplace_back(entry.object);
    edges_.emplace_back(entry);
  }
}

// Point in O that is placed at (x, y).
Vector3 EpisodeDrawer::anchorOf(int object, const Quaternion& R_SO, std::uint64_t episode) const {
  if (scene_.objects[object].anchor) return *scene_.objects[object].anchor;
  try {
    return lowest_[object].find(R_SO);
  } catch (const Error& error) {
    throw Error(error.kind(), scene_.file.string() + ": episode " + std::to_string(episode) + ": " + error.what());
  }
}

EpisodeDraw EpisodeDrawer::draw(std::uint64_t episode) const {
  const Randomization& ranges = scene_.randomization;
  EpisodeRandom random(scene_.seed, episode);
  EpisodeDraw drawn;

  drawn.object = drawWeighted(random, scene_.objects);
  const double x = drawRange(random, ranges.x);
  const double y = drawRange(random, ranges.y);
  const double yaw = drawRange(random, ranges.yaw);
  const double tilt_direction = random.uniform(0, 2 * std::numbers::pi);
  const double tilt = drawRange(random, ranges.tilt);
  drawn.load_driven = ranges.load.has_value();
  const double load_or_depth = drawRange(random, drawn.load_driven ? *ranges.load : ranges.depth.value_or(Range{}));
  drawn.variation.gain = static_cast<float>(drawRange(random, ranges.gain));
  drawn.variation.gain_spread = static_cast<float>(drawRange(random, ranges.gain_spread));
  drawn.variation.noise = static_cast<float>(drawRange(random, ranges.noise));
  drawn.controller = drawWeighted(random, scene_.controllers);
  const double exploration_velocity = drawRange(random, ranges.exploration_velocity.value_or(Range{}));
  if (ranges.exploration_velocity) drawn.exploration_velocity = exploration_velocity;
  drawn.linear_action_noise = drawRange(random, ranges.linear_action_noise);
  drawn.angular_action_noise = drawRange(random, ranges.angular_action_noise);

  if (drawn.load_driven) {
    drawn.load = static_cast<float>(load_or_depth);
  } else {
    drawn.depth = load_or_depth;
  }

  const double along_contour = random.uniform();
  for (const SkinRange& entry : kSkinRanges) {
    if (const std::optional<Range>& range = ranges.*entry.range) drawn.skin.*entry.value = static_cast<float>(drawRange(random, *range));
  }
  for (const MountingRange& entry : kMountingRanges) {
    if (const std::optional<Range>& range = ranges.*entry.range)
      drawn.mounting.*entry.value = static_cast<float>(drawRange(random, *range));
  }

  if (scene_.objects.empty()) {
    drawn.object = kNoObject;
    return drawn;
  }
  const Vector3 tilt_axis{std::cos(tilt_direction), std::sin(tilt_direction), 0};
  const Quaternion R_before_yaw = axisAngle(tilt_axis, tilt) * scene_.objects[drawn.object].orientation;
  const TrueEdge& edge = edges_[drawn.object];
  Vector3 anchor;
  if (edge.contourLength() > 0) {
    // At zero yaw the contour is parallel to x at the drawn position.
    const TrueEdge::ContourPoint position = edge.at(along_contour * edge.contourLength());
    const Vector3 direction = rotate(R_before_yaw, position.direction);
    drawn.X_SO.rotation = axisAngle({0, 0, 1}, yaw - std::atan2(direction[1], direction[0])) * R_before_yaw;
    anchor = position.point;
  } else {
    drawn.X_SO.rotation = axisAngle({0, 0, 1}, yaw) * R_before_yaw;
    anchor = anchorOf(drawn.object, drawn.X_SO.rotation, episode);
  }
  const Vector3 anchor_S = rotate(drawn.X_SO.rotation, anchor);
  drawn.X_SO.position = {x - anchor_S[0], y - anchor_S[1], -drawn.depth - anchor_S[2]};
  return drawn;
}

}  // namespace taxelsim
