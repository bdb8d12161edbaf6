#include "shared_arrays.h"

#include <algorithm>
#include <stdexcept>

namespace taxelsim::python {

SharedArrays::SharedArrays(Simulator& simulator, interop::Platform platform)
    : simulator_(simulator), platform_(platform), gpu_(interop::Gpu::open(platform, simulator.model().device().info().uuid)) {
  frame_ = simulator.exportOutputs([this](int descriptor, std::uint64_t bytes) { return import(descriptor, bytes); });
  if (const int descriptor = simulator.exportTimeline(); descriptor >= 0) timeline_.emplace(gpu_->importTimeline(descriptor));
}

SharedArrays::~SharedArrays() {
  try {
    for (const interop::Stream stream : consumers_) gpu_->synchronize(stream);
  } catch (const std::exception&) {  // NOLINT(bugprone-empty-catch): a destructor cannot report
  }
}

void* SharedArrays::import(int descriptor, std::uint64_t bytes) {
  memory_.push_back(gpu_->importMemory(descriptor, bytes));
  return reinterpret_cast<void*>(memory_.back().address());
}

const ExportedInputs& SharedArrays::inputs() {
  if (!inputs_) inputs_ = simulator_.exportInputs([this](int descriptor, std::uint64_t bytes) { return import(descriptor, bytes); });
  return *inputs_;
}

void SharedArrays::letWait(interop::Stream stream) {
  if (timeline_) {
    timeline_->waitFor(simulator_.endOfStep(), stream);
  } else {
    simulator_.read();
  }
}

void SharedArrays::addConsumer(interop::Stream stream) {
  if (std::find(consumers_.begin(), consumers_.end(), stream) == consumers_.end()) consumers_.push_back(stream);
  letWait(stream);
}

void SharedArrays::releaseStep() {
  for (const interop::Stream stream : consumers_) letWait(stream);
}

void SharedArrays::holdNextStep() {
  const std::uint64_t done = simulator_.endOfStep() + 1;
  // One stream can signal the end of its work; for others, and if a step failed after a signal, the host waits.
  const bool can_signal = timeline_ && consumers_.size() == 1 && signalled_ < done;
  if (can_signal) {
    timeline_->signal(done, consumers_.front());
    signalled_ = done;
    simulator_.beginAfterConsumer();
    return;
  }
  for (const interop::Stream stream : consumers_) gpu_->synchronize(stream);
}

void SharedArrays::copyToHost(void* to, const void* from, std::size_t bytes) {
  simulator_.read();
  gpu_->copyToHost(to, reinterpret_cast<interop::Address>(from), bytes);
}

ArrayDevice SharedArrays::device() const {
  return {platform_ == interop::Platform::kCuda ? nb::device::cuda::value : nb::device::rocm::value, gpu_->ordinal()};
}

SharedArrays& requireShared(SharedArrays* shared) {
  if (shared == nullptr) throw std::logic_error("no arrays are shared");
  return *shared;
}

void copyToHost(SharedArrays& shared, const nb::ndarray<nb::ro>& array,
                const nb::ndarray<std::uint8_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>& result) {
  if (array.nbytes() != result.nbytes()) throw std::logic_error("copy_to_host(): wrong result");
  shared.copyToHost(result.data(), array.data(), array.nbytes());
}

}  // namespace taxelsim::python
