// What commands the robots of a slice: the scene's servos, or a policy of the caller.
#pragma once

#include "episodes/episode_batch.h"

namespace taxelsim {

class Controller {
 public:
  virtual ~Controller() = default;

  // An episode has started on an instance.
  virtual void start(int instance, const EpisodeDraw& draw) = 0;
  // Commands the instances whose control tick is due, by batch.act().
  virtual void command(EpisodeBatch& batch) = 0;
  // Sets the constants of an instance's episode that depend on the controller.
  virtual void describe(int instance, EpisodeRecord& record) const = 0;
};

}  // namespace taxelsim
