// A kernel together with the interface of its pass.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "gpu/kernel.h"
#include "gpu/pass_interface.h"

namespace taxelsim::gpu {

// A kernel that implements Pass.
template <typename Pass>
class PassKernel : public Kernel {
 public:
  PassKernel() = default;
  // `common`: a pass type without buffers, whose constants have the ids 0, 1, ...; those of `constants` follow.
  template <typename Common>
  PassKernel(Context& context, std::string name, std::span<const std::uint32_t> spirv, const Common& common, const Pass& constants)
      : Kernel(context, {.name = std::move(name), .spirv = spirv, .buffers = blockNames(), .constants = listOf(common, constants)}) {}

 private:
  static std::vector<std::string> blockNames() {
    return []<std::uint32_t... kBindings>(std::integer_sequence<std::uint32_t, kBindings...>) {
      return std::vector<std::string>{BlockAt<Pass, kBindings>::kName...};
    }
    (std::make_integer_sequence<std::uint32_t, countBuffers<Pass>()>());
  }

  template <typename Common>
  static std::vector<Constant> listOf(const Common& common, const Pass& constants) {
    const auto first = constantsOf<0>(common);
    const auto rest = constantsOf<static_cast<std::uint32_t>(first.size())>(constants);
    std::vector<Constant> list(first.begin(), first.end());
    list.insert(list.end(), rest.begin(), rest.end());
    return list;
  }
};

}  // namespace taxelsim::gpu
