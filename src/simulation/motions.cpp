#include "simulation/motions.h"

#include <algorithm>
#include <cmath>

#include "taxelsim/simulator.h"

namespace taxelsim {
namespace {

static_assert(kMaxSlots <= 1 << layout::kSlotBits);

// to from^-1. Terms are paired so that they cancel exactly for an object at rest.
Quaternion rotationBetween(const Quaternion& from, const Quaternion& to) {
  const auto& [w, x, y, z] = from;
  const auto& [tw, tx, ty, tz] = to;
  return {tw * w + tx * x + ty * y + tz * z, (tx * w - tw * x) + (tz * y - ty * z), (ty * w - tw * y) + (tx * z - tz * x),
          (tz * w - tw * z) + (ty * x - tx * y)};
}

// R - 1, row-major. Computed from the quaternion, so that a small rotation keeps all its digits.
std::array<double, 9> rotationMinusIdentity(const Quaternion& q) {
  const auto [w, x, y, z] = q;
  return {-2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y), 2 * (x * y + w * z), -2 * (x * x + z * z),
          2 * (y * z - w * x),  2 * (x * z - w * y), 2 * (y * z + w * x), -2 * (x * x + y * y)};
}

// Keeps the product with the stiffness inside float32. An object that jumps farther slips in any case.
float clamped(double displacement) {
  constexpr double kMax = 1e6;  // m
  return static_cast<float>(std::clamp(displacement, -kMax, kMax));
}

// D = X_to X_from^-1 - 1: p -> (R - 1) p + t with t = (p_to - p_from) - (R - 1) p_from.
layout::MotionRecord motionBetween(const Pose& from, const Pose& to) {
  const std::array<double, 9> R_minus_1 = rotationMinusIdentity(rotationBetween(from.rotation, to.rotation));
  layout::MotionRecord record{};
  for (std::size_t i = 0; i < 3; ++i) {
    double t = to.position[i] - from.position[i];
    for (std::size_t j = 0; j < 3; ++j) t -= R_minus_1[3 * i + j] * from.position[j];
    glm::vec4& row = i == 0 ? record.row0 : i == 1 ? record.row1 : record.row2;
    row = {static_cast<float>(R_minus_1[3 * i]), static_cast<float>(R_minus_1[3 * i + 1]), static_cast<float>(R_minus_1[3 * i + 2]),
           clamped(t)};
  }
  record.known.x = 1;
  return record;
}

}  // namespace

Motions::Motions(std::size_t num_instances, std::size_t num_slots)
    : num_slots_(num_slots), now_(num_instances * num_slots, {kNoObject, {}}), before_(now_) {}

void Motions::place(std::size_t index, int id, const Pose& X_SO) {
  now_[index] = {id, {X_SO.position, X_SO.rotation * Quaternion{1, 0, 0, 0}}};  // the product is of unit length
}

void Motions::forget(std::size_t instance) {
  for (std::size_t slot = 0; slot < num_slots_; ++slot) before_[instance * num_slots_ + slot].id = kNoObject;
}

void Motions::pack(std::size_t instance, float load_offset, std::uint32_t near, std::span<layout::MotionRecord> records) {
  std::size_t num_packed = 0;
  for (std::size_t slot = 0; slot < num_slots_; ++slot) {
    const Placed& now = now_[instance * num_slots_ + slot];
    Placed& before = before_[instance * num_slots_ + slot];
    before.X_SO.position[2] += load_offset;
    if ((near >> slot & 1u) != 0) {
      const bool is_known = now.id != kNoObject && now.id == before.id;
      layout::MotionRecord& record = records[num_packed++];
      record = is_known ? motionBetween(before.X_SO, now.X_SO) : layout::MotionRecord{};
      record.known.y = static_cast<float>(slot);
    }
    before = now;
  }
  constexpr layout::MotionRecord kEmpty{{}, {}, {}, {0, -1, 0, 0}};
  std::fill(records.begin() + static_cast<std::ptrdiff_t>(num_packed), records.end(), kEmpty);
}

}  // namespace taxelsim
