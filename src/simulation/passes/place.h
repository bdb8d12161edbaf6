// Objects, poses and loads, or contact points, from memory that another interface writes, shaders/place.comp.
#pragma once

#include <cstdint>

#include "simulation/model_data.h"
#include "simulation/passes/interfaces.h"
#include "simulation/passes/kernel_cache.h"
#include "simulation/passes/recorder.h"

namespace taxelsim {

class PlacePass {
 public:
  struct Variant {
    std::uint32_t num_slots = 1;
    std::uint32_t max_contacts = 0;  // capacity of an instance; above 0 it takes no objects
    bool loads = false;              // the frame is computed for loads

    auto operator<=>(const Variant&) const = default;  // NOLINT(modernize-use-nullptr): clang-tidy 14 misreads it
  };

  explicit PlacePass(const ModelData& model) : model_(model) {}

  // `base`: of the model's skin.
  void record(Recorder& recorder, const Variant& variant, const layout::SkinBase& base) const;

 private:
  gpu::PassKernel<PlaceInterface> makeKernel(const Variant& variant, const layout::SkinBase& base) const;

  const ModelData& model_;
  KernelCache<Variant, gpu::PassKernel<PlaceInterface>> kernels_;
};

}  // namespace taxelsim
