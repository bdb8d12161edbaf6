#include "episodes/sensor_features.h"

namespace taxelsim {

ServoInput featuresOfSensor(const FrameView& frame, int num_sensors, int sensor, bool contact_features) {
  const FeatureView& features = contact_features ? static_cast<const FeatureView&>(frame.contact) : frame;
  const int rows = contact_features ? frame.contact.num_rows : 1;
  return {.num_rows = num_sensors * rows,
          .whole_row = sensor * rows,
          .region_row = sensor * rows + 1 + frame.contact.num_patches,
          .edge_angle = features.edge_angle,
          .edge_confidence = features.edge_confidence,
          .total_force = features.total_force,
          .center_of_pressure = features.center_of_pressure,
          .contact_area = features.contact_area,
          .windowed_edge_angle = frame.contact.windowed_edge_angle,
          .windowed_edge_confidence = frame.contact.windowed_edge_confidence,
          .ridge_edge_angle = frame.contact.ridge_edge_angle,
          .ridge_edge_confidence = frame.contact.ridge_edge_confidence,
          .tilt = frame.contact.tilt,
          .tilt_confidence = frame.contact.tilt_confidence,
          .num_jacobian_rows = num_sensors * frame.jacobian.num_rows,
          .jacobian_row = sensor * frame.jacobian.num_rows,
          .center_jacobian = frame.jacobian.center_of_pressure,
          .force_jacobian = frame.jacobian.total_force,
          .edge_angle_jacobian = frame.jacobian.edge_angle,
          .exact_edge_angle = {},
          .start_force = {},
          .due = {}};
}

}  // namespace taxelsim
