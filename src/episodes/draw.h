// What is random about an episode: drawn from (seed, episode) alone, so that batch, slot and order never show.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "episodes/lowest_vertex.h"
#include "episodes/true_edge.h"
#include "taxelsim/scene.h"
#include "taxelsim/simulator.h"

namespace taxelsim {

// Frames of every episode.
int numFrames(const Scene& scene);

// Sensors of every robot, all of the scene's kind.
int numSensors(const Scene& scene);

// Rows for regions in the contact features: what is recorded, or what a controller looks at.
int numRegions(const Scene& scene);

struct EpisodeDraw {
  int object = 0;  // index into the scene's objects
  Pose X_SO;       // at the start: the object's anchor or lowest point at (x, y, 0), or at (x, y, -depth) when depth-driven
  bool load_driven = false;
  float load = 0;    // N, when load-driven
  double depth = 0;  // m, of the lowest point; 0 when load-driven
  ReadoutVariation variation;
  int controller = 0;  // index into the scene's controllers
  std::optional<double> exploration_velocity;
  double linear_action_noise = 0, angular_action_noise = 0;
};

class EpisodeDrawer {
 public:
  // `scene` must outlive this.
  explicit EpisodeDrawer(const Scene& scene);

  // Draws, in this order: object, x, y, yaw, direction of the tilt axis, tilt, load or depth, gain, gain spread, noise,
  // controller, exploration velocity, linear and angular action noise, place on the contour. A new draw goes to
  // the end, so that old data sets can be made again. Throws Error(kInput) when the object has no lowest point in the orientation drawn.
  EpisodeDraw draw(std::uint64_t episode) const;

 private:
  Vector3 anchorOf(int object, const Quaternion& R_SO, std::uint64_t episode) const;

  const Scene& scene_;
  // Of each object.
  std::vector<LowestVertex> lowest_;
  std::vector<TrueEdge> edges_;
};

}  // namespace taxelsim
