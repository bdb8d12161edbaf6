// Outputs and inputs of a simulator in the memory of another interface of its GPU.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "frame_views.h"
#include "interop/gpu.h"
#include "taxelsim/simulator.h"

namespace taxelsim::python {

// Joins the exports of a simulator with their imports, and orders steps and the streams of libraries that read frames or write inputs:
// steps wait for the work that streams had when they began, streams for the last step. Where the driver exports a timeline semaphore the
// device waits, else the host.
//
// Threads: one at a time. The simulator must outlive it.
class SharedArrays {
 public:
  // Throws Error(kDevice).
  SharedArrays(Simulator& simulator, interop::Platform platform);
  ~SharedArrays();
  SharedArrays(const SharedArrays&) = delete;
  SharedArrays& operator=(const SharedArrays&) = delete;

  // Its spans hold addresses of the GPU.
  const FrameView& frame() const { return frame_; }
  // Imported at the first call. Steps take them from then on.
  const ExportedInputs& inputs();
  // The GPU, as DLPack names it.
  ArrayDevice device() const;

  // A stream that uses the arrays from now on. It waits for the last step.
  void addConsumer(interop::Stream stream);
  // All consumers wait for the last step.
  void releaseStep();
  // After a step was submitted: where the device can order them, consumers wait for it at once, so that what they write does not overtake
  // it.
  void stepSubmitted() {
    if (timeline_) releaseStep();
  }
  // The next step waits for what the consumers have been given to do so far.
  void holdNextStep();

  // Waits for the last step on the host, and copies.
  void copyToHost(void* to, const void* from, std::size_t bytes);

 private:
  void* import(int descriptor, std::uint64_t bytes);
  void letWait(interop::Stream stream);

  Simulator& simulator_;
  interop::Platform platform_;
  std::shared_ptr<const interop::Gpu> gpu_;
  std::vector<interop::ImportedMemory> memory_;
  std::optional<interop::ImportedTimeline> timeline_;
  FrameView frame_;
  std::optional<ExportedInputs> inputs_;
  std::vector<interop::Stream> consumers_;
  std::uint64_t signalled_ = 0;  // last value that a consumer signals
};

// `shared`, or std::logic_error for null.
SharedArrays& requireShared(SharedArrays* shared);

// Bytes of one of the arrays to the host. `result`: of its size.
void copyToHost(SharedArrays& shared, const nb::ndarray<nb::ro>& array,
                const nb::ndarray<std::uint8_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>& result);

// The methods that DeviceArray calls. The owner has withShared(use), which calls `use(shared arrays)` without the GIL.
template <typename Owner>
void bindShared(nb::class_<Owner>& owner) {
  owner
      .def(
          "add_consumer",
          [](Owner& self, interop::Stream stream) { self.withShared([&](SharedArrays& shared) { shared.addConsumer(stream); }); },
          "stream"_a)
      .def(
          "copy_to_host",
          [](Owner& self, const nb::ndarray<nb::ro>& array,
             const nb::ndarray<std::uint8_t, nb::ndim<1>, nb::c_contig, nb::device::cpu>& result) {
            self.withShared([&](SharedArrays& shared) { copyToHost(shared, array, result); });
          },
          "array"_a, "result"_a);
}

}  // namespace taxelsim::python
