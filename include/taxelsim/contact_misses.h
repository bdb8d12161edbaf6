/// @file
/// Episodes in which a sensor touched nothing: often the sign of a wrong unit, pose or direction.
#pragma once

#include <cstdint>
#include <limits>

namespace taxelsim {

/// Episodes of one sensor in which it touched nothing. Those whose load was out of reach are left out: LoadMisses counts them.
struct ContactMisses {
  std::uint64_t num_episodes = 0;  ///< Episodes that were simulated.
  std::uint64_t num_misses = 0;    ///< Those without contact in any frame.
  /// m, least distance of an object from the taxels over the misses, a lower bound by bounding boxes: over the frames in a scene of kind
  /// grasp, at the start in others. Of contact points: over the frames. Infinite without misses.
  double nearest = std::numeric_limits<double>::infinity();
};

}  // namespace taxelsim
