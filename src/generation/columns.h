// The columns of a data set and the sources of their values, for schema and recorder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "episodes/episode_sink.h"
#include "simulation/feature_table.h"
#include "taxelsim/dataset.h"
#include "taxelsim/scene.h"
#include "taxelsim/simulator.h"

namespace taxelsim {

// One value per frame and instance.
struct FrameColumn {
  enum class Source {
    kTime,
    kImage,
    kFeature,
    kExactEdge,       // the column after it is kExactEdgeKnown
    kExactEdgeKnown,  // written with kExactEdge
    kPose,
    kSensorPose,
    kAction,
    kControllerAction,
    kJointPosition,
    kJointVelocity,
    kRobotStatus
  };

  Column column;
  Source source = Source::kFeature;
  std::function<FeatureValues(const FrameView&)> values{};  // kFeature only: (N x row)
};

// Values of a finished episode.
struct EpisodeValues {
  EpisodeRecord record;
  bool success = false;  // of the task
};

// One value per episode.
struct EpisodeColumn {
  Column column;
  std::function<void(const EpisodeValues&, std::byte* row)> write;
};

struct ColumnPlan {
  std::vector<FrameColumn> frame;      // first in file order
  std::vector<EpisodeColumn> episode;  // then these

  std::vector<Column> columns() const;  // all, in file order
};

// The scene is of another kind than grasp. Throws Error(kInput) if scene.record has a name that is not a group of columns.
ColumnPlan planColumns(const Scene& scene);

// Bytes of one row.
std::size_t rowBytes(const Column& column);

// The simulator outputs that the columns need.
OutputOptions outputsOf(const Scene& scene);

}  // namespace taxelsim
