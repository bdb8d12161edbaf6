// Outputs and inputs in the memory of another interface of the device, and the timeline that orders both sides.
#include <stdexcept>
#include <string>

#include "simulation/batch_plan.h"
#include "simulation/frame_view.h"
#include "simulation/simulator_impl.h"
#include "taxelsim/error.h"

namespace taxelsim {

FrameView Simulator::exportOutputs(const ImportMemory& import) {
  Impl& impl = *impl_;
  if (!impl.options.export_memory) throw std::logic_error("exportOutputs() needs a simulator with export_memory: true");
  const OutputArrays imported = impl.buffers.exportArrays({impl.data(), impl.options, impl.keeps_candidates}, false, import);
  ExportedIntegers exported(
      {imported.output<block::Features>(), imported.output<block::ContactFeatures>(), imported.output<block::CleanContactFeatures>()},
      reinterpret_cast<const std::byte*>(imported.output<block::IntegerFeatures>().data()));
  IntegerFeatures integers(exported);
  const FrameView view = viewOf(impl.data(), impl.options, imported, integers);
  std::ranges::copy(exported.rows(), impl.buffers.input<block::IntegerRows>().begin());
  return view;
}

ExportedInputs Simulator::exportInputs(const ImportMemory& import) {
  Impl& impl = *impl_;
  if (!impl.options.export_memory) throw std::logic_error("exportInputs() needs a simulator with export_memory: true");
  gpu::Context& context = impl.data().context();
  if (!context.wideNumbers().floats) {
    throw Error(ErrorKind::kDevice, "inputs: device \"" + impl.data().device.info().name + "\" does not compute with 64 bits");
  }
  const auto n = static_cast<std::size_t>(impl.options.num_instances);
  const std::size_t slots = impl.takesContacts() ? 0 : n * static_cast<std::size_t>(impl.options.num_slots);
  const std::size_t contacts = n * static_cast<std::size_t>(impl.options.max_contacts);
  std::vector<double> poses(7 * slots, 0.0);
  for (std::size_t k = 3; k < poses.size(); k += 7) poses[k] = 1;
  impl.finish();
  impl.buffers.upload<block::InputIds>(context, std::vector<int>(slots, kNoObject));
  impl.buffers.upload<block::InputPoses>(context, poses);
  impl.buffers.upload<block::InputLoads>(context, std::vector<float>(impl.takesContacts() ? 0 : n, kPoseDriven));
  const OutputArrays imported = impl.buffers.exportArrays({impl.data(), impl.options, impl.keeps_candidates}, true, import);
  impl.places = true;
  ExportedInputs inputs;
  if (impl.takesContacts()) {
    inputs.positions = imported.writable<block::InputPositions>(3 * contacts);
    inputs.normal_forces = imported.writable<block::InputForces>(contacts);
    inputs.num_contacts = imported.writable<block::InputCounts>(n);
  } else {
    inputs.ids = imported.writable<block::InputIds>(slots);
    inputs.poses = imported.writable<block::InputPoses>(7 * slots);
    inputs.loads = imported.writable<block::InputLoads>(n);
  }
  return inputs;
}

void Simulator::Impl::checkInputs(std::size_t frame_half) const {
  if (!places) return;
  const std::span<const std::uint32_t> problems = buffers.output<block::InputProblems>(frame_half);
  const auto refuse = [&](std::uint32_t word, const std::string& allowed) {
    if (problems[word] == 0) return;
    const std::uint32_t instance = static_cast<std::uint32_t>(options.num_instances) - problems[word];
    throw Error(ErrorKind::kInput, "inputs of instance " + std::to_string(instance) + ": " + allowed);
  };
  refuse(PlaceInterface::kObjectProblems, "an object or a pose is not allowed: objects 0 to " + std::to_string(data().objects.size() - 1) +
                                              " or -1 for none, finite positions, quaternions of length 1");
  refuse(PlaceInterface::kContactProblems, "contact points are not allowed: 0 to " + std::to_string(options.max_contacts) +
                                               " of them, positions of -1e6 to 1e6 m, normal forces of 0 to 1e6 N");
  refuse(PlaceInterface::kLoadProblems, takes_loads ? "the load is not allowed: N, >= 0, or NaN for none"
                                                    : "a load is not allowed: NaN for none, as prepare() was not called with loads");
}

int Simulator::exportTimeline() const {
  return impl_->timeline ? impl_->timeline->exportDescriptor(impl_->data().context()) : -1;
}

std::uint64_t Simulator::endOfStep() const {
  return impl_->points.end;
}

void Simulator::beginAfterConsumer() {
  impl_->points.after = impl_->points.end + 1;
}

}  // namespace taxelsim
