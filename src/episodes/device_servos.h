// Servos whose loop the device closes: simulation/servo_loop.h.
#pragma once

#include <optional>
#include <string_view>
#include <vector>

#include "episodes/slice.h"
#include "simulation/servo_loop.h"

namespace taxelsim {

// Why the host must close the loops of a run; empty if a device with 64-bit floating point can.
std::string_view whyOnHost(const SlicePlan& plan);

// The robot and its state at the start of an episode; empty for free-flying sensors.
std::optional<LoopRobot> loopRobotOf(const Robot& robot);

// Starts the loops of a batch and describes them; the device commands.
class DeviceServoController : public Controller {
 public:
  // All references must outlive this.
  DeviceServoController(const ServoPlan& servos, const EpisodePlan& episodes, ServoLoop& loop);

  void start(int instance, const EpisodeDraw& draw) override;
  void command(EpisodeBatch&) override {}
  void describe(int instance, EpisodeRecord& record) const override;

 private:
  const ServoPlan& servos_;
  const Scene& scene_;
  ServoLoop& loop_;

  // (num_instances)
  std::vector<LoopStart> starts_;
};

}  // namespace taxelsim
