// How far a run over many episodes is.
#pragma once

#include <cstdint>

namespace taxelsim {

struct Progress {
  std::uint64_t episodes_done = 0;
  std::uint64_t num_episodes = 0;
  std::uint64_t frames_done = 0;       // in this run
  std::uint64_t episodes_resumed = 0;  // found on disk
  double seconds = 0;                  // since this run began simulating
};

}  // namespace taxelsim
