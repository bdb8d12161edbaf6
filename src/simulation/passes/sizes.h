// How the work of a pass is divided into workgroups.
#pragma once

#include <cstdint>

#include "gpu/driver_profile.h"
#include "simulation/pack/pack_sensor.h"
#include "simulation/passes/interfaces.h"
#include "taxelsim/sensor.h"

namespace taxelsim {

// Items that an invocation or team does in sequence on a software driver, at most.
inline constexpr std::uint32_t kMaxRepeat = 16;
// The same for tiles of several patches, most of which no object reaches.
inline constexpr std::uint32_t kMaxTileRepeat = 64;

struct PassSizes {
  std::uint32_t workgroup = 0;  // invocations
  std::uint32_t lanes = 1;      // partial sums of a reduction
  std::uint32_t repeat = 1;     // items in sequence
};

// Sizes from ModelOptions or Tuning: `chosen` where `wanted` is 0. Throws Error(kInput), naming the option, for a value that is not a power
// of two from `min` to `max`.
std::uint32_t tunedSize(int wanted, std::uint32_t chosen, std::uint32_t min, std::uint32_t max, const char* name);

// Invocations per workgroup, 4 to 256; `iterations`: of one invocation alone. Throws Error(kInput) as above.
std::uint32_t tunedWorkgroup(int wanted, const gpu::DriverProfile& profile, std::uint64_t iterations, const char* name);

// Items in sequence: any number from 1 to kMaxTileRepeat. Throws Error(kInput).
std::uint32_t tunedRepeat(int wanted, std::uint32_t chosen, const char* name);

// Sizes of a pass in which a team of invocations shares an item.
struct TeamSizes {
  PassSizes pass;
  std::uint32_t team = 1;  // invocations

  std::uint32_t itemsPerWorkgroup() const { return pass.workgroup / team * pass.repeat; }
  // Partial sums in shared memory, `num_sums` per lane of every team; one word where a team is one invocation and needs none.
  std::uint32_t numPartials(std::uint32_t num_sums) const { return team == 1 ? 1 : pass.workgroup / team * num_sums * pass.lanes; }
};

// `wanted_workgroup`: ModelOptions::image_workgroup; `iterations`: of one invocation alone per item; `max_team`: a power of two. Throws
// Error(kInput).
TeamSizes teamSizes(int wanted_workgroup, const gpu::DriverProfile& profile, std::uint64_t iterations, std::uint32_t lanes,
                    std::uint32_t max_team);

CommonConstants commonConstants(const Sensor& sensor, const PackedSensor& packed, const PassSizes& sizes);

}  // namespace taxelsim
