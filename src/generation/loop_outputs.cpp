#include "generation/loop_outputs.h"

#include "episodes/task_judge.h"

namespace taxelsim {

LoopOutputs loopOutputsOf(const Scene& scene, const ColumnPlan& columns) {
  using Source = FrameColumn::Source;
  LoopOutputs reads{
      .tactile_image = false, .object_poses = false, .sensor_poses = false, .actions = false, .robot_status = false, .joints = false};
  if (scene.task) reads = TaskJudge::kReads;
  for (const FrameColumn& column : columns.frame) {
    reads.tactile_image |= column.source == Source::kImage;
    reads.object_poses |= column.source == Source::kExactEdge || column.source == Source::kPose;
    reads.sensor_poses |= column.source == Source::kSensorPose;
    reads.actions |= column.source == Source::kAction || column.source == Source::kControllerAction;
    reads.robot_status |= column.source == Source::kRobotStatus;
    reads.joints |= column.source == Source::kJointPosition || column.source == Source::kJointVelocity;
  }
  return reads;
}

}  // namespace taxelsim
