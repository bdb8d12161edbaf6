#include "simulation/passes/sizes.h"

#include <algorithm>
#include <bit>
#include <string>

#include "taxelsim/error.h"

namespace taxelsim {

std::uint32_t tunedSize(int wanted, std::uint32_t chosen, std::uint32_t min, std::uint32_t max, const char* name) {
  if (wanted == 0) return chosen;
  const auto number = static_cast<std::uint32_t>(wanted);
  if (wanted < 0 || number < min || number > max || !std::has_single_bit(number)) {
    throw Error(ErrorKind::kInput, std::string(name) + ": " + std::to_string(wanted) + " is not allowed: a power of two, " +
                                       std::to_string(min) + " to " + std::to_string(max));
  }
  return number;
}

std::uint32_t tunedWorkgroup(int wanted, const gpu::DriverProfile& profile, std::uint64_t iterations, const char* name) {
  constexpr std::uint32_t kMin = 4, kMax = 256;
  return tunedSize(wanted, profile.workgroupFor(iterations), kMin, kMax, name);
}

std::uint32_t tunedRepeat(int wanted, std::uint32_t chosen, const char* name) {
  if (wanted == 0) return chosen;
  if (wanted < 0 || static_cast<std::uint32_t>(wanted) > kMaxTileRepeat) {
    throw Error(ErrorKind::kInput,
                std::string(name) + ": " + std::to_string(wanted) + " is not allowed: 1 to " + std::to_string(kMaxTileRepeat));
  }
  return static_cast<std::uint32_t>(wanted);
}

TeamSizes teamSizes(int wanted_workgroup, const gpu::DriverProfile& profile, std::uint64_t iterations, std::uint32_t lanes,
                    std::uint32_t max_team) {
  TeamSizes sizes;
  sizes.pass = {.workgroup = tunedWorkgroup(wanted_workgroup, profile, iterations, "image_workgroup"), .lanes = lanes};
  const bool alone = wanted_workgroup == 0 && profile.prefersOneInvocationPerItem(iterations);
  sizes.team = alone ? 1 : std::min(sizes.pass.workgroup, max_team);
  sizes.pass.repeat = profile.itemsInSequence(iterations / sizes.team, kMaxRepeat);
  return sizes;
}

CommonConstants commonConstants(const Sensor& sensor, const PackedSensor& packed, const PassSizes& sizes) {
  const GridPatch& patch = sensor.patches.front();
  return {.WORKGROUP = sizes.workgroup,
          .LANES = sizes.lanes,
          .NUM_TAXELS = numTaxels(sensor),
          .NUM_TILES = packed.tiles.size(),
          .SAMPLES = sensor.samples_per_taxel,
          .NUM_ROWS = packed.one_grid ? patch.num_rows : 0,
          .NUM_COLS = packed.one_grid ? patch.num_cols : 1,
          .REPEAT = sizes.repeat,
          .KERNEL = sensor.psf.size,
          .PITCH_X = patch.pitch[0],
          .PITCH_Y = patch.pitch[1]};
}

}  // namespace taxelsim
