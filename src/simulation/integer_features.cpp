#include "simulation/integer_features.h"

#include <algorithm>
#include <stdexcept>

namespace taxelsim {

const void* ExportedIntegers::place(std::span<const float> values, bool are_flags) {
  const auto source = std::find_if(sources_.begin(), sources_.end(), [&](std::span<const float> s) {
    return !s.empty() && values.data() >= s.data() && values.data() < s.data() + s.size();
  });
  if (source == sources_.end() || arrays_.size() + 1 == kMaxIntegerRows) throw std::logic_error("an array of integers without a source");
  const auto count = static_cast<std::uint32_t>(values.size());
  const auto number = static_cast<std::uint32_t>(source - sources_.begin());
  const auto first = static_cast<std::uint32_t>(values.data() - source->data());
  arrays_.emplace_back(are_flags ? number + IntegerFeaturesInterface::kFlags : number, first, count, num_words_);
  const std::byte* const address = integers_ + std::size_t{4} * num_words_;
  num_words_ += are_flags ? (count + 3) / 4 : count;
  return address;
}

std::vector<glm::uvec4> ExportedIntegers::rows() const {
  std::vector<glm::uvec4> rows{{arrays_.size(), num_words_, 0, 0}};
  rows.insert(rows.end(), arrays_.begin(), arrays_.end());
  return rows;
}

}  // namespace taxelsim
