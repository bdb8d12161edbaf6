#include "episodes/contact_misses.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "base/log.h"
#include "base/text.h"

namespace taxelsim {
namespace {

std::string textOf(const ContactMisses& misses, const char* distance) {
  char text[160];
  std::snprintf(text, sizeof text, "no contact in %llu of %llu episodes, %s %.2g m", static_cast<unsigned long long>(misses.num_misses),
                static_cast<unsigned long long>(misses.num_episodes), distance, misses.nearest);
  return text;
}

// What to look at first.
const char* adviceFor(const Scene& scene) {
  if (scene.kind == Scene::Kind::kGrasp) return "check poses, their units, and the signs of closing velocities";
  if (scene.kind == Scene::Kind::kContactPoints) return "check the frame and the unit of the points";
  return scene.randomization.load ? "check the load, which is 0 N in them" : "check the depth, and the units of poses";
}

}  // namespace

// m; infinite for a recorded episode without points.
double ContactMissCounter::nearestStart(std::uint64_t episode) const {
  if (!plan_.scene.contact_points) {
    const EpisodeDraw draw = plan_.drawer.draw(episode);
    return clearance_.of(static_cast<std::size_t>(draw.object), draw.X_SO);
  }
  double nearest = std::numeric_limits<double>::infinity();
  for (int frame = 0; frame < plan_.num_frames; ++frame) {
    for (const ContactPoint& point : plan_.scene.contact_points->pointsOf(episode, frame))
      nearest = std::min(nearest, clearance_.of(point.position));
  }
  return nearest;
}

void ContactMissCounter::add(std::uint64_t episode, bool touched) {
  ++misses_.num_episodes;
  if (touched) return;
  const double nearest = nearestStart(episode);
  if (std::isinf(nearest)) return;
  ++misses_.num_misses;
  misses_.nearest = std::min(misses_.nearest, nearest);
}

void add(ContactMisses& sum, const ContactMisses& more) {
  sum.num_episodes += more.num_episodes;
  sum.num_misses += more.num_misses;
  sum.nearest = std::min(sum.nearest, more.nearest);
}

void warnOfContactMisses(const Scene& scene, std::span<const ContactMisses> all, std::span<const std::string> names) {
  const char* const distance = scene.kind == Scene::Kind::kGrasp           ? "nearest approach"
                               : scene.kind == Scene::Kind::kContactPoints ? "nearest point"
                                                                           : "nearest start";
  const auto nameOf = [&](std::size_t k) {
    if (scene.grasp) return "finger " + scene.grasp->sensors[static_cast<std::size_t>(scene.grasp->fingers[k].sensor)].name + ": ";
    return names.empty() ? std::string() : names[k] + ": ";
  };
  std::string text;
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (all[k].num_misses > 0) text += (text.empty() ? "" : "; ") + nameOf(k) + textOf(all[k], distance);
  }
  if (!text.empty()) logWarning(oneLine(scene.file.generic_string() + ": " + text + "; " + adviceFor(scene)));
}

}  // namespace taxelsim
