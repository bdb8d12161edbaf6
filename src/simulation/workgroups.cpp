#include "simulation/workgroups.h"

#include <algorithm>
#include <string>

#include "shared/objects.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

// Most samples of a tile, whatever the shared memory: more would leave a GPU's core too few workgroups.
constexpr std::uint32_t kMaxTileSamples = 6144;
// Shared memory of the contact pass beside the tile, at most: partial sums, planes and lists, of clusters of kGroupsPerBatch groups, of
// kMaxRepeat tiles.
constexpr std::uint32_t kTileOverhead = 6912;
constexpr std::uint32_t kGroupsPerBatch = 32;

std::uint32_t contactBytes(std::uint32_t tile_samples, std::uint32_t groups, std::uint32_t repeat) {
  const std::uint32_t more_groups = std::max(groups, kGroupsPerBatch) - kGroupsPerBatch;
  const std::uint32_t more_tiles = std::max(repeat, kMaxRepeat) - kMaxRepeat;
  return 4 * tile_samples + kTileOverhead + 4 * more_groups * (layout::kClustersPerGroup + 1) + 4 * more_tiles;
}

}  // namespace

std::uint32_t chooseWorkgroup(int wanted, const DeviceInfo& info, std::uint32_t on_gpu, std::uint64_t work, const char* name) {
  if (wanted == 0 && info.type == DeviceType::kCpu) {
    return static_cast<std::uint32_t>(std::clamp<std::uint64_t>(std::bit_ceil(work / kMaxTurns), 8, 256));
  }
  return tunedSize(wanted, on_gpu, 4, 256, name);
}

std::uint32_t tunedSize(int wanted, std::uint32_t chosen, std::uint32_t least, std::uint32_t most, const char* name) {
  if (wanted == 0) return chosen;
  const auto number = static_cast<std::uint32_t>(wanted);
  if (wanted < 0 || number < least || number > most || !std::has_single_bit(number)) {
    throw Error(ErrorKind::kInput, std::string(name) + ": " + std::to_string(wanted) + " is not allowed: a power of two, " +
                                       std::to_string(least) + " to " + std::to_string(most));
  }
  return number;
}

bool isOneVector(const DeviceInfo& info, std::uint32_t workgroup) {
  return info.driver.starts_with("llvmpipe ") && workgroup <= info.subgroup_size;
}

std::uint32_t chooseRepeat(const DeviceInfo& info, std::uint64_t turns, std::uint32_t most) {
  if (info.type != DeviceType::kCpu) return 1;
  return static_cast<std::uint32_t>(std::clamp<std::uint64_t>(kMaxTurns / std::max<std::uint64_t>(turns, 1), 1, most));
}

std::uint32_t tunedRepeat(int wanted, std::uint32_t chosen, const char* name) {
  if (wanted == 0) return chosen;
  if (wanted < 0 || static_cast<std::uint32_t>(wanted) > kMaxTileRepeat) {
    throw Error(ErrorKind::kInput,
                std::string(name) + ": " + std::to_string(wanted) + " is not allowed: 1 to " + std::to_string(kMaxTileRepeat));
  }
  return static_cast<std::uint32_t>(wanted);
}

std::uint32_t mostTileSamples(const DeviceInfo& info) {
  return std::min(kMaxTileSamples, (info.shared_memory - kTileOverhead) / 4);
}

std::uint32_t chooseGroupsPerBatch(const DeviceInfo& info, std::uint32_t tile_samples, std::uint32_t most_groups) {
  // A barrier costs a software driver some microseconds, so there as many as a mesh has, if the lists fit beside the tile. On a GPU memory
  // is what limits how many workgroups run.
  std::uint32_t groups = kGroupsPerBatch;
  while (info.type == DeviceType::kCpu && groups < std::min(kMostGroupsPerBatch, most_groups) &&
         contactBytes(tile_samples, 2 * groups, 1) <= info.shared_memory) {
    groups *= 2;
  }
  return groups;
}

void checkContactFits(const DeviceInfo& info, std::uint32_t tile_samples, std::uint32_t groups, std::uint32_t repeat) {
  const std::uint32_t bytes = contactBytes(tile_samples, groups, repeat);
  if (bytes <= info.shared_memory) return;
  throw Error(ErrorKind::kInput, "tuning: groups_per_batch " + std::to_string(groups) + " with contact_repeat " + std::to_string(repeat) +
                                     " is not allowed: takes up to " + std::to_string(bytes) + " bytes of shared memory, the device has " +
                                     std::to_string(info.shared_memory));
}

std::uint32_t imagePartials(std::uint32_t workgroup, std::uint32_t team, std::uint32_t lanes) {
  constexpr std::uint32_t kNumSums = 19;  // of shaders/image.comp
  return team == 1 ? 1 : workgroup / team * kNumSums * lanes;
}

void checkImageFits(const DeviceInfo& info, std::uint32_t workgroup, std::uint32_t team, std::uint32_t partials) {
  if (4 * partials <= info.shared_memory) return;
  throw Error(ErrorKind::kInput, "tuning.image_team: " + std::to_string(team) + " is not allowed: in workgroups of " +
                                     std::to_string(workgroup) + " takes " + std::to_string(4 * partials) +
                                     " bytes of shared memory, the device has " + std::to_string(info.shared_memory));
}

}  // namespace taxelsim
