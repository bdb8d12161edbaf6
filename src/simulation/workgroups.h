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

// `wanted`: by the caller, 0 for none. `work`: turns that one invocation alone would take, at the most usual. Throws Error(kInput).
std::uint32_t chooseWorkgroup(int wanted, const DeviceInfo& info, std::uint32_t on_gpu, std::uint64_t work, const char* name);

// How many pieces of work, of so many turns for an invocation, are done one after another.
std::uint32_t chooseRepeat(const DeviceInfo& info, std::uint64_t turns, std::uint32_t most = kMaxRepeat);

// A specialization constant.
inline std::uint32_t bits(double value) {
  return std::bit_cast<std::uint32_t>(static_cast<float>(value));
}

}  // namespace taxelsim
