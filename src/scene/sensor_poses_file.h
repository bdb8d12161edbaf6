// Poses of a sensor that moves through the world, by episode and step of recorded contact points.
#pragma once

#include <cstdint>
#include <filesystem>
#include <utility>
#include <vector>

#include "scene/csv_reader.h"
#include "taxelsim/pose.h"

namespace taxelsim {

class SensorPoses {
 public:
  // Reads a CSV file (docs/reference/scene_file.md). max_episode, max_step: largest numbers allowed. Throws Error(kInput) with file, line,
  // column, the value found and what is allowed.
  SensorPoses(const std::filesystem::path& file, std::uint64_t max_episode, std::uint64_t max_step);

  // X_WS of the latest row of the episode at or before the step; null if there is none.
  const Pose* find(std::uint64_t episode, std::uint64_t step) const;

 private:
  using Frame = std::pair<std::uint64_t, std::uint64_t>;  // episode, step

  std::vector<std::pair<Frame, Pose>> rows_;  // ascending
};

}  // namespace taxelsim
