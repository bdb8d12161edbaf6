#include "scene/skin_ranges.h"

#include <algorithm>
#include <string>

#include "base/field_checks.h"

namespace taxelsim {

namespace {

template <typename Table>
bool isAnyGiven(const Table& table, const Randomization& randomization) {
  return std::any_of(table.begin(), table.end(), [&](const auto& entry) { return (randomization.*entry.range).has_value(); });
}

}  // namespace

bool variesSkin(const Randomization& randomization) {
  return isAnyGiven(kSkinRanges, randomization);
}

bool variesMounting(const Randomization& randomization) {
  return isAnyGiven(kMountingRanges, randomization);
}

void checkSkinRanges(const Randomization& randomization, const Sensor& sensor) {
  for (const SkinRange& entry : kSkinRanges) {
    const std::optional<Range>& range = randomization.*entry.range;
    if (!range) continue;
    for (const double limit : {range->min, range->max}) {
      SkinVariation variation;
      variation.*entry.value = static_cast<float>(limit);
      checkVariation(sensor, variation);
    }
  }
}

}  // namespace taxelsim
