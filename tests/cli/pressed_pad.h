// A data set of a bar turning on a 6 x 14 pad, made up by a formula: something for inspect and render to look at.
#pragma once

#include <filesystem>

#include "taxelsim/dataset.h"

namespace taxelsim::testing {

struct PadOptions {
  bool features = true;  // record features beside the image
  bool one_grid = true;  // else the image is a plain list of taxels
  std::uint64_t num_episodes = 5;
};

// Three frames an episode, two episodes a shard.
void writePressedPad(const std::filesystem::path& directory, const PadOptions& options = {});

}  // namespace taxelsim::testing
