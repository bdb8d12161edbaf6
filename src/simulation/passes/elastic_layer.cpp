#include "simulation/passes/elastic_layer.h"

#include "elastic_layer_texels.spv.h"
#include "elastic_layer_variants.h"
#include "shared/elastic_layer.h"
#include "simulation/passes/layer_memory.h"

namespace taxelsim {
namespace {

// Loop iterations that one invocation alone would take: two products of all strips with all pairs of others in some of the iterations, the
// window being a part of them, and, for a skin that relaxes, one product of the strains.
std::uint64_t iterationsOf(const Sensor& sensor, const PackedLayer& layer) {
  const std::uint64_t strips = layer.influence.size() / (2 * layout::kStrip);
  const auto solver_iterations = static_cast<std::uint64_t>(std::get<ElasticLayer>(sensor.skin.law).iterations);
  return strips * strips / 2 * ((sensor.skin.relaxation.empty() ? 10 : 20) + solver_iterations) / 10;
}

}  // namespace

ElasticLayerPass::ElasticLayerPass(const ModelData& model, const ModelOptions& options) : model_(model) {
  const std::uint64_t iterations = iterationsOf(model.sensor, *model.layer);
  sizes_.workgroup = tunedWorkgroup(options.contact_workgroup, model.profile, iterations, "contact_workgroup");
  sizes_.lanes = model.profile.partialSumsFor(iterations);
  checkLayerFits(model.device.info(), model.sensor, model.layer->nodes, sizes_.lanes);
}

void ElasticLayerPass::record(Recorder recorder, const Variant& variant) const {
  recorder.bindings.redirect<block::LayerStrips, block::Layer>();
  recorder.dispatch(kernels_.get(variant, [&] { return makeKernel(variant); }), static_cast<std::uint32_t>(recorder.num_instances));
}

ElasticLayerPass::Kernel ElasticLayerPass::makeKernel(const Variant& variant) const {
  const auto& law = std::get<ElasticLayer>(model_.sensor.skin.law);
  const Skin& skin = model_.sensor.skin;
  const LayerNodes& nodes = model_.layer->nodes;
  gpu::ShaderVariants shaders = k_elastic_layer_variants;
  if (model_.profile.prefersTexels()) shaders.any = k_elastic_layer_texels_spirv;
  return {model_.context(), "elastic_layer", model_.profile.select(shaders, sizes_.workgroup),
          commonConstants(model_.sensor, model_.packed, sizes_),
          ElasticLayerInterface{.NODE_ROWS = nodes.num_rows,
                                .NODE_COLS = nodes.num_cols,
                                .MARGIN_ROWS = nodes.margin_rows,
                                .MARGIN_COLS = nodes.margin_cols,
                                .THICKNESS = skin.thickness,
                                .REACH = model_.layer->reach,
                                .NODE_FORCE = model_.layer->node_force,
                                .ITERATIONS = law.iterations,
                                .TOLERANCE = law.tolerance,
                                .NUM_HEIGHT_TILES = model_.contact_packed.tiles.size(),
                                .LOADS = variant.loads,
                                .OUTPUT_DEPTH = variant.with_depth,
                                .KEEPS_SLOTS = variant.keeps_slots,
                                .FRICTION = model_.hasFriction(),
                                .TANGENTIAL_STIFFNESS = skin.friction.tangential_stiffness,
                                .FRICTION_COEFFICIENT = skin.friction.friction_coefficient,
                                .OUTPUT_SHEAR = variant.with_shear,
                                .RELAXATION = skin.relaxation.size(),
                                .OUTPUT_JACOBIAN = variant.with_jacobian,
                                .AREA = model_.area(),
                                .CELL_DISC = model_.layer->cells.disc,
                                .CELL_FREE = model_.layer->cells.free,
                                .CELL_BASE = model_.layer->cells.base,
                                .POINT_COMPLIANCE = model_.layer->cells.point,
                                .IMAGE_DEPTH = model_.layer->cells.image_depth}};
}

}  // namespace taxelsim
