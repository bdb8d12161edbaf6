// Frames of episodes as bits, to compare runs of the same episodes.
#pragma once

#include "episodes/episode_sink.h"
#include "support/test.h"
#include "taxelsim/environment.h"

namespace taxelsim {

// By episode: the bits of all values of each frame.
using Recording = std::map<std::uint64_t, std::vector<std::vector<std::uint64_t>>>;

// Bits of the rows of one instance.
inline std::vector<std::uint64_t> bitsOf(const EnvironmentView& view, std::size_t i) {
  std::vector<std::uint64_t> bits{std::bit_cast<std::uint64_t>(view.times[i]), view.robot_status[i],
                                  std::bit_cast<std::uint32_t>(view.start_force[i])};
  const std::size_t num_instances = view.active.size();
  const auto add = [&](auto values) {
    const std::size_t width = values.size() / num_instances;
    for (const auto value : values.subspan(i * width, width)) bits.push_back(std::bit_cast<std::uint64_t>(static_cast<double>(value)));
  };
  add(view.frame.tactile_image);
  add(view.frame.total_force);
  add(view.frame.center_of_pressure);
  add(view.frame.edge_angle);
  add(view.frame.ground_truth.contact_wrench);
  add(view.frame.ground_truth.load_offset);
  add(view.joint_positions);
  add(view.joint_velocities);
  for (const std::span<const Pose> poses : {view.X_SO, view.X_WO, view.X_WS}) {
    const std::size_t width = poses.size() / num_instances;
    for (const Pose& pose : poses.subspan(i * width, width)) {
      for (const double value : pose.position) bits.push_back(std::bit_cast<std::uint64_t>(value));
      for (const double value : pose.rotation) bits.push_back(std::bit_cast<std::uint64_t>(value));
    }
  }
  return bits;
}

// Records the episodes 0 to num_episodes - 1 of a slice.
class RecordingSink : public EpisodeSink {
 public:
  RecordingSink(std::uint64_t num_episodes, int num_instances)
      : num_episodes_(num_episodes), episodes_(num_instances), start_forces_(num_instances) {}

  std::optional<std::uint64_t> next(int) override {
    if (next_ == num_episodes_) return {};
    return next_++;
  }
  void begin(int instance, const EpisodeRecord& record) override {
    episodes_[instance] = record.episode;
    start_forces_[instance] = record.start_force;
  }
  void frame(const FrameView& view, const FrameContext& context) override {
    const EnvironmentView all{.frame = view,
                              .active = context.active,
                              .control_due = {},
                              .episodes = {},
                              .frame_numbers = {},
                              .times = context.times,
                              .objects = {},
                              .load_reached = {},
                              .start_force = start_forces_,
                              .X_SO = context.X_SO,
                              .X_WO = context.X_WO,
                              .X_WS = context.X_WS,
                              .joint_positions = context.joint_positions,
                              .joint_velocities = context.joint_velocities,
                              .robot_status = context.robot_status};
    for (std::size_t i = 0; i < episodes_.size(); ++i) {
      if (context.active[i]) recording_[episodes_[i]].push_back(bitsOf(all, i));
    }
  }
  void end(int) override {}

  const Recording& recording() const { return recording_; }

 private:
  std::uint64_t num_episodes_, next_ = 0;
  std::vector<std::uint64_t> episodes_;
  std::vector<float> start_forces_;
  Recording recording_;
};

}  // namespace taxelsim
