#include "simulation/passes/linked_foundation.h"

#include <cstdint>

#include "linked_foundation_pairs_variants.h"
#include "linked_foundation_variants.h"
#include "sensor/pasternak.h"

namespace taxelsim {
namespace {

// Loop iterations that one invocation alone would take in a third of the largest contact, one that covers the array: a driver allows three
// times as many as small workgroups are chosen for.
std::uint64_t linkedIterations(const ModelData& model) {
  constexpr std::uint64_t kOtherLoops = 4;  // over the nodes
  const std::uint64_t loops_of_node = model.linked->num_fours > 1 ? 2 + model.linked->num_fours : 1;
  const std::uint64_t loops_of_cuts = model.area() ? loops_of_node : 0;
  const auto nodes = static_cast<std::uint64_t>(model.linked->nodes.size());
  const auto sweeps = static_cast<std::uint64_t>(pasternakSweeps(model.sensor));
  return nodes * (kOtherLoops + loops_of_cuts + (sweeps + 1) * loops_of_node) / 3;
}

}  // namespace

LinkedFoundationPass::LinkedFoundationPass(const ModelData& model, const ModelOptions& options) : model_(model) {
  sizes_.workgroup = tunedWorkgroup(options.contact_workgroup, model.profile, linkedIterations(model), "contact_workgroup");
}

void LinkedFoundationPass::record(Recorder& recorder, const Variant& variant) const {
  recorder.dispatch(kernels_.get(variant, [&] { return makeKernel(variant); }), static_cast<std::uint32_t>(recorder.num_instances));
}

LinkedFoundationPass::Kernel LinkedFoundationPass::makeKernel(const Variant& variant) const {
  const auto& law = std::get<Pasternak>(model_.sensor.skin.law);
  const gpu::ShaderVariants shaders =
      model_.profile.prefers64BitLoads() ? k_linked_foundation_pairs_variants : k_linked_foundation_variants;
  return {model_.context(), "linked_foundation", model_.profile.select(shaders, sizes_.workgroup),
          commonConstants(model_.sensor, model_.packed, sizes_),
          LinkedFoundationInterface{.NODES_PER_SAMPLE = pasternakRefinement(model_.sensor),
                                    .THICKNESS = model_.sensor.skin.thickness,
                                    .OVER_RELAXATION = sweepRelaxation(law, finestPasternakNodes(model_.sensor)),
                                    .SWEEPS = pasternakSweeps(model_.sensor),
                                    .NUM_COLORS = model_.linked->num_colors,
                                    .MOST_OF_COLOR = model_.linked->most_of_color,
                                    .NUM_FOURS = model_.linked->num_fours,
                                    .NUM_HEIGHT_TILES = model_.contact_packed.tiles.size(),
                                    .LOADS = variant.loads,
                                    .OUTPUT_DEPTH = variant.with_depth,
                                    .BLOCKS_PER_TAXEL = model_.linked->blocks_per_taxel,
                                    .AREA = model_.area()}};
}

}  // namespace taxelsim
