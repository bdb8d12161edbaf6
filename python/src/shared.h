// A batch that several Python threads may call.
#pragma once

#include <mutex>

#include "bind.h"
#include "owned.h"
#include "taxelsim/environment.h"
#include "without_gil.h"

namespace taxelsim::python {

// Calls wait for each other, without the GIL.
template <typename Batch>
class Shared {
 public:
  Shared(const Device& device, const Scene& scene, const EnvironmentOptions& options) : batch_(device, scene, options) {}
  ~Shared() {
    const nb::gil_scoped_release release;  // waits for the device if a frame is unread
    const std::lock_guard lock(mutex_);
  }

  // Calls `use(batch)` without the GIL.
  template <typename Use>
  auto with(Use use) {
    const WithoutGil released;
    const std::lock_guard lock(mutex_);
    return use(batch_.get());
  }

  const Batch& get() const { return batch_.get(); }

 protected:
  // Takes no lock: for constructors, before other threads know the batch.
  Batch& batch() { return batch_.get(); }

 private:
  std::mutex mutex_;
  Owned<Batch> batch_;
};

}  // namespace taxelsim::python
