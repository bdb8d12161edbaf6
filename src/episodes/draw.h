// Episode draw: the random initial conditions of an episode.
//
// Random numbers are counter-based (base/philox.h: Salmon, Moraes, Dror and Shaw, SC 2011). The n-th number of an episode is a pure
// function of (seed, episode, n), so a draw does not depend on batch size, slice, instance, thread or on which episodes were drawn before.
// The order of the draws is part of the data set format: see EpisodeDrawer::draw().
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "episodes/lowest_vertex.h"
#include "episodes/true_edge.h"
#include "scene/skin_ranges.h"
#include "taxelsim/scene.h"
#include "taxelsim/simulator.h"

namespace taxelsim {

// Frames per episode.
int numFrames(const Scene& scene);

// Sensors per robot. All have the sensor model of the scene.
int numSensors(const Scene& scene);

// Joints per robot; 0 for FreeFlying.
int numJoints(const Scene& scene);

// Region rows of the contact features: as many as the scene records, at least 1 if a controller uses the largest region.
int numRegions(const Scene& scene);

struct EpisodeDraw {
  int object = 0;  // index into the scene's objects; kNoObject if it has none
  Pose X_SO;       // initial pose: the object's anchor or lowest point is at (x, y, 0), or at (x, y, -depth) if depth-driven
  bool load_driven = false;
  float load = 0;    // N; 0 if depth-driven
  double depth = 0;  // m, of the lowest point; 0 if load-driven
  ReadoutVariation variation;
  SkinVariation skin = {};
  Mounting mounting = {};
  int controller = 0;                                        // index into the scene's controllers
  std::optional<double> exploration_velocity;                // m/s; empty: the controller's own
  double linear_action_noise = 0, angular_action_noise = 0;  // m/s and rad/s, standard deviation per component
};

// X_NS of a mounting.
Pose poseOf(const Mounting& mounting);

// Thread-safe: draw() is const and has no state.
class EpisodeDrawer {
 public:
  // `scene` must outlive this.
  explicit EpisodeDrawer(const Scene& scene);

  // Draws in this order: object, x, y, yaw, direction of the tilt axis, tilt, load or depth, gain, gain spread, noise, controller,
  // exploration velocity, linear and angular action noise, position on the contour, factors of the skin, mounting. New draws are appended,
  // so that existing data sets can be reproduced. Without objects X_SO is the identity. Throws Error(kInput) if the object has no lowest
  // point in its orientation.
  EpisodeDraw draw(std::uint64_t episode) const;

 private:
  Vector3 anchorOf(int object, const Quaternion& R_SO, std::uint64_t episode) const;

  const Scene& scene_;
  std::vector<LowestVertex> lowest_;  // (num_objects)
  std::vector<TrueEdge> edges_;       // (num_objects)
};

}  // namespace taxelsim
