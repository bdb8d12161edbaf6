#include "simulation/frame_view.h"

#include "shared/features.h"

namespace taxelsim {
namespace {

// The image features of `num_rows` rows, of the blocks that begin with number `start`.
void fillFeatures(std::span<const float> features, std::size_t num_rows, std::uint32_t start, FeatureView& view) {
  const auto block = [&](std::uint32_t first, std::size_t components = 1) {
    return features.subspan((start + first) * num_rows, components * num_rows);
  };
  view.total_force = block(layout::kFeatureTotalForce);
  view.peak_force = block(layout::kFeaturePeakForce);
  view.center_of_pressure = block(layout::kFeatureCenterOfPressure, 3);
  view.second_moments = block(layout::kFeatureSecondMoments, 3);
  view.eigenvalues = block(layout::kFeatureEigenvalues, 2);
  view.edge_angle = block(layout::kFeatureEdgeAngle);
  view.edge_confidence = block(layout::kFeatureEdgeConfidence);
  view.contact_area = block(layout::kFeatureContactArea);
}

ContactFeatureView contactView(const ModelData& model, const SimulatorOptions& options, std::span<const float> features) {
  const PackedContactFeatures& packed = model.packed_contact;
  const auto n = static_cast<std::size_t>(options.num_instances);
  const std::size_t num_rows = n * numContactRows(packed, options.max_regions);
  const auto block = [&](std::uint32_t first, std::size_t components = 1) {
    return features.subspan(first * num_rows, components * num_rows);
  };
  ContactFeatureView view;
  view.num_rows = static_cast<int>(num_rows / n);
  view.num_patches = static_cast<int>(packed.num_patches);
  fillFeatures(features, num_rows, 0, view);
  view.windowed_edge_angle = block(layout::kContactWindowedEdgeAngle);
  view.windowed_edge_confidence = block(layout::kContactWindowedEdgeConfidence);
  view.tilt = block(layout::kContactTilt, 2);
  view.tilt_confidence = block(layout::kContactTiltConfidence);
  view.contact_type = block(layout::kContactType);
  view.patch = block(layout::kContactPatch);
  view.num_regions = features.subspan(layout::kNumContactFeatures * num_rows, n);
  return view;
}

template <typename View>
void fillJacobian(const ModelData& model, const SimulatorOptions& options, std::span<const float> values, View& view) {
  const auto n = static_cast<std::size_t>(options.num_instances);
  const std::size_t num_rows = n * numContactRows(model.packed_contact, 0);
  const auto block = [&](std::uint32_t first, std::size_t components) { return values.subspan(first * num_rows, components * num_rows); };
  view.num_rows = static_cast<int>(num_rows / n);
  view.num_patches = static_cast<int>(model.packed_contact.num_patches);
  view.center_of_pressure = block(layout::kJacobianCenterOfPressure, 18);
  view.total_force = block(layout::kJacobianTotalForce, 6);
  view.edge_angle = block(layout::kJacobianEdgeAngle, 6);
}

}  // namespace

FrameView viewOf(const ModelData& model, const SimulatorOptions& options, const BatchBuffers& buffers) {
  const auto n = static_cast<std::size_t>(options.num_instances);
  const std::span<const float> features = buffers.output<block::Features>();
  const auto block = [&](std::uint32_t first, std::size_t components = 1) { return features.subspan(first * n, components * n); };
  FrameView frame;
  fillFeatures(features, n, 0, frame);
  fillFeatures(features, n, layout::kNumImageFeatures, frame.ground_truth);
  if (options.outputs.contact_features) frame.contact = contactView(model, options, buffers.output<block::ContactFeatures>());
  if (options.outputs.clean_contact_features)
    frame.ground_truth.contact = contactView(model, options, buffers.output<block::CleanContactFeatures>());
  if (options.outputs.tactile_jacobian) fillJacobian(model, options, buffers.output<block::TactileJacobian>(), frame.jacobian);
  if (options.outputs.clean_tactile_jacobian) {
    CleanTactileJacobianView& view = frame.ground_truth.jacobian;
    fillJacobian(model, options, buffers.output<block::CleanTactileJacobian>(), view);
    view.contact_wrench = buffers.output<block::CleanTactileJacobian>().subspan(
        layout::kNumJacobian * n * static_cast<std::size_t>(view.num_rows), layout::kNumWrenchJacobian * n);
  }
  const std::size_t taxels = model.num_taxels;
  frame.tactile_image = buffers.output<block::Image>().first(n * taxels);
  frame.saturated = block(layout::kFeatureSaturated);
  GroundTruthView& truth = frame.ground_truth;
  if (options.outputs.tactile_normal_force) truth.tactile_normal_force = buffers.output<block::SpreadNormal>().first(n * taxels);
  if (options.outputs.tactile_shear_force) truth.tactile_shear_force = buffers.output<block::SpreadShear>().first(2 * n * taxels);
  if (options.outputs.penetration_depth) truth.penetration_depth = buffers.output<block::ContactDepth>().first(n * taxels);
  truth.contact_wrench = block(layout::kFeatureContactWrench, 6);
  truth.over_penetration = block(layout::kFeatureOverPenetration);
  truth.load_offset = block(layout::kFeatureLoadOffset);
  truth.load_reached = block(layout::kFeatureLoadReached);
  truth.off_array_load = block(layout::kFeatureOffArrayLoad);
  truth.off_array_contacts = block(layout::kFeatureOffArrayContacts);
  if (model.layer && options.max_contacts == 0) {
    truth.contact_residual = block(layout::kFeatureContactResidual);
    truth.contact_iterations = block(layout::kFeatureContactIterations);
  }
  return frame;
}

}  // namespace taxelsim
