// generate() where the loops of servos are closed as asked, for tests that compare the bytes.
#pragma once

#include "episodes/slice.h"
#include "taxelsim/generate.h"

namespace taxelsim {

GenerateResult generate(const Device& device, const Scene& scene, const std::filesystem::path& directory, const GenerateOptions& options,
                        SlicePlan::Loops loops);

}  // namespace taxelsim
