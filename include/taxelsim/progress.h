/// @file
/// Progress of a run over many episodes.
#pragma once

#include <cstdint>

namespace taxelsim {

/// Progress of generate() or evaluate().
struct Progress {
  std::uint64_t episodes_done = 0;     ///< Episodes simulated or found on disk.
  std::uint64_t num_episodes = 0;      ///< Episodes of the whole run.
  std::uint64_t frames_done = 0;       ///< Frames simulated in this run, without those found on disk.
  std::uint64_t num_frames = 0;        ///< Frames of the whole run, without those found on disk.
  std::uint64_t episodes_resumed = 0;  ///< Episodes found on disk.
  double seconds = 0;                  ///< s since this run began simulating.
};

}  // namespace taxelsim
