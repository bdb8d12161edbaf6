// The columns of a data set and where each one's values come from: the one table that the schema and the recorder share.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "episodes/episode_sink.h"
#include "taxelsim/dataset.h"
#include "taxelsim/scene.h"
#include "taxelsim/simulator.h"

namespace taxelsim {

// One value per frame and instance.
struct FrameColumn {
  enum class Source {
    kTime,
    kImage,
    kFloats,
    kPose,
    kSensorPose,
    kAction,
    kControllerAction,
    kJointPosition,
    kJointVelocity,
    kRobotStatus
  };

  Column column;
  Source source = Source::kFloats;
  std::span<const float> (*floats)(const FrameView&) = nullptr;  // of kFloats: (N x row)
};

// One value per episode, at `offset` of EpisodeRecord.
struct EpisodeColumn {
  Column column;
  std::size_t offset = 0;
};

struct ColumnPlan {
  std::vector<FrameColumn> frame;      // first in file order
  std::vector<EpisodeColumn> episode;  // then these
};

// Throws Error(kInput) for a name in scene.record that is none of the groups.
ColumnPlan planColumns(const Scene& scene);

// Bytes of one row.
std::size_t rowBytes(const Column& column);

// What a simulator must give back for them.
OutputOptions outputsOf(const Scene& scene);

}  // namespace taxelsim
