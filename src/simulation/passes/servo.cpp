#include "simulation/passes/servo.h"

#include <algorithm>

#include "servo.spv.h"
#include "simulation/passes/sizes.h"

namespace taxelsim {

void ServoPass::record(Recorder recorder, const Variant& variant) const {
  if (variant.reads_contact_features) {
    recorder.bindings.redirect<block::ServoFeatures, block::ContactFeatures>();
  } else {
    recorder.bindings.redirect<block::ServoFeatures, block::Features>();
  }
  const auto& kernel = kernels_.get(variant, [&] { return makeKernel(variant); });
  recorder.dispatch(kernel, numWorkgroups(recorder.num_instances, gpu::DriverProfile::kIndependentWorkgroup));
}

gpu::PassKernel<ServoInterface> ServoPass::makeKernel(const Variant& variant) const {
  const PackedContactFeatures& packed = model_.packed_contact;
  const auto num_rows = static_cast<std::uint32_t>(numContactRows(packed, static_cast<int>(variant.max_regions)));
  return {model_.context(), "servo", k_servo_spirv,
          commonConstants(model_.sensor, model_.packed, {.workgroup = gpu::DriverProfile::kIndependentWorkgroup}),
          ServoInterface{.CONTROL_PERIOD = variant.control_period,
                         .STARTS_AT_LOAD = variant.starts_at_load,
                         .FEATURE_ROWS = variant.reads_contact_features ? num_rows : 1u,
                         .REGION_ROW = 1 + packed.num_patches,
                         .OBJECT_POSES = variant.object_poses,
                         .SENSOR_POSES = variant.sensor_poses,
                         .ACTIONS = variant.actions,
                         .ROBOT_STATUS = variant.robot_status,
                         .JOINTS = variant.joints && variant.num_joints > 0,
                         .MANIPULATOR = variant.num_joints > 0,
                         .NUM_JOINTS = std::max(variant.num_joints, 1u),
                         .NUM_CHAIN_JOINTS = std::max(variant.num_chain_joints, 1u),
                         .TWIST_ROWS = std::max(variant.num_rows, 1u),
                         .GRAM_SIZE = std::max(std::min(variant.num_rows, variant.num_joints), 1u),
                         .DELAY = variant.delay}};
}

}  // namespace taxelsim
