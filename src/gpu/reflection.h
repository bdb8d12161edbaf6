// The interface of a SPIR-V module.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <string>
#include <vector>

namespace taxelsim::gpu {

struct Reflection {
  std::map<std::uint32_t, std::string> buffers;   // of set 0 by binding: names of storage and uniform blocks and texel buffers
  std::set<std::uint32_t> uniform_buffers;        // their bindings
  std::set<std::uint32_t> texel_buffers;          // bindings of read-only texel buffers
  std::set<std::uint32_t> storage_texel_buffers;  // bindings of texel buffers that the shader may write
  std::vector<std::uint32_t> constants;           // ids of specialization constants, ascending
  std::vector<std::string> others;                // resources that kernels must not have
};

// Throws std::logic_error when the words are no valid module.
Reflection reflect(std::span<const std::uint32_t> spirv);

}  // namespace taxelsim::gpu
