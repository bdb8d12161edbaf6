#include "episodes/batch.h"

#include <algorithm>
#include <future>
#include <string>

#include "base/thread_priority.h"
#include "taxelsim/error.h"

namespace taxelsim {

void checkCount(const char* name, std::int64_t value) {
  if (value < 1) throw Error(ErrorKind::kInput, std::string(name) + ": " + std::to_string(value) + " is not allowed: at least 1");
}

std::vector<int> splitBatch(const Model& model, const SlicePlan& plan, int batch_size, int num_slices) {
  num_slices = std::min(num_slices, batch_size);
  const MemoryPlan memory = plan.memory(model, batch_size);
  const std::uint64_t bytes_per_instance = memory.bytes_per_instance * static_cast<std::uint64_t>(plan.num_sensors);
  const std::uint64_t available = model.device().info().memory;
  const std::uint64_t fixed = memory.bytes_fixed * static_cast<std::uint64_t>(num_slices);
  const std::uint64_t needed = fixed + bytes_per_instance * static_cast<std::uint64_t>(batch_size);
  if (needed > available) {
    const std::uint64_t num_fitting = available > fixed ? (available - fixed) / std::max<std::uint64_t>(bytes_per_instance, 1) : 0;
    throw Error(ErrorKind::kInput, "batch size: " + std::to_string(batch_size) + " instances in " + std::to_string(num_slices) +
                                       " slices need " + std::to_string(needed) + " bytes of device memory, " + std::to_string(available) +
                                       " are available; at most " + std::to_string(num_fitting) + " instances fit");
  }
  std::vector<int> sizes;
  for (int s = 0; s < num_slices; ++s) sizes.push_back(batch_size / num_slices + (s < batch_size % num_slices ? 1 : 0));
  return sizes;
}

void runEpisodes(const Device& device, std::span<const std::unique_ptr<Slice>> slices, const std::atomic<bool>* stop,
                 const std::function<void(const Slice::Stats&)>& after_frame) {
  const auto run_slices = [&] {
    if (device.info().type == DeviceType::kCpu) lowerThreadPriority();
    for (const auto& slice : slices) {
      if (slice->busy()) slice->submit();
    }
    bool any_busy = true;
    while (any_busy) {
      any_busy = false;
      for (const auto& slice : slices) {
        if (!slice->busy()) continue;
        if (stop && stop->load(std::memory_order_relaxed)) {
          for (const auto& other : slices) {
            if (other->busy()) other->discard();
          }
          return;
        }
        const Slice::Stats stats = slice->collect();
        if (slice->busy()) {
          slice->submit();
          any_busy = true;
        }
        after_frame(stats);
      }
    }
  };
  std::async(std::launch::async, run_slices).get();
}

}  // namespace taxelsim
