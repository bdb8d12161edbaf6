// Closed loops of tactile servos, shaders/servo.comp: features -> twists -> joints -> poses of sensors and objects.
#pragma once

#include "simulation/model_data.h"
#include "simulation/passes/interfaces.h"
#include "simulation/passes/kernel_cache.h"
#include "simulation/passes/recorder.h"

namespace taxelsim {

class ServoPass {
 public:
  explicit ServoPass(const ModelData& model) : model_(model) {}

  struct Variant {
    std::uint32_t control_period = 1;  // frames
    bool starts_at_load = false;
    bool reads_contact_features = false;
    std::uint32_t max_regions = 0;  // rows of contact features
    bool object_poses = false, sensor_poses = false, actions = false, robot_status = false, joints = false;
    // Of a manipulator; 0 for free-flying sensors.
    std::uint32_t num_joints = 0, num_chain_joints = 0, num_rows = 0, delay = 0;

    auto operator<=>(const Variant&) const = default;  // NOLINT(modernize-use-nullptr): clang-tidy 14 misreads it
  };

  // After the features of the frame.
  void record(Recorder recorder, const Variant& variant) const;

 private:
  gpu::PassKernel<ServoInterface> makeKernel(const Variant& variant) const;

  const ModelData& model_;
  KernelCache<Variant, gpu::PassKernel<ServoInterface>> kernels_;
};

}  // namespace taxelsim
