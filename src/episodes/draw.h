// What is random about an episode: drawn from (seed, episode) alone, so that batch, slot and order never show.
#pragma once

#include <cstdint>
#include <vector>

#include "episodes/lowest_vertex.h"
#include "taxelsim/scene.h"
#include "taxelsim/simulator.h"

namespace taxelsim {

struct EpisodeDraw {
  int object = 0;  // index into the scene's objects
  Pose X_SO;       // at the start: the object's lowest point at (x, y, 0), or at (x, y, -depth) when depth-driven
  bool load_driven = false;
  float load = 0;    // N, when load-driven
  double depth = 0;  // m, of the lowest point; 0 when load-driven
  ReadoutVariation variation;
};

class EpisodeDrawer {
 public:
  // `scene` must outlive this.
  explicit EpisodeDrawer(const Scene& scene);

  // Draws, in this order: object, x, y, yaw, direction of the tilt axis, tilt, load or depth, gain, gain spread, noise. A new draw goes to
  // the end, so that old data sets can be made again. Throws Error(kInput) when the object has no lowest point in the orientation drawn.
  EpisodeDraw draw(std::uint64_t episode) const;

 private:
  Vector3 lowestPointOf(int object, const Quaternion& R_SO, std::uint64_t episode) const;

  const Scene& scene_;
  std::vector<LowestVertex> lowest_;  // of each object
};

}  // namespace taxelsim
