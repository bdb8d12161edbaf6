#include "reference/contact_points.h"

#include <algorithm>
#include <cmath>

#include "base/vector3.h"

namespace taxelsim::reference {
namespace {

// Index of the cell that contains x (m from the middle of the row of cells); empty outside.
std::optional<int> cellAt(double x, int num_cells, double pitch) {
  if (std::abs(x) > num_cells * pitch / 2 + kRimTolerance) return std::nullopt;
  return std::clamp(static_cast<int>(std::floor(x / pitch + num_cells / 2.0)), 0, num_cells - 1);
}

struct AssignedTaxel {
  int taxel;
  const GridPatch* patch;
};

// Assignment in a list of taxels.
std::optional<AssignedTaxel> assignInList(const Sensor& sensor, const Vector3& p_SQ_S, double contact_band) {
  std::optional<AssignedTaxel> assigned;
  double nearest = 0.5;  // normalised squared distance: the ellipse through the taxel's corners
  for (std::size_t t = 0; t < sensor.patches.size(); ++t) {
    const GridPatch& patch = sensor.patches[t];
    const Vector3 p_PQ_P = inverse(patch.X_SP) * p_SQ_S;
    const double distance = std::pow(p_PQ_P[0] / patch.pitch[0], 2) + std::pow(p_PQ_P[1] / patch.pitch[1], 2);
    if (p_PQ_P[2] < -sensor.skin.thickness || p_PQ_P[2] > contact_band || !(distance < nearest)) continue;
    nearest = distance;
    assigned = AssignedTaxel{static_cast<int>(t), &patch};
  }
  return assigned;
}

std::optional<AssignedTaxel> assignTaxel(const Sensor& sensor, const Vector3& p_SQ_S, double contact_band) {
  if (isTaxelList(sensor)) return assignInList(sensor, p_SQ_S, contact_band);
  int first_taxel = 0;
  for (const GridPatch& patch : sensor.patches) {
    const Vector3 p_PQ_P = inverse(patch.X_SP) * p_SQ_S;
    const std::optional<int> i = cellAt(p_PQ_P[0], patch.num_rows, patch.pitch[0]);
    const std::optional<int> j = cellAt(p_PQ_P[1], patch.num_cols, patch.pitch[1]);
    if (i && j && p_PQ_P[2] >= -sensor.skin.thickness && p_PQ_P[2] <= contact_band) {
      return AssignedTaxel{first_taxel + *i * patch.num_cols + *j, &patch};
    }
    first_taxel += patch.num_rows * patch.num_cols;
  }
  return std::nullopt;
}

}  // namespace

std::optional<int> taxelAt(const Sensor& sensor, const Vector3& p_SQ_S, double contact_band) {
  const std::optional<AssignedTaxel> assigned = assignTaxel(sensor, p_SQ_S, contact_band);
  return assigned ? std::optional(assigned->taxel) : std::nullopt;
}

ContactSums sumContacts(const Sensor& sensor, std::span<const ContactPoint> contacts, double contact_band) {
  ContactSums sums;
  sums.taxel_force.assign(static_cast<std::size_t>(numTaxels(sensor)), 0);
  Vector3 force{0, 0, 0}, torque{0, 0, 0};
  for (const ContactPoint& contact : contacts) {
    const std::optional<AssignedTaxel> assigned = assignTaxel(sensor, contact.position, contact_band);
    if (!assigned) {
      sums.off_array_load += contact.normal_force;
      ++sums.off_array_contacts;
      continue;
    }
    sums.taxel_force[static_cast<std::size_t>(assigned->taxel)] += contact.normal_force;
    sums.total_force += contact.normal_force;
    const Vector3 contact_force = rotate(assigned->patch->X_SP.rotation, {0, 0, -contact.normal_force});
    force = add(force, contact_force);
    torque = add(torque, cross(contact.position, contact_force));
  }
  sums.wrench = {force[0], force[1], force[2], torque[0], torque[1], torque[2]};
  return sums;
}

}  // namespace taxelsim::reference
