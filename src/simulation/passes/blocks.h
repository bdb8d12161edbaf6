// Every array that passes bind, as a type: shaders/passes/blocks.h.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>

#include "passes/blocks.h"
#include "shared/batch.h"
#include "shared/model.h"
#include "shared/servo.h"

namespace taxelsim::block {

using namespace layout;  // NOLINT(google-build-using-namespace): names of records
using glm::uvec2;
using glm::vec2;

enum class Number : std::size_t {
#define BLOCK(Name, ElementType, declarator) k##Name,
  ALL_BLOCKS
#undef BLOCK
      kCount
};

inline constexpr auto kNumBlocks = static_cast<std::size_t>(Number::kCount);

#define BLOCK(Name, ElementType, declarator)                                  \
  struct Name {                                                               \
    using Element = ElementType;                                              \
    static constexpr const char* kName = #Name;                               \
    static constexpr auto kIndex = static_cast<std::size_t>(Number::k##Name); \
  };
ALL_BLOCKS
#undef BLOCK

}  // namespace taxelsim::block
