// Sets the specialization constants of a SPIR-V module.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace taxelsim::gpu {

// Value of one specialization constant, by its constant_id.
struct Constant {
  std::uint32_t id = 0;
  std::uint32_t value = 0;
};

// The module with ordinary constants in place of its specialization constants and without the blocks that their values disable: up to nine
// tenths of a pass, which a driver would translate before it removes them. Arithmetic stays as it is. `spirv` is a valid module;
// constants that are not in `constants` keep their defaults.
std::vector<std::uint32_t> specialize(std::span<const std::uint32_t> spirv, std::span<const Constant> constants);

}  // namespace taxelsim::gpu
