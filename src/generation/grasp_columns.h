// The columns of a data set of kind grasp: those of all sensors, grouped by the sensor's name, then those of joints, objects and episodes.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "episodes/grasp_batch.h"
#include "generation/columns.h"
#include "taxelsim/dataset.h"
#include "taxelsim/scene.h"

namespace taxelsim {

// Names of the sensors of a robot: "palm, thumb".
std::string sensorNames(const Grasp& grasp);

// The columns of one sensor, with the names that they have in a scene of that sensor alone.
ColumnPlan planSensorColumns(const Scene& scene, const RobotSensor& sensor);

// Columns of a data set of the scene, in file order.
std::vector<Column> graspColumns(const Scene& scene);

// Copies frames of a GraspBatch into the columns of a shard.
class GraspRecorder {
 public:
  // `scene` must outlive this.
  explicit GraspRecorder(const Scene& scene);

  // The first `count` instances. columns (graspColumns().size()): first byte of each. rows (count): frame row of each instance.
  void recordFrames(const GraspBatch& batch, int count, std::span<std::byte* const> columns, std::span<const std::uint64_t> rows) const;
  // first_row: episode row of the first of `episodes`, which the first instances have.
  void recordEpisodes(const GraspBatch& batch, std::span<const std::uint64_t> episodes, std::span<std::byte* const> columns,
                      std::uint64_t first_row) const;

 private:
  const Scene& scene_;
  std::vector<ColumnPlan> sensors_;
};

}  // namespace taxelsim
