#include "reference/load.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <utility>

#include "base/vector3.h"
#include "reference/area_depth.h"
#include "reference/contact.h"

namespace taxelsim::reference {
namespace {

// Bisection to the last bit: adjacent doubles in [low, high] between which `holds` changes from true (at low) to false (at high).
std::pair<double, double> bisect(double low, double high, const std::function<bool(double)>& holds) {
  for (double middle = low + (high - low) / 2; middle > low && middle < high; middle = low + (high - low) / 2) {
    (holds(middle) ? low : high) = middle;
  }
  return {low, high};
}

// DepthSampling::kPoint: offset at which a surface first reaches a sample along z of S; -infinity if no object is over any sample.
double firstTouch(const Sensor& sensor, std::span<const PlacedObject> objects) {
  std::vector<double> heights;
  for (const GridPatch& patch : sensor.patches) {
    const Vector3 direction_P = rotate(inverse(patch.X_SP).rotation, {0, 0, 1});
    if (direction_P[2] > 0) {  // a patch that faces away is not touched first
      appendHeights(patch, sensor.samples_per_taxel, objects, {.direction_P = direction_P}, heights);
    }
  }
  double lowest = std::numeric_limits<double>::infinity();
  for (const double height : heights) {
    lowest = std::min(lowest, height);
  }
  return -lowest;
}

bool allPatchesAreLevel(const Sensor& sensor) {
  return std::all_of(sensor.patches.begin(), sensor.patches.end(), [](const GridPatch& patch) {
    const Vector3 normal_S = rotate(patch.X_SP.rotation, {0, 0, 1});
    return normal_S[0] == 0 && normal_S[1] == 0 && normal_S[2] == 1;
  });
}

// First offset, going down from first touch, at which the deepest sample reaches the skin thickness. Over a tilted patch an object may
// slide off before: then the sampled offset with the largest depth.
double fullDepth(double first_touch, double thickness, const std::function<double(double)>& deepestAt) {
  constexpr int kStepsPerThickness = 16;
  constexpr int kTravelInThicknesses = 6;  // reaches the thickness on patches tilted by up to 80 degrees
  const auto isFull = [&](double offset) { return deepestAt(offset) >= thickness; };
  double best = first_touch, deepest = 0;
  for (int n = 1; n <= kTravelInThicknesses * kStepsPerThickness; ++n) {
    const double upper = first_touch - (n - 1) * thickness / kStepsPerThickness, offset = first_touch - n * thickness / kStepsPerThickness;
    const double depth = deepestAt(offset);
    if (depth >= thickness) {
      return bisect(offset, upper, isFull).first;
    }
    if (depth > deepest) {
      deepest = depth;
      best = offset;
    }
  }
  return best;
}

}  // namespace

double forceAlongLoad(const Sensor& sensor, const Contact& contact) {
  double force = 0;
  std::size_t taxel = 0;
  for (const GridPatch& patch : sensor.patches) {
    const double along_load = rotate(patch.X_SP.rotation, {0, 0, 1})[2];
    const std::size_t end = taxel + static_cast<std::size_t>(patch.num_rows) * patch.num_cols;
    for (; taxel < end; ++taxel) force += along_load * contact.taxel_force[taxel];
  }
  return force;
}

std::vector<PlacedObject> movedAlongZ(std::span<const PlacedObject> objects, double offset) {
  std::vector<PlacedObject> moved(objects.begin(), objects.end());
  for (PlacedObject& placed : moved) {
    placed.X_SO.position[2] += offset;
  }
  return moved;
}

LoadResult findLoad(const Sensor& sensor, std::span<const PlacedObject> objects, double load, const SkinStep& skin) {
  const double thickness = sensor.skin.thickness;
  LoadResult result;
  const bool is_area = sensor.depth_sampling == DepthSampling::kArea;
  const AreaDepth area(sensor, is_area ? objects : std::span<const PlacedObject>{});
  result.first_touch = is_area ? area.firstTouch() : firstTouch(sensor, objects);
  if (!std::isfinite(result.first_touch)) {
    result.first_touch = 0;
    return result;
  }

  // Level patches: the heights shift with the offset. Tilted patches: objects also move sideways, so heights are recomputed. Means over
  // cells are recomputed in any case.
  const bool level = allPatchesAreLevel(sensor);
  const std::vector<double> heights = level && !is_area ? surfaceHeights(sensor, objects) : std::vector<double>{};
  const auto penetrationsAt = [&](double offset) {
    if (is_area) return area.at(offset).mean;
    if (!level) {
      return penetrations(surfaceHeights(sensor, movedAlongZ(objects, offset)), thickness);
    }
    std::vector<double> moved = heights;
    for (double& height : moved) height += offset;
    return penetrations(moved, thickness);
  };
  const auto largest = [](const std::vector<double>& d) { return *std::max_element(d.begin(), d.end()); };
  const auto deepestAt = [&](double offset) { return largest(is_area ? coveredDepths(area.at(offset)) : penetrationsAt(offset)); };
  const auto contactAt = [&](double offset) {
    return is_area ? computeContact(sensor, area.at(offset), {}, 0, skin) : computeContact(sensor, penetrationsAt(offset), {}, 0, skin);
  };
  const auto forceAt = [&](double offset) { return forceAlongLoad(sensor, contactAt(offset)); };

  if (!level) {
    // A side wall of an object may touch a tilted patch earlier than its lowest point does.
    const auto touches = [&](double offset) { return largest(penetrationsAt(offset)) > 0; };
    constexpr double kMaxWallHeight = 0.2;  // m: also ends the search if a patch that faces down is touched at every offset
    const double seen_along_z = result.first_touch;
    double upper = seen_along_z;
    while (touches(upper)) {
      upper += thickness / 8;
      if (upper > seen_along_z + kMaxWallHeight) {
        return result;
      }
    }
    const double lower = upper > seen_along_z ? upper - thickness / 8 : seen_along_z - thickness / 16;
    if (touches(lower)) {
      result.first_touch = bisect(lower, upper, touches).second;
    }
  }
  result.full_depth = result.first_touch - thickness;
  if (is_area || !level) {
    const double full = fullDepth(result.first_touch, is_area ? kFullDepth * thickness : thickness, deepestAt);
    // A pin that nowhere covers enough of a cell has no full depth.
    if (!is_area || full < result.first_touch) result.full_depth = full;
  }
  if (forceAt(result.full_depth) < load) {
    result.offset = result.full_depth;
    return result;
  }
  if (load <= 0) {  // rests at first touch, or on the bottom of a residual dent
    result.offset = bisect(result.full_depth, result.first_touch, [&](double offset) { return forceAt(offset) > 0; }).second;
    result.reached = true;
    return result;
  }
  result.offset = bisect(result.full_depth, result.first_touch, [&](double offset) { return forceAt(offset) >= load; }).first;
  // The force jumps where an edge of an object slides onto a tilted patch. No offset carries a load inside the jump.
  constexpr double kLoadTolerance = 1e-6;  // relative
  result.reached = forceAt(result.offset) <= load * (1 + kLoadTolerance);
  return result;
}

}  // namespace taxelsim::reference
