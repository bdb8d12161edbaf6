// Outputs in the memory of another interface of the device, and the timeline that orders both sides.
#include <stdexcept>

#include "simulation/batch_plan.h"
#include "simulation/frame_view.h"
#include "simulation/simulator_impl.h"

namespace taxelsim {

FrameView Simulator::exportOutputs(const ImportMemory& import) {
  Impl& impl = *impl_;
  if (!impl.options.export_outputs) throw std::logic_error("exportOutputs() needs a simulator with export_outputs: true");
  const OutputArrays imported = impl.buffers.exportOutputs({impl.data(), impl.options, impl.keeps_candidates}, import);
  ExportedIntegers exported(
      {imported.output<block::Features>(), imported.output<block::ContactFeatures>(), imported.output<block::CleanContactFeatures>()},
      reinterpret_cast<const std::byte*>(imported.output<block::IntegerFeatures>().data()));
  IntegerFeatures integers(exported);
  const FrameView view = viewOf(impl.data(), impl.options, imported, integers);
  std::ranges::copy(exported.rows(), impl.buffers.input<block::IntegerRows>().begin());
  return view;
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
