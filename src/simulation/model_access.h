// Access of the library to the implementation of a Model, and models with a Tuning.
#pragma once

#include "simulation/tuning.h"
#include "taxelsim/model.h"

namespace taxelsim {

struct ModelAccess {
  static const Model::Impl& impl(const Model& model) { return *model.impl_; }

  // Throws as the constructor of Model, and Error(kInput) for a tuning that is out of range or needs more shared memory than the device
  // has.
  static Model make(const Device& device, const ModelOptions& options, const Tuning& tuning);
};

// The implementation of a model (simulation/model_impl.h); lives as long as any Model that shares it.
inline const Model::Impl& implOf(const Model& model) {
  return ModelAccess::impl(model);
}

}  // namespace taxelsim
