#include "simulation/passes/pasternak.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <thread>

#include "pasternak_pairs_variants.h"
#include "pasternak_variants.h"
#include "sensor/pasternak.h"

namespace taxelsim {
namespace {

// Loop iterations that one invocation alone would take in a third of the largest contact, one that covers the array: a driver allows three
// times as many as small workgroups are chosen for.
std::uint64_t iterationsOf(const ModelData& model, std::uint64_t evaluations) {
  constexpr std::uint64_t kRows = PasternakInterface::kBlockRows, kCols = PasternakInterface::kBlockCols;
  constexpr std::uint64_t kColumnsOfStart = 2 * kCols, kStepsOfSweep = kCols / 2 + 2;
  const std::uint64_t start = kColumnsOfStart + model.contact_packed.tiles.size();
  const auto nodes = static_cast<std::uint64_t>(numTaxels(model.contact_sensor));
  const auto sweeps = static_cast<std::uint64_t>(pasternakSweeps(model.sensor));
  return (nodes / (kRows * kCols) + 1) * evaluations * (start + (sweeps + 1) * kStepsOfSweep) / 3;
}

}  // namespace

PasternakPass::PasternakPass(const ModelData& model, const ModelOptions& options) : model_(model) {
  constexpr std::uint64_t kEvaluations = 24;  // of the load search
  const std::uint64_t iterations = iterationsOf(model, 1);
  sizes_.workgroup = tunedWorkgroup(options.contact_workgroup, model.profile, iterations, "contact_workgroup");
  sizes_.lanes = model.profile.partialSumsFor(iterations);
  sizes_.repeat = model.profile.itemsInSequence(iterations / sizes_.workgroup, kMaxRepeat);
  load_sizes_ = sizes_;
  load_sizes_.workgroup = tunedWorkgroup(options.contact_workgroup, model.profile, iterationsOf(model, kEvaluations), "contact_workgroup");
  load_sizes_.repeat = model.profile.itemsInSequence(iterationsOf(model, kEvaluations) / load_sizes_.workgroup, kMaxRepeat);
}

// A workgroup that solves several instances finds its arrays in the caches. There are enough workgroups for all processors.
std::uint32_t PasternakPass::numWorkgroups(std::uint64_t num_instances, const Variant& variant) const {
  constexpr std::uint64_t kPerProcessor = 4;
  const PassSizes& sizes = variant.loads ? load_sizes_ : sizes_;
  const std::uint64_t least = (num_instances + sizes.repeat - 1) / sizes.repeat;
  return static_cast<std::uint32_t>(std::clamp(kPerProcessor * std::thread::hardware_concurrency(), least, num_instances));
}

void PasternakPass::record(Recorder recorder, const Variant& variant) const {
  recorder.bindings.redirect<block::FoundationRows, block::Foundation>();
  recorder.dispatch(kernels_.get(variant, [&] { return makeKernel(variant); }), numWorkgroups(recorder.num_instances, variant));
}

PasternakPass::Kernel PasternakPass::makeKernel(const Variant& variant) const {
  constexpr double kMarginDecays = 2;
  const auto& law = std::get<Pasternak>(model_.sensor.skin.law);
  const LayerNodes nodes = pasternakNodes(model_.sensor);
  const auto [along_x, along_y] = nodes.spacing;
  const double decay = decayLength(law);
  const gpu::ShaderVariants shaders = model_.profile.prefers64BitLoads() ? k_pasternak_pairs_variants : k_pasternak_variants;
  const PassSizes& sizes = variant.loads ? load_sizes_ : sizes_;
  return {model_.context(), "pasternak", model_.profile.select(shaders, sizes.workgroup),
          commonConstants(model_.sensor, model_.packed, sizes),
          PasternakInterface{.NODES_PER_SAMPLE = pasternakRefinement(model_.sensor),
                             .THICKNESS = model_.sensor.skin.thickness,
                             .SPRING = law.normal_contact_stiffness * nodes.area(),
                             .LINK_X = law.shear_stiffness * along_y / along_x,
                             .LINK_Y = law.shear_stiffness * along_x / along_y,
                             .DECAY_X = std::exp(-along_x / decay),
                             .DECAY_Y = std::exp(-along_y / decay),
                             .OVER_RELAXATION = sweepRelaxation(law, nodes),
                             .SWEEPS = pasternakSweeps(model_.sensor),
                             .MARGIN = static_cast<std::uint32_t>(std::ceil(kMarginDecays * decay / std::min(along_x, along_y))),
                             .NUM_HEIGHT_TILES = model_.contact_packed.tiles.size(),
                             .LOADS = variant.loads,
                             .OUTPUT_DEPTH = variant.with_depth,
                             .AREA = model_.area()}};
}

}  // namespace taxelsim
