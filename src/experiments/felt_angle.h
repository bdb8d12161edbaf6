// The edge angle that a controller uses.
#pragma once

#include <optional>

#include "taxelsim/control.h"
#include "taxelsim/simulator.h"

namespace taxelsim {

// Edge angle of one instance, rad; none for the exact angle, which is not in the frame.
inline std::optional<double> feltAngle(const TactileServo& servo, const FrameView& view, std::size_t instance) {
  if (servo.edge_angle_source == EdgeAngleSource::kExact) return {};
  if (!needsContactFeatures(servo)) return view.edge_angle[instance];
  const ContactFeatureView& contact = view.contact;
  const auto region = static_cast<std::size_t>(servo.contact == ServoContact::kLargestRegion ? 1 + contact.num_patches : 0);
  const std::size_t row = instance * static_cast<std::size_t>(contact.num_rows) + region;
  if (servo.edge_angle_source == EdgeAngleSource::kRidge) return contact.ridge_edge_angle[row];
  return servo.edge_angle_source == EdgeAngleSource::kWindow ? contact.windowed_edge_angle[row] : contact.edge_angle[row];
}

}  // namespace taxelsim
