#include "episodes/draw.h"

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

int drawObject(EpisodeRandom& random, const std::vector<SceneObject>& objects) {
  double sum = 0;
  for (const SceneObject& object : objects) sum += object.weight;
  double left = random.uniform() * sum;
  int last = 0;  // rounding may leave a little over: it belongs to the last object that can be chosen
  for (int i = 0; i < static_cast<int>(objects.size()); ++i) {
    if (objects[i].weight <= 0) continue;
    last = i;
    if (left < objects[i].weight) break;
    left -= objects[i].weight;
  }
  return last;
}

}  // namespace

EpisodeDrawer::EpisodeDrawer(const Scene& scene) : scene_(scene) {
  lowest_.reserve(scene.objects.size());
  for (const SceneObject& entry : scene.objects) lowest_.emplace_back(entry.object);
}

Vector3 EpisodeDrawer::lowestPointOf(int object, const Quaternion& R_SO, std::uint64_t episode) const {
  try {
    return lowest_[object].find(R_SO);
  } catch (const Error& error) {
    throw Error(error.kind(), scene_.file.string() + ": episode " + std::to_string(episode) + ": " + error.what());
  }
}

EpisodeDraw EpisodeDrawer::draw(std::uint64_t episode) const {
  const Randomisation& ranges = scene_.randomisation;
  EpisodeRandom random(scene_.seed, episode);
  EpisodeDraw drawn;

  drawn.object = drawObject(random, scene_.objects);
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

  if (drawn.load_driven) {
    drawn.load = static_cast<float>(load_or_depth);
  } else {
    drawn.depth = load_or_depth;
  }

  const Vector3 tilt_axis{std::cos(tilt_direction), std::sin(tilt_direction), 0};
  drawn.X_SO.rotation = axisAngle({0, 0, 1}, yaw) * (axisAngle(tilt_axis, tilt) * scene_.objects[drawn.object].orientation);
  const Vector3 lowest = rotate(drawn.X_SO.rotation, lowestPointOf(drawn.object, drawn.X_SO.rotation, episode));
  drawn.X_SO.position = {x - lowest[0], y - lowest[1], -drawn.depth - lowest[2]};
  return drawn;
}

}  // namespace taxelsim
