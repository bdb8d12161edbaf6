// Contact law -> its variant of the contact pass and the numbers that it is compiled with.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

#include "taxelsim/sensor.h"

namespace taxelsim {

struct PackedLaw {
  std::string kernel;
  std::span<const std::uint32_t> spirv;
  std::span<const std::uint32_t> spirv_pairs;  // the same with words of 64 bits, shaders/lib/pairs.glsl
  std::array<float, 8> parameters{};           // LAW_0 .. LAW_7 of shaders/contact.comp
  bool has_state = false;                      // the law needs every sample's depth of the step before
};

PackedLaw packLaw(const ContactLaw& law);

}  // namespace taxelsim
