// A synthetic data set of a bar that rotates on a 6 x 14 pad, for inspect and render.
#pragma once

#include "support/test.h"
#include "taxelsim/dataset.h"

namespace taxelsim::testing {

struct PadOptions {
  bool features = true;  // record features in addition to the image
  bool one_grid = true;  // else the image is a plain list of taxels
  std::uint64_t num_episodes = 5;
  std::string bar_name = "bar";  // of the object of even episodes, at most four bytes
};

// Three frames per episode, two episodes per shard.
void writePressedPad(const std::filesystem::path& directory, const PadOptions& options = {});

}  // namespace taxelsim::testing
