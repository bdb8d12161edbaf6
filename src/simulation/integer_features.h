// Features of a frame that are integers, flags or enums in a view. Kernels compute them as float32; the host converts those that it reads,
// the device those that another interface imports.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <new>
#include <span>
#include <vector>

#include "simulation/passes/interfaces.h"

namespace taxelsim {

// Rows of block IntegerRows: a header, three arrays of a frame, three of each kind of contact features.
inline constexpr std::uint32_t kMaxIntegerRows = 1 + 3 + 2 * 3;

// Buffers of features with such arrays.
enum IntegerSource : std::uint32_t { kFrameSource, kContactSource, kCleanContactSource, kNumIntegerSources };

// The arrays of block IntegerFeatures, as addresses of the interface that has imported it.
class ExportedIntegers {
 public:
  // `sources`: the imported features by IntegerSource, empty where there are none.
  ExportedIntegers(const std::array<std::span<const float>, kNumIntegerSources>& sources, const std::byte* integers)
      : sources_(sources), integers_(integers) {}

  // Where shaders/integer_features.comp writes the conversion of `values`, which lie in one of the sources.
  const void* place(std::span<const float> values, bool are_flags);

  // The header and a row for each array so far.
  std::vector<glm::uvec4> rows() const;

 private:
  std::array<std::span<const float>, kNumIntegerSources> sources_;
  const std::byte* integers_;
  std::uint32_t num_words_ = 0;
  std::vector<glm::uvec4> arrays_;
};

// Converts for a view. Reuses the memory of host arrays from frame to frame.
class IntegerFeatures {
 public:
  IntegerFeatures() = default;
  // Gives addresses of the importer in place of host arrays. `exported` must outlive this.
  explicit IntegerFeatures(ExportedIntegers& exported) : exported_(&exported) {}

  // Spans from before are invalid afterwards.
  void clear() { num_used_ = 0; }

  template <typename T>
  std::span<const T> convert(std::span<const float> values) {
    if (exported_ != nullptr) return {static_cast<const T*>(exported_->place(values, sizeof(T) == 1)), values.size()};
    static_assert(alignof(T) <= alignof(std::max_align_t));
    if (num_used_ == arrays_.size()) arrays_.emplace_back();
    std::vector<std::byte>& bytes = arrays_[num_used_++];
    bytes.resize(values.size() * sizeof(T));
    T* const first = reinterpret_cast<T*>(bytes.data());
    for (std::size_t i = 0; i < values.size(); ++i) {
      new (first + i) T(static_cast<T>(static_cast<std::int32_t>(values[i])));
    }
    return {first, values.size()};
  }

 private:
  ExportedIntegers* exported_ = nullptr;
  std::vector<std::vector<std::byte>> arrays_;
  std::size_t num_used_ = 0;
};

}  // namespace taxelsim
