// What a SPIR-V module says of its interface.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <string>
#include <vector>

namespace taxelsim::gpu {

struct Reflection {
  std::map<std::uint32_t, std::string> buffers;  // of set 0, by binding: the name of a storage buffer's block, or of a texel buffer
  std::set<std::uint32_t> texel_buffers;         // which of these are read as texels
  std::vector<std::uint32_t> constants;          // ids of specialization constants, ascending
  std::vector<std::string> others;               // resources of a kind or set that kernels may not have
};

// Throws std::logic_error when the words are no valid module.
Reflection reflect(std::span<const std::uint32_t> spirv);

}  // namespace taxelsim::gpu
