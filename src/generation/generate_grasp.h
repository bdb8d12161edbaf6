// generate() for scenes of kind grasp: the shards one after another, with episodes in lockstep.
#pragma once

#include "taxelsim/generate.h"

namespace taxelsim {

// `manifest`: without its probe. Refuses options that the kind does not have.
GenerateResult generateGrasp(const Device& device, const Scene& scene, const std::filesystem::path& directory, Manifest manifest,
                             const GenerateOptions& options);

}  // namespace taxelsim
