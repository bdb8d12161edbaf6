#include "gpu/driver_profile.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstdlib>
#include <string>
#include <string_view>
#include <utility>

#include "taxelsim/error.h"

namespace taxelsim::gpu {
namespace {

constexpr std::array<std::pair<std::string_view, bool FastPaths::*>, 9> kNames{{{"polyhedra", &FastPaths::polyhedra},
                                                                                {"kinds", &FastPaths::kinds},
                                                                                {"untouched", &FastPaths::untouched},
                                                                                {"candidates", &FastPaths::candidates},
                                                                                {"lockstep", &FastPaths::lockstep},
                                                                                {"alone", &FastPaths::alone},
                                                                                {"sequences", &FastPaths::sequences},
                                                                                {"threads", &FastPaths::threads},
                                                                                {"servo", &FastPaths::servo}}};

// Two subgroups of 32 lanes, or one of 64.
constexpr std::uint32_t kGpuWorkgroup = 64;

// On a software driver small workgroups win as long as no invocation exceeds kMaxIterations.
constexpr std::uint64_t kMinSoftwareWorkgroup = 8, kMaxSoftwareWorkgroup = 256;

std::uint32_t invocationsFor(std::uint64_t iterations) {
  return static_cast<std::uint32_t>(std::clamp(std::bit_ceil(iterations / kMaxIterations), kMinSoftwareWorkgroup, kMaxSoftwareWorkgroup));
}

void switchOff(FastPaths& paths, std::string_view name) {
  bool is_known = false;
  for (const auto& [known, path] : kNames) {
    if (name != known && name != "all") continue;
    paths.*path = false;
    is_known = true;
  }
  if (is_known) return;
  std::string allowed;
  for (const auto& [known, path] : kNames) allowed += std::string(known) + ", ";
  throw Error(ErrorKind::kInput, "TAXELSIM_PLAIN: \"" + std::string(name) + "\" is not allowed: " + allowed + "all");
}

}  // namespace

FastPaths fastPaths() {
  FastPaths paths;
  const char* value = std::getenv("TAXELSIM_PLAIN");
  std::string_view left = value == nullptr ? "" : value;
  while (!left.empty()) {
    const std::size_t comma = left.find(',');
    switchOff(paths, left.substr(0, comma));
    left = comma == std::string_view::npos ? "" : left.substr(comma + 1);
  }
  return paths;
}

DriverProfile::DriverProfile(const DeviceInfo& info, const WideNumbers& wide_numbers, const FastPaths& paths)
    : paths_(paths),
      vector_size_(info.driver.starts_with("llvmpipe ") ? info.subgroup_size : 0),
      is_software_(info.type == DeviceType::kCpu),
      wide_numbers_(wide_numbers),
      has_own_memory_(info.type == DeviceType::kDiscrete) {}

std::uint32_t DriverProfile::workgroupFor(std::uint64_t iterations) const {
  return is_software_ ? invocationsFor(iterations) : kGpuWorkgroup;
}

bool DriverProfile::prefersOneInvocationPerItem(std::uint64_t iterations) const {
  return paths_.alone && is_software_ && iterations <= kMaxIterations;
}

std::uint32_t DriverProfile::itemsInSequence(std::uint64_t iterations, std::uint32_t most) const {
  if (!is_software_) return 1;
  return static_cast<std::uint32_t>(std::clamp<std::uint64_t>(kMaxIterations / std::max<std::uint64_t>(iterations, 1), 1, most));
}

std::uint32_t DriverProfile::partialSumsFor(std::uint64_t iterations) const {
  // A GPU's workgroup has one per invocation. On a software driver each costs every invocation a fetch, so there are as few as a vector has
  // lanes, unless the work needs more invocations.
  return is_software_ ? invocationsFor(iterations) : kGpuWorkgroup;
}

std::span<const std::uint32_t> DriverProfile::select(const ShaderVariants& variants, std::uint32_t workgroup) const {
  return paths_.lockstep && wide_numbers_.integers && wide_numbers_.shared_atomics && workgroup <= vector_size_ ? variants.lockstep
                                                                                                                : variants.any;
}

}  // namespace taxelsim::gpu
