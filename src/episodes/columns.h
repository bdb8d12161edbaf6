// The columns of a data set and where each one's values come from: the one table that the schema and the recorder share.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "taxelsim/dataset.h"
#include "taxelsim/scene.h"
#include "taxelsim/simulator.h"

namespace taxelsim {

// One value per frame and instance.
struct FrameColumn {
  enum class Source { kTime, kImage, kFloats, kPose, kSensorPose, kAction, kJointPosition, kJointVelocity, kRobotStatus };

  Column column;
  Source source = Source::kFloats;
  std::span<const float> (*floats)(const FrameView&) = nullptr;  // of kFloats: (N x row)
};

// What is known of an episode once its first frame has been read.
struct EpisodeRecord {
  std::uint64_t episode = 0;
  std::int32_t object = 0;
  float load = 0;
  std::int32_t load_driven = 0;
  float depth = 0;
  std::int32_t load_reached = 0;
  float gain = 1, gain_spread = 0, noise = 0;
};

// One value per episode: `size` bytes at `offset` of EpisodeRecord.
struct EpisodeColumn {
  Column column;
  std::size_t offset = 0;
};

struct ColumnPlan {
  std::vector<FrameColumn> frame;      // first in file order
  std::vector<EpisodeColumn> episode;  // then these
  OutputOptions outputs;               // what the simulator must give back
  int max_regions = 0;                 // in its contact features
};

// Throws Error(kInput) for a name in scene.record that is none of the groups.
ColumnPlan planColumns(const Scene& scene);

// Bytes of one row.
std::size_t rowBytes(const Column& column);

// Frames of every episode.
int numFrames(const Scene& scene);

}  // namespace taxelsim
