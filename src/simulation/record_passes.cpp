// The passes of a frame, in order: docs/architecture.md, "The way of a frame".
#include "gpu/device_access.h"
#include "shared/candidates.h"
#include "simulation/model_access.h"
#include "simulation/simulator_impl.h"

namespace taxelsim {

// The one place where the passes are put in order.
gpu::Commands Simulator::Impl::record(const FrameKind& kind) {
  const Model::Impl& m = implOf(model);
  const auto n = static_cast<std::uint32_t>(options.num_instances);
  const BatchBuffers& b = buffers;
  gpu::Commands commands(gpu::contextOf(m.device), "a frame", options.device_clock ? 3 : 0);
  commands.barrier(gpu::Access::kHostWrite, gpu::Access::kKernel);
  commands.timestamp(0);
  if (takesContacts()) {
    recordContacts(commands);
  } else {
    recordObjects(commands, kind);
    recordTaxels(commands);
  }
  commands.timestamp(1);
  commands.dispatch(m.imageKernel({.random = kind.random,
                                   .whole_array = m.law.whole_array && !takesContacts(),
                                   .with_normal = options.outputs.tactile_normal_force || options.outputs.clean_contact_features ||
                                                  wantsJacobian(options.outputs),
                                   .with_shear = withShear()}),
                    (n + m.imagesPerWorkgroup() - 1) / m.imagesPerWorkgroup(),
                    {&b.instances, &b.step, &m.sensor_record, &m.taxels, &m.spread_rows, &b.contact_normal, &b.contact_shear,
                     &b.tile_results, &b.loads, &b.image.device, &b.spread_normal.device, &b.spread_shear.device, &b.features.device,
                     &b.problems.device, &b.taxel_states, &b.image_windows});
  if (options.outputs.contact_features) recordContactFeatures(commands, false);
  if (options.outputs.clean_contact_features) recordContactFeatures(commands, true);
  if (wantsJacobian(options.outputs)) recordJacobian(commands, kind.random);
  commands.timestamp(2);
  commands.barrier(gpu::Access::kKernel, gpu::Access::kCopy);
  for (ReadableBuffer* buffer : buffers.readable(options.outputs)) {
    if (buffer->copied()) commands.copy(buffer->device, buffer->readback, buffer->device.size());
  }
  commands.barrier(gpu::Access::kCopy, gpu::Access::kHostRead);
  commands.barrier(gpu::Access::kKernel, gpu::Access::kHostRead);
  commands.end();
  return commands;
}

// Stages 1 and 2 from poses of objects.
void Simulator::Impl::recordObjects(gpu::Commands& commands, const FrameKind& kind) const {
  const Model::Impl& m = implOf(model);
  const bool with_loads = kind.loads;
  const auto n = static_cast<std::uint32_t>(options.num_instances);
  const auto num_tiles = static_cast<std::uint32_t>(m.contact_packed.tiles.size());
  const bool over_tiles = with_loads && !m.layer && !m.packed.searches_in_tile;
  const bool with_jacobian = wantsJacobian(options.outputs) && !m.layer;
  const Model::Impl::ContactVariant variant{.search = over_tiles   ? kSearchOverTiles
                                                      : with_loads ? kSearchInTile
                                                                   : kNoSearch,
                                            .many_slots = options.num_slots > 1,
                                            .with_depth = !m.layer && options.outputs.penetration_depth,
                                            .with_shear = !m.layer && withShear(),
                                            .with_jacobian = with_jacobian && !over_tiles,  // a search over tiles only searches
                                            .list = keeps_candidates && !with_loads ? layout::kListWholeMesh : layout::kNumLists};
  const BatchBuffers& b = buffers;
  // Of a law that is solved apart, the contact pass leaves heights and where they are.
  const gpu::Buffer* contact_out = m.layer ? &b.heights : &b.contact_normal;
  const gpu::Buffer* results_out = m.layer ? &b.windows : &b.tile_results;
  const auto contact_pass = [&](const Model::Impl::ContactVariant& of) {
    const std::initializer_list<const gpu::Buffer*> bound = {&b.poses,
                                                             &b.instances,
                                                             &b.step,
                                                             &m.object_records,
                                                             &m.groups,
                                                             &m.clusters,
                                                             &m.quads,
                                                             &m.patches,
                                                             &m.tiles,
                                                             &m.spread_scale,
                                                             &b.state,
                                                             contact_out,
                                                             &b.contact_depth.device,
                                                             results_out,
                                                             &b.loads,
                                                             &b.problems.device,
                                                             &m.faces,
                                                             &b.motions,
                                                             &b.friction_state,
                                                             &b.contact_shear,
                                                             &b.contact_cells,
                                                             &b.tile_changes,
                                                             &b.candidates,
                                                             &b.candidate_quads,
                                                             &b.work.device,
                                                             &b.work_instances};
    const std::uint32_t repeat = m.contactRepeat(of);
    if (of.list == layout::kNumLists) {
      commands.dispatch(m.contactKernel(of), (n * num_tiles + repeat - 1) / repeat, bound);
    } else {
      commands.dispatchIndirect(m.contactKernel(of), b.work.device, of.list * sizeof(glm::uvec4), bound);
    }
    commands.barrier(gpu::Access::kKernel, gpu::Access::kKernel);
  };
  if (kind.candidates != Candidates::kLeft) recordCandidates(commands, with_jacobian);
  if (kind.candidates == Candidates::kUsed) {
    Model::Impl::ContactVariant with = variant;
    with.list = layout::kListCandidates;
    contact_pass(with);
  }
  const std::uint32_t evaluations = over_tiles ? kLoadEvaluations + 2 : 1;  // two more: one closes the search, one is told
  for (std::uint32_t evaluation = 0; evaluation < evaluations; ++evaluation) {
    contact_pass(variant);
    if (!over_tiles) continue;
    commands.dispatch(m.loadKernel(), (n + m.image_workgroup - 1) / m.image_workgroup, {&b.instances, &b.step, &b.tile_results, &b.loads});
    commands.barrier(gpu::Access::kKernel, gpu::Access::kKernel);
  }
  if (over_tiles && (m.hasFriction() || m.relaxes() || with_jacobian)) {
    Model::Impl::ContactVariant last = variant;
    last.search = kSearchEnded;
    last.with_jacobian = with_jacobian;
    contact_pass(last);
  }
  if (m.layer) {
    commands.dispatch(m.layerKernel({.loads = with_loads,
                                     .many_slots = options.num_slots > 1,
                                     .with_depth = options.outputs.penetration_depth,
                                     .with_shear = withShear(),
                                     .with_jacobian = wantsJacobian(options.outputs)}),
                      n,
                      {&b.instances, &b.step, &m.sensor_record, &b.heights, &b.windows, &m.influence, &m.spread_scale, &b.layer,
                       &b.contact_normal, &b.contact_depth.device, &b.tile_results, &b.loads, &b.features.device, &b.problems.device,
                       &b.motions, &b.friction_state, &b.contact_shear, &b.taxel_jacobian, &b.wrench_jacobian});
    commands.barrier(gpu::Access::kKernel, gpu::Access::kKernel);
  }
}

// Before the contact pass of an object that touches slowly: shaders/keep_candidates.comp.
void Simulator::Impl::recordCandidates(gpu::Commands& commands, bool with_jacobian) const {
  const Model::Impl& m = implOf(model);
  const auto n = static_cast<std::uint32_t>(options.num_instances);
  const Model::Impl::CandidatePasses& passes = m.candidatePasses(with_jacobian);
  const BatchBuffers& b = buffers;
  commands.copy(m.no_work, b.work.device, m.no_work.size());
  commands.barrier(gpu::Access::kCopy, gpu::Access::kKernel);
  commands.dispatch(passes.keep, (n + kTaxelWorkgroup - 1) / kTaxelWorkgroup,
                    {&b.poses, &b.step, &m.object_records, &m.patches, &m.tiles, &b.candidates, &b.work.device, &b.work_instances});
  const auto lists_are_done = [&] {
    commands.barrier(gpu::Access::kKernel, gpu::Access::kKernel);
    commands.barrier(gpu::Access::kKernel, gpu::Access::kIndirect);
  };
  lists_are_done();
  commands.dispatchIndirect(passes.find, b.work.device, layout::kListFindCandidates * sizeof(glm::uvec4),
                            {&b.poses, &b.step, &m.object_records, &m.groups, &m.clusters, &m.quads, &m.patches, &m.tiles, &b.candidates,
                             &b.candidate_quads, &b.work.device, &b.work_instances, &b.problems.device});
  lists_are_done();
}

// What the law's taxels make of the force of contact.
void Simulator::Impl::recordTaxels(gpu::Commands& commands) const {
  const Model::Impl& m = implOf(model);
  const BatchBuffers& b = buffers;
  for (std::size_t pass = 0; pass < m.law.taxel_passes.size(); ++pass) {
    commands.dispatch(m.taxelKernels(withShear())[pass],
                      m.taxelGroups(m.law.taxel_passes[pass], static_cast<std::uint32_t>(options.num_instances)),
                      {&b.instances, &b.step, &m.spread_scale, &m.mask, &b.contact_normal, &b.law_state, &b.tile_results, &m.taxels,
                       &b.problems.device, &b.contact_shear});
    commands.barrier(gpu::Access::kKernel, gpu::Access::kKernel);
  }
}

// Stages 1 and 2 from contacts; no law is asked.
void Simulator::Impl::recordContacts(gpu::Commands& commands) const {
  const Model::Impl& m = implOf(model);
  const std::uint32_t repeat = m.contactsRepeat(options.max_contacts);
  const std::uint32_t per_workgroup = m.image_workgroup / m.image_team * repeat;
  const BatchBuffers& b = buffers;
  commands.dispatch(m.contactsKernel(repeat), (static_cast<std::uint32_t>(options.num_instances) + per_workgroup - 1) / per_workgroup,
                    {&b.step, &b.contacts, &b.num_contacts, &m.patches, &m.spread_scale, &b.contact_normal, &b.tile_results,
                     &b.features.device, &b.problems.device});
  commands.barrier(gpu::Access::kKernel, gpu::Access::kKernel);
}

// After the image pass.
void Simulator::Impl::recordContactFeatures(gpu::Commands& commands, bool clean) const {
  const Model::Impl& m = implOf(model);
  const BatchBuffers& b = buffers;
  const auto n = static_cast<std::uint64_t>(options.num_instances);
  const Model::Impl::ContactFeaturePasses& passes = m.contactFeatures({.clean = clean, .max_regions = options.max_regions});
  const gpu::Buffer& features = clean ? b.clean_contact_features.device : b.contact_features.device;
  const auto num_groups = [](std::uint64_t work, std::uint32_t per_workgroup) {
    return static_cast<std::uint32_t>((work + per_workgroup - 1) / per_workgroup);
  };
  commands.barrier(gpu::Access::kKernel, gpu::Access::kKernel);
  commands.dispatch(passes.regions, num_groups(n, passes.instances_per_workgroup),
                    {&b.instances, &b.step, &m.sensor_record, &m.taxels, &m.planes, &m.neighbours, &b.image.device, &b.spread_normal.device,
                     &b.forces, &b.taxel_regions, &b.region_sums, &b.regions, &features, &b.problems.device});
  commands.barrier(gpu::Access::kKernel, gpu::Access::kKernel);
  const std::uint64_t num_parts = numContactRows(m.packed_contact, options.max_regions) - (m.packed_contact.num_patches == 1 ? 1 : 0);
  commands.dispatch(passes.features, num_groups(n * num_parts, passes.parts_per_workgroup),
                    {&b.instances, &b.step, &m.taxels, &m.planes, &b.forces, &b.taxel_regions, &b.regions, &features, &b.problems.device});
}

// After the image pass.
void Simulator::Impl::recordJacobian(gpu::Commands& commands, bool random) const {
  const Model::Impl& m = implOf(model);
  const BatchBuffers& b = buffers;
  const auto n = static_cast<std::uint32_t>(options.num_instances);
  const auto num_groups = [](std::uint64_t work, std::uint32_t per_workgroup) {
    return static_cast<std::uint32_t>((work + per_workgroup - 1) / per_workgroup);
  };
  commands.barrier(gpu::Access::kKernel, gpu::Access::kKernel);
  // An elastic layer has told this already.
  if (!m.layer) {
    commands.dispatch(m.taxelJacobian()[0], num_groups(static_cast<std::uint64_t>(n) * m.num_taxels, kTaxelWorkgroup),
                      {&b.step, &m.patches, &m.tiles, &m.taxels, &m.spread_scale, &b.contact_cells, &b.tile_changes, &b.taxel_jacobian,
                       &b.wrench_jacobian});
    commands.barrier(gpu::Access::kKernel, gpu::Access::kKernel);
  }
  if (m.masksForces()) {
    commands.dispatch(m.taxelJacobian()[1], num_groups(static_cast<std::uint64_t>(n) * m.num_taxels, kTaxelWorkgroup),
                      {&b.step, &m.mask, &m.taxels, &b.law_state, &b.taxel_jacobian, &b.masked_jacobian});
    commands.barrier(gpu::Access::kKernel, gpu::Access::kKernel);
    commands.dispatch(m.taxelJacobian()[2], num_groups(6ull * n, kTaxelWorkgroup),
                      {&b.step, &m.spread_scale, &b.law_state, &b.tile_results, &b.masked_jacobian, &b.taxel_jacobian, &b.problems.device});
    commands.barrier(gpu::Access::kKernel, gpu::Access::kKernel);
  }
  const std::uint32_t num_parts = m.packed_contact.num_patches == 1 ? 1 : numContactRows(m.packed_contact, 0);
  const auto features = [&](bool clean, const gpu::Buffer& out) {
    const Model::Impl::JacobianPass& pass = m.tactileJacobian({.clean = clean, .random = random && !clean});
    commands.dispatch(pass.features, num_groups(static_cast<std::uint64_t>(n) * num_parts, pass.parts_per_workgroup),
                      {&b.instances, &b.step, &m.taxels, &m.planes, &m.spread_rows, &b.spread_normal.device, &b.taxel_jacobian,
                       &b.wrench_jacobian, &out, &b.problems.device});
  };
  if (options.outputs.tactile_jacobian) features(false, b.jacobian.device);
  if (options.outputs.clean_tactile_jacobian) features(true, b.clean_jacobian.device);
}

}  // namespace taxelsim
