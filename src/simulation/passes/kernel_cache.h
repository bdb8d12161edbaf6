// Kernels of a pass in the variants that batches need. Each is made when it is first needed and kept as long as the model.
#pragma once

#include <map>
#include <mutex>

namespace taxelsim {

// Threads: safe to use from several at once.
template <typename Variant, typename Made>
class KernelCache {
 public:
  // What `make` returns for this variant; valid as long as the cache.
  template <typename Make>
  const Made& get(const Variant& variant, const Make& make) const {
    const std::lock_guard lock(mutex_);
    const auto found = made_.find(variant);
    if (found != made_.end()) return found->second;
    return made_.emplace(variant, make()).first->second;
  }

 private:
  mutable std::mutex mutex_;
  mutable std::map<Variant, Made> made_;
};

// Variant of a pass that has one kernel.
struct OnlyVariant {
  auto operator<=>(const OnlyVariant&) const = default;  // NOLINT(modernize-use-nullptr): clang-tidy 14 misreads it
};

}  // namespace taxelsim
