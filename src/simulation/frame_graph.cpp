#include "simulation/frame_graph.h"

#include <span>

namespace taxelsim {
namespace {

using Candidates = FrameKind::Candidates;

// Sensors that are not one tile facing along z of S search for loads with a pass of their own.
bool searchesOverTiles(const ModelData& data, const FrameKind& kind) {
  return kind.loads && !data.layer && !data.packed.searches_in_tile;
}

// The list of the instances without candidates.
std::uint32_t otherInstances(const BatchShape& shape, const FrameKind& kind) {
  const bool uses_lists = shape.keeps_candidates && !kind.loads && kind.candidates != Candidates::kLeft;
  return uses_lists ? layout::kListWholeMesh : layout::kNumLists;
}

// The contact pass from poses. In a large batch of a model of several kinds of objects it is a dispatch for each kind, compiled for what
// this kind needs: the same results in less time, for more kernels to compile.
void recordContact(const Model::Impl& model, const BatchShape& shape, Recorder& recorder, ContactPass::Variant variant) {
  constexpr int kMinInstances = 256;
  const std::span<const std::uint32_t> kinds = model.data.object_kinds.passes;
  const bool divides = kinds.size() > 1 && shape.options.num_instances >= kMinInstances && !variant.depth.many_slots &&
                       variant.depth.search == DepthInterface::kNoSearch;
  if (!divides) return model.contact.record(recorder, variant);
  const std::uint32_t list = variant.depth.list;
  for (const std::uint32_t mask : kinds) {
    variant.depth.kinds = mask;
    variant.depth.list = (mask & (1u << layout::kKindMesh)) != 0 ? list : layout::kNumLists;  // lists are made for meshes
    model.contact.record(recorder, variant);
  }
}

// Kernels of stage 1 with points.
DepthVariant depthVariant(const BatchShape& shape, const FrameKind& kind) {
  return {.search = kind.loads ? DepthInterface::kSearchInTile : DepthInterface::kNoSearch,
          .many_slots = kind.many_near,
          .keeps_slots = shape.options.num_slots > 1 && shape.hasFriction()};
}

// Stages 1 and 2 of the law elastic_layer.
void recordLayer(const Model::Impl& model, const BatchShape& shape, Recorder& recorder, const FrameKind& kind) {
  DepthVariant variant = depthVariant(shape, kind);
  if (kind.candidates == Candidates::kUsed) {
    variant.list = layout::kListCandidates;
    model.heights->record(recorder, variant);
  }
  variant.list = otherInstances(shape, kind);
  model.heights->record(recorder, variant);
  if (model.data.area()) {
    variant.list = layout::kNumLists;
    variant.area = true;
    model.heights->record(recorder, variant);
  }
  model.elastic_layer->record(recorder, {.loads = kind.loads,
                                         .keeps_slots = variant.keeps_slots,
                                         .with_depth = shape.options.outputs.penetration_depth,
                                         .with_shear = shape.outputsShear(),
                                         .with_jacobian = shape.outputsJacobian()});
}

// Evaluates the contact pass at the offsets of the search until it has ended.
void recordSearchOverTiles(const Model::Impl& model, Recorder& recorder, ContactPass::Variant variant) {
  const bool with_jacobian = variant.with_jacobian;
  variant.depth.search = DepthInterface::kSearchOverTiles;
  variant.with_jacobian = false;
  for (std::uint32_t evaluation = 0; evaluation < LoadSearchPass::kNumFrameEvaluations; ++evaluation) {
    model.contact.record(recorder, variant);
    model.load_search.record(recorder);
  }
  // What the search leaves alone: the state of the samples and the Jacobian.
  if (model.data.hasFriction() || model.data.relaxes() || with_jacobian) {
    variant.depth.search = DepthInterface::kSearchEnded;
    variant.with_jacobian = with_jacobian;
    model.contact.record(recorder, variant);
  }
}

// Stages 1 and 2 of other laws.
void recordContacts(const Model::Impl& model, const BatchShape& shape, Recorder& recorder, const FrameKind& kind) {
  ContactPass::Variant variant{.depth = depthVariant(shape, kind),
                               .with_depth = shape.options.outputs.penetration_depth,
                               .with_shear = shape.outputsShear(),
                               .with_jacobian = shape.outputsJacobian(),
                               .with_wrench = shape.options.outputs.clean_tactile_jacobian,
                               .random_skin = shape.options.vary_skin};
  variant.depth.area = model.data.area();
  if (kind.candidates == Candidates::kUsed) {
    variant.depth.list = layout::kListCandidates;
    model.contact.record(recorder, variant);
  }
  variant.depth.list = otherInstances(shape, kind);
  if (searchesOverTiles(model.data, kind)) {
    recordSearchOverTiles(model, recorder, variant);
  } else {
    recordContact(model, shape, recorder, variant);
  }
}

// Stages 1 and 2 from poses of objects.
void recordObjects(const Model::Impl& model, const BatchShape& shape, Recorder& recorder, const FrameKind& kind) {
  const bool keeps_candidates = kind.candidates == Candidates::kKept || kind.candidates == Candidates::kUsed;
  if (keeps_candidates) model.candidates.record(recorder, shape.outputsJacobian() && !model.elastic_layer);
  if (model.elastic_layer) {
    recordLayer(model, shape, recorder, kind);
  } else {
    recordContacts(model, shape, recorder, kind);
  }
  model.taxel_laws.record(recorder, shape.outputsShear());
  if (model.deformation_mask) model.deformation_mask->record(recorder, shape.outputsJacobian());
}

// Stages 3 to 6.
void recordImage(const Model::Impl& model, const BatchShape& shape, Recorder& recorder, const FrameKind& kind) {
  const OutputOptions& outputs = shape.options.outputs;
  model.image.record(recorder, {.random = kind.random,
                                .whole_array = model.data.law.whole_array && !shape.takesContacts(),
                                .masked = model.data.hasMask() && !shape.takesContacts(),
                                .with_normal = outputs.tactile_normal_force || outputs.clean_contact_features || shape.outputsJacobian() ||
                                               outputs.taxel_counts,
                                .with_shear = shape.outputsShear(),
                                .random_skin = shape.options.vary_skin});
  if (outputs.taxel_counts) model.three_axis.record(recorder, kind.random);
  for (const bool clean : {false, true}) {
    if (!(clean ? outputs.clean_contact_features : outputs.contact_features)) continue;
    model.contact_features.record(recorder, clean, shape.options.max_regions);
  }
  if (shape.outputsJacobian()) model.tactile_jacobian.recordTaxels(recorder);
  if (outputs.clean_tactile_jacobian) model.tactile_jacobian.recordWrench(recorder);
  if (outputs.taxel_jacobian) model.tactile_jacobian.recordSpread(recorder);
  for (const bool clean : {false, true}) {
    if (!(clean ? outputs.clean_tactile_jacobian : outputs.tactile_jacobian)) continue;
    model.tactile_jacobian.recordFeatures(recorder, {.clean = clean, .random = kind.random && !clean});
  }
}

// Integers and flags where another interface imports them.
void recordIntegers(const Model::Impl& model, const BatchShape& shape, const Recorder& recorder) {
  const SimulatorOptions& options = shape.options;
  if (!options.export_memory) return;
  model.integer_features.record(recorder, kFrameSource);
  if (options.outputs.contact_features) model.integer_features.record(recorder, kContactSource);
  if (options.outputs.clean_contact_features) model.integer_features.record(recorder, kCleanContactSource);
}

// Closed loops: the poses of the next frame.
void recordLoop(const Model::Impl& model, const BatchShape& shape, const Recorder& recorder) {
  if (!shape.options.loop) return;
  const ServoLoopPlan& loop = *shape.options.loop;
  ServoPass::Variant variant{.control_period = static_cast<std::uint32_t>(loop.control_period),
                             .starts_at_load = loop.starts_at_load,
                             .reads_contact_features = loop.reads_contact_features,
                             .max_regions = static_cast<std::uint32_t>(shape.options.max_regions),
                             .object_poses = loop.outputs.object_poses,
                             .sensor_poses = loop.outputs.sensor_poses,
                             .actions = loop.outputs.actions,
                             .robot_status = loop.outputs.robot_status,
                             .joints = loop.outputs.joints};
  if (loop.robot) {
    const Manipulator& robot = loop.robot->robot;
    variant.num_joints = static_cast<std::uint32_t>(robot.joints.size());
    variant.num_chain_joints = static_cast<std::uint32_t>(robot.sensors.front().chain.size());
    variant.num_rows = static_cast<std::uint32_t>(std::count(robot.selection.begin(), robot.selection.end(), true));
    variant.delay = static_cast<std::uint32_t>(robot.drive.delay);
  }
  model.servo.record(recorder, variant);
}

Recorder recorderOf(const Model::Impl& model, const BatchShape& shape, const BatchBuffers& buffers, gpu::Commands& commands,
                    std::size_t half) {
  Recorder recorder{commands, {}, static_cast<std::uint64_t>(shape.options.num_instances)};
  model.data.buffers.bindTo(recorder.bindings);
  buffers.bindTo(recorder.bindings, half);
  return recorder;
}

// Orders the frame after the one before, for which the host has not waited.
void afterFrame(gpu::Commands& commands) {
  using gpu::Access;
  for (const Access before : {Access::kKernel, Access::kCopy}) {
    for (const Access after : {Access::kKernel, Access::kCopy}) commands.barrier(before, after);
  }
}

}  // namespace

gpu::Commands recordFrame(const Model::Impl& model, const BatchShape& shape, const BatchBuffers& buffers, const FrameKind& kind,
                          const layout::SkinBase& base, std::size_t half) {
  constexpr std::uint32_t kNumTimestamps = 3;
  gpu::Commands commands(model.data.context(), "a frame", shape.options.device_clock ? kNumTimestamps : 0);
  Recorder recorder = recorderOf(model, shape, buffers, commands, half);
  commands.barrier(gpu::Access::kHostWrite, gpu::Access::kKernel);
  commands.timestamp(0);
  if (kind.places) {
    afterFrame(commands);
    const auto num_slots = static_cast<std::uint32_t>(shape.options.num_slots);
    model.place.record(recorder, {num_slots, static_cast<std::uint32_t>(shape.options.max_contacts), kind.loads}, base);
  }
  if (shape.takesContacts()) {
    model.contacts.record(recorder, shape.options.max_contacts);
  } else {
    recordObjects(model, shape, recorder, kind);
  }
  commands.timestamp(1);
  recordImage(model, shape, recorder, kind);
  recordIntegers(model, shape, recorder);
  recordLoop(model, shape, recorder);
  commands.timestamp(2);
  buffers.recordReadback(commands, shape.options, kAfterFrame, half);
  commands.end();
  return commands;
}

gpu::Commands recordGradient(const Model::Impl& model, const BatchShape& shape, const BatchBuffers& buffers, bool with_gains,
                             std::size_t half) {
  gpu::Commands commands(model.data.context(), "a gradient");
  const Recorder recorder = recorderOf(model, shape, buffers, commands, half);
  commands.barrier(gpu::Access::kHostWrite, gpu::Access::kKernel);
  model.tactile_jacobian.recordGradient(recorder, with_gains);
  buffers.recordReadback(commands, shape.options, kAfterGradient, half);
  commands.end();
  return commands;
}

}  // namespace taxelsim
