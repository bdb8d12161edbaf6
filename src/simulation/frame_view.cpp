#include "simulation/frame_view.h"

#include "shared/features.h"
#include "simulation/feature_table.h"

namespace taxelsim {

namespace {

// A feature buffer: block after block, each (num_rows x width).
struct Blocks {
  std::span<const float> values;
  std::size_t num_rows;
  IntegerFeatures& integers;

  // Sets the fields of `view` that the table names; `start` is added to the table's offsets.
  template <typename View, typename Target>
  void fill(std::span<const FeatureField<View>> table, Target& view, std::size_t start = 0) const {
    for (const FeatureField<View>& field : table) set(field, view, (start + field.offset) * num_rows, num_rows);
  }
  // The same for blocks of one row per instance that follow the others.
  template <typename View, typename Target>
  void fillLast(std::span<const FeatureField<View>> table, Target& view, std::size_t num_instances) const {
    for (const FeatureField<View>& field : table) set(field, view, field.offset * num_rows, num_instances);
  }

 private:
  template <typename View, typename Target>
  void set(const FeatureField<View>& field, Target& view, std::size_t first, std::size_t rows) const {
    if (values.empty()) return;
    const std::span<const float> block = values.subspan(first, field.width * rows);
    std::visit([&](auto member) { assign(view.*member, block); }, field.member);
  }
  void assign(std::span<const float>& target, std::span<const float> block) const { target = block; }
  template <typename T>
  void assign(std::span<const T>& target, std::span<const float> block) const {
    target = integers.convert<T>(block);
  }
};

void fillContact(const ModelData& model, const SimulatorOptions& options, std::span<const float> values, IntegerFeatures& integers,
                 ContactFeatureView& view) {
  const auto n = static_cast<std::size_t>(options.num_instances);
  const std::size_t num_rows = numContactRows(model.packed_contact, options.max_regions);
  view.num_rows = static_cast<int>(num_rows);
  view.num_patches = static_cast<int>(model.packed_contact.num_patches);
  const Blocks blocks{values, n * num_rows, integers};
  blocks.fill(imageFeatures(), view);
  blocks.fill(contactFeatures(), view);
  blocks.fillLast(regionFeatures(), view, n);
}

Blocks fillJacobian(const ModelData& model, const SimulatorOptions& options, std::span<const float> values, IntegerFeatures& integers,
                    TactileJacobianView& view) {
  const std::size_t num_rows = numContactRows(model.packed_contact, 0);
  view.num_rows = static_cast<int>(num_rows);
  view.num_patches = static_cast<int>(model.packed_contact.num_patches);
  const Blocks blocks{values, static_cast<std::size_t>(options.num_instances) * num_rows, integers};
  blocks.fill(jacobianFeatures(), view);
  return blocks;
}

void fillTaxels(const OutputOptions& outputs, const OutputArrays& arrays, std::size_t num_taxels, FrameView& frame) {
  GroundTruthView& truth = frame.ground_truth;
  frame.tactile_image = arrays.output<block::Image>(num_taxels);
#define TAXELSIM_FILL(view, name, block_, components) \
  if (outputs.name) (view).name = arrays.output<block::block_>((components)*num_taxels);
#define TAXELSIM_FILL_TRUE(name, block_, type, leading, components, ...) TAXELSIM_FILL(truth, name, block_, leading* components)
#define TAXELSIM_FILL_MEASURED(name, block_, type, leading, components, ...) TAXELSIM_FILL(frame, name, block_, leading* components)
  TAXELSIM_TRUE_TAXELS(TAXELSIM_FILL_TRUE)
  TAXELSIM_MEASURED_TAXELS(TAXELSIM_FILL_MEASURED)
}

}  // namespace

FrameView viewOf(const ModelData& model, const BatchOptions& options, const OutputArrays& arrays, IntegerFeatures& integers) {
  integers.clear();
  const auto n = static_cast<std::size_t>(options.num_instances);
  const OutputOptions& outputs = options.outputs;
  FrameView frame;
  GroundTruthView& truth = frame.ground_truth;
  fillTaxels(outputs, arrays, n * model.num_taxels, frame);
  if (options.loop && !options.loop->outputs.tactile_image) frame.tactile_image = {};
  const Blocks blocks{arrays.output<block::Features>(), n, integers};
  blocks.fill(imageFeatures(), frame);
  blocks.fill(imageFeatures(), truth, layout::kNumImageFeatures);
  blocks.fill(readoutFeatures(), frame);
  blocks.fill(truthFeatures(), truth);
  const bool is_solved = model.layer && options.max_contacts == 0;
  if (!is_solved) {
    truth.contact_residual = {};
    truth.contact_iterations = {};
  }
  if (outputs.contact_features) fillContact(model, options, arrays.output<block::ContactFeatures>(), integers, frame.contact);
  if (outputs.clean_contact_features) fillContact(model, options, arrays.output<block::CleanContactFeatures>(), integers, truth.contact);
  if (outputs.tactile_jacobian) fillJacobian(model, options, arrays.output<block::TactileJacobian>(), integers, frame.jacobian);
  if (outputs.clean_tactile_jacobian) {
    fillJacobian(model, options, arrays.output<block::CleanTactileJacobian>(), integers, truth.jacobian)
        .fillLast(wrenchJacobian(), truth.jacobian, n);
  }
  return frame;
}

}  // namespace taxelsim
