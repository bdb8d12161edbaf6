#include "simulation/near_slots.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "base/pose_inline.h"
#include "taxelsim/simulator.h"

namespace taxelsim {
namespace {

static_assert(kMaxSlots <= 8, "a slot is a bit of a byte");

constexpr layout::PoseRecord kEmpty{{}, {}, {}, {kNoObject, 0, 0, 0}};

Quaternion unitRotation(const Pose& X_SO) {
  const auto& [w, x, y, z] = X_SO.rotation;
  const double length = std::sqrt(w * w + x * x + y * y + z * z);
  return {w / length, x / length, y / length, z / length};
}

// `R_SO`: of unit length.
void packPose(int id, const Quaternion& R_SO, const Vector3& p_SO, std::size_t slot, layout::PoseRecord& record) {
  const std::array<double, 9> rotation = inlined::rotationMatrix(R_SO);
  const auto setRow = [&](glm::vec4& row, std::size_t i) {
    row.x = static_cast<float>(rotation[3 * i]);
    row.y = static_cast<float>(rotation[3 * i + 1]);
    row.z = static_cast<float>(rotation[3 * i + 2]);
    row.w = static_cast<float>(p_SO[i]);
  };
  setRow(record.row0, 0);
  setRow(record.row1, 1);
  setRow(record.row2, 2);
  record.object = {static_cast<float>(id), static_cast<float>(slot), 0.0f, 0.0f};
}

float largestSpacing(const PackedSensor& packed) {
  float spacing = 0;
  for (const layout::PatchRecord& patch : packed.patches) spacing = std::max({spacing, patch.spacing.x, patch.spacing.y});
  return spacing;
}

// The rotation of three rows (R | p).
template <typename Rows>
glm::mat3 rotationOf(const Rows& rows) {
  return glm::transpose(glm::mat3(glm::vec3(rows.row0), glm::vec3(rows.row1), glm::vec3(rows.row2)));
}

template <typename Rows>
glm::vec3 positionOf(const Rows& rows) {
  return {rows.row0.w, rows.row1.w, rows.row2.w};
}

}  // namespace

NearSlots::NearSlots(const ModelData& model, std::size_t num_instances, std::size_t num_slots)
    : model_(model),
      num_slots_(num_slots),
      placed_(num_instances * num_slots),
      occupied_(num_instances, 0),
      near_(num_instances, 0),
      packed_(num_instances, 0) {
  const PackedSensor& packed = model.contact_packed;
  // The cell of a sample ends half a spacing from it; slopes of depth are read up to a spacing over the skin. The rest covers rounding.
  const float margin = largestSpacing(packed);
  const float top = std::max(model.law.reach, margin) + margin;
  const auto samples = static_cast<float>(model.contact_sensor.samples_per_taxel);
  for (const layout::PatchRecord& patch : packed.patches) {
    const glm::vec2 half = 0.5f * samples * glm::vec2(patch.grid) * glm::vec2(patch.spacing) + margin;
    const glm::mat3 R_PS = rotationOf(patch), R_SP = glm::transpose(R_PS);
    if (packed.patches.size() == 1) {
      // Surfaces count however deep they are, unless all of their object is behind the skin.
      const float base = static_cast<float>(-model.sensor.skin.thickness) - margin;
      region_ = {R_PS, positionOf(patch), {-half.x, -half.y, base}, {half.x, half.y, top}, R_SP[2]};
      return;
    }
    const float bottom = -patch.spacing.w - margin;
    for (unsigned corner = 0; corner < 8; ++corner) {
      const glm::vec3 p_PQ((corner & 1u) != 0 ? half.x : -half.x, (corner & 2u) != 0 ? half.y : -half.y, (corner & 4u) != 0 ? top : bottom);
      const glm::vec3 p_SQ = R_SP * (p_PQ - positionOf(patch));
      region_.low = glm::min(region_.low, p_SQ);
      region_.high = glm::max(region_.high, p_SQ);
    }
  }
}

bool NearSlots::isBehind(const layout::ObjectRecord& object, const layout::PoseRecord& X_SO) const {
  const glm::vec3& normal = region_.normal;
  const glm::vec3 n_O = glm::vec3(X_SO.row0) * normal.x + glm::vec3(X_SO.row1) * normal.y + glm::vec3(X_SO.row2) * normal.z;
  const float center = region_.p_RS.z + glm::dot(normal, positionOf(X_SO)) + glm::dot(n_O, glm::vec3(object.center));
  return center + glm::dot(glm::abs(n_O), glm::vec3(object.half_size)) < region_.low.z;
}

bool NearSlots::reaches(const layout::ObjectRecord& object, const layout::PoseRecord& X_SO) const {
  constexpr float kRounding = 1e-5f;  // of the object's size and distance
  const auto isOutside = [this](const glm::vec3& center, const glm::vec3& half) {
    const glm::vec3 reach = half + kRounding * (half + glm::abs(center));
    // Written so that NaN is near.
    return glm::any(glm::greaterThan(center - reach, region_.high)) || glm::any(glm::lessThan(center + reach, region_.low));
  };
  const glm::vec3 origin = region_.R_RS * positionOf(X_SO) + region_.p_RS;
  // A sphere about the origin of O costs no rotation.
  if (isOutside(origin, glm::vec3(glm::length(glm::abs(glm::vec3(object.center)) + glm::vec3(object.half_size))))) return false;
  const glm::mat3 R_RO = region_.R_RS * rotationOf(X_SO);
  const glm::vec3 size(object.half_size);
  return !isOutside(origin + R_RO * glm::vec3(object.center),
                    glm::abs(R_RO[0]) * size.x + glm::abs(R_RO[1]) * size.y + glm::abs(R_RO[2]) * size.z);
}

void NearSlots::place(std::size_t instance, std::size_t slot, int id, const Pose& X_SO) {
  const std::size_t index = instance * num_slots_ + slot;
  const bool is_occupied = id != kNoObject;
  if (is_occupied) packPose(id, unitRotation(X_SO), X_SO.position, slot, placed_[index]);
  const auto set = [bit = 1u << slot](std::uint8_t& bits, bool value) {
    bits = static_cast<std::uint8_t>(value ? bits | bit : bits & ~bit);
  };
  set(occupied_[instance], is_occupied);
  if (!is_occupied) return set(near_[instance], false);
  const layout::ObjectRecord& object = model_.object_records[static_cast<std::size_t>(id)];
  // With one slot the device itself finds what is near, except that it sees surfaces however deep they are.
  set(near_[instance], num_slots_ == 1 ? !isBehind(object, placed_[index]) : reaches(object, placed_[index]));
}

void NearSlots::placeAll(std::span<const int> ids, std::span<const Pose> X_SO, std::size_t first, std::size_t last) {
  if (num_slots_ > 1) {
    for (std::size_t k = first * num_slots_; k < last * num_slots_; ++k) place(k / num_slots_, k % num_slots_, ids[k], X_SO[k]);
    return;
  }
  constexpr std::size_t kChunk = 64;
  std::array<Quaternion, kChunk> rotations;
  for (; first < last; first += kChunk) {
    const std::size_t end = std::min(first + kChunk, last);
    for (std::size_t i = first; i < end; ++i) rotations[i - first] = unitRotation(X_SO[i]);
    for (std::size_t i = first; i < end; ++i) {
      occupied_[i] = ids[i] != kNoObject;
      if (occupied_[i]) packPose(ids[i], rotations[i - first], X_SO[i].position, 0, placed_[i]);
    }
    for (std::size_t i = first; i < end; ++i) {
      near_[i] = occupied_[i] && !isBehind(model_.object_records[static_cast<std::size_t>(ids[i])], placed_[i]);
    }
  }
}

layout::PoseRecord NearSlots::packOnly(std::size_t instance, float load) const {
  const std::uint8_t is_packed = std::isnan(load) ? near_[instance] : occupied_[instance];
  return is_packed != 0 ? placed_[instance] : kEmpty;
}

std::size_t NearSlots::pack(std::span<const float> loads, std::span<layout::PoseRecord> poses, ThreadTeam& team) {
  int most = 1;
  for (std::size_t i = 0; i < near_.size(); ++i) {
    packed_[i] = std::isnan(loads[i]) ? near_[i] : occupied_[i];
    most = std::max(most, std::popcount(packed_[i]));
  }
  const auto stride = static_cast<std::size_t>(most);
  team.run(static_cast<int>(near_.size()), [&](int first, int last) {
    for (auto i = static_cast<std::size_t>(first); i < static_cast<std::size_t>(last); ++i) {
      std::size_t count = 0;
      for (std::uint32_t left = packed_[i]; left != 0; left &= left - 1) {
        poses[i * stride + count++] = placed_[i * num_slots_ + static_cast<std::size_t>(std::countr_zero(left))];
      }
      for (; count < stride; ++count) poses[i * stride + count] = kEmpty;
    }
  });
  return stride;
}

}  // namespace taxelsim
