// The public view of a batch of episodes.
#pragma once

#include "episodes/episode_batch.h"
#include "taxelsim/environment.h"

namespace taxelsim {

// Spans into the batch, valid until its next frame.
inline EnvironmentView viewOf(const EpisodeBatch& batch) {
  return {.frame = batch.frame(),
          .active = batch.active(),
          .control_due = batch.controlDue(),
          .episodes = batch.episodes(),
          .frame_numbers = batch.frameNumbers(),
          .times = batch.times(),
          .objects = batch.objects(),
          .load_reached = batch.loadReached(),
          .start_force = batch.startForces(),
          .X_SO = batch.X_SO(),
          .X_WO = batch.X_WO(),
          .X_WS = batch.robots().X_WS(),
          .joint_positions = batch.robots().jointPositions(),
          .joint_velocities = batch.robots().jointVelocities(),
          .robot_status = batch.robots().status()};
}

}  // namespace taxelsim
