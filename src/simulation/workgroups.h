// How work is cut into workgroups, by what a device is good at.
#pragma once

#include <bit>
#include <cstdint>

#include "taxelsim/device.h"

namespace taxelsim {

// Turns of loops that an invocation may take on a software driver: Mesa's ends them all after 65,535. Leaves room for what the estimates
// miss; passes report when it was not enough.
inline constexpr std::uint64_t kMaxTurns = 20000;

// Starting a workgroup on a software driver costs 1 to 3 us, so one does the work of many; on a GPU each is wanted for itself.
inline constexpr std::uint32_t kMaxRepeat = 16;
// Of tiles of several patches, most of which objects do not reach.
inline constexpr std::uint32_t kMaxTileRepeat = 64;
// Groups of clusters that the contact pass culls between two barriers.
inline constexpr std::uint32_t kFewestGroupsPerBatch = 16;
inline constexpr std::uint32_t kMostGroupsPerBatch = 128;

// `wanted`: by the caller, 0 for none. `work`: turns that one invocation alone would take, at the most usual. Throws Error(kInput).
std::uint32_t chooseWorkgroup(int wanted, const DeviceInfo& info, std::uint32_t on_gpu, std::uint64_t work, const char* name);

// Whether a workgroup's invocations are one vector that goes step by step: Mesa's software driver computes a subgroup's lanes by the same
// instructions.
bool isOneVector(const DeviceInfo& info, std::uint32_t workgroup);

// How many pieces of work, of so many turns for an invocation, are done one after another.
std::uint32_t chooseRepeat(const DeviceInfo& info, std::uint64_t turns, std::uint32_t most = kMaxRepeat);

// Sizes of ModelOptions and of Tuning: `chosen` where the caller wants none. Throws Error(kInput) for one that is no power of two from
// `least` to `most`.
std::uint32_t tunedSize(int wanted, std::uint32_t chosen, std::uint32_t least, std::uint32_t most, const char* name);

// The same of repeats: any number from 1 to kMaxTileRepeat.
std::uint32_t tunedRepeat(int wanted, std::uint32_t chosen, const char* name);

// Samples that a tile of the contact pass may have on this device.
std::uint32_t mostTileSamples(const DeviceInfo& info);

// Groups of clusters that the contact pass culls between two barriers. `most_groups`: of any mesh.
std::uint32_t chooseGroupsPerBatch(const DeviceInfo& info, std::uint32_t tile_samples, std::uint32_t most_groups);

// Throws Error(kInput) where a tuning's lists of groups and tiles do not fit into the device's shared memory beside the tile.
void checkContactFits(const DeviceInfo& info, std::uint32_t tile_samples, std::uint32_t groups, std::uint32_t repeat);

// Partial sums of the image pass: those of shaders/image.comp for every lane of every team, none (one word) where a team is one invocation.
std::uint32_t imagePartials(std::uint32_t workgroup, std::uint32_t team, std::uint32_t lanes);

// Throws Error(kInput) where a tuning's teams are so small that their partial sums do not fit into the device's shared memory.
void checkImageFits(const DeviceInfo& info, std::uint32_t workgroup, std::uint32_t team, std::uint32_t partials);

// A specialization constant.
inline std::uint32_t bits(double value) {
  return std::bit_cast<std::uint32_t>(static_cast<float>(value));
}

}  // namespace taxelsim
