#include "scene/range_reader.h"

#include <array>
#include <vector>

namespace taxelsim {
namespace {

// A number, or [min, max].
Range readRange(const YamlMap& map, const RangeField& field, const std::optional<Range>& otherwise) {
  const std::optional<YamlNode> node = map.find(field.name());
  Range range = otherwise.value_or(Range{});
  if (!node && !otherwise) map.require(field.name(), "a number, or [min, max]");
  if (node && node->isList()) {
    const std::vector<double> numbers = node->numbers(field.allowed, 2);
    range = {numbers[0], numbers[1]};
    if (range.min > range.max) node->fail("[min, max] is not allowed with min > max");
  } else if (node) {
    range.min = range.max = node->number(field.allowed);
  }
  map.canonical().line(field.name(), canonicalList(std::array{range.min, range.max}));
  return range;
}

}  // namespace

void readRanges(const YamlMap& map, std::span<const RangeField> table, Randomization& random) {
  for (const RangeField& field : table) {
    if (const auto* member = std::get_if<Range Randomization::*>(&field.member)) {
      Range& range = random.*(*member);
      range = readRange(map, field, range);
    } else if (map.has(field.name())) {
      random.*std::get<1>(field.member) = readRange(map, field, {});
    }
  }
}

}  // namespace taxelsim
