#include "episodes/sensor_features.h"

namespace taxelsim {

ServoInput featuresOfSensor(const FrameView& frame, int num_sensors, int sensor, bool contact_features) {
  const int rows = contact_features ? frame.contact.num_rows : 1;
  ServoInput input{.num_rows = num_sensors * rows,
                   .whole_row = sensor * rows,
                   .region_row = sensor * rows + 1 + frame.contact.num_patches,
                   .features = frame.contact,
                   .num_jacobian_rows = num_sensors * frame.jacobian.num_rows,
                   .jacobian_row = sensor * frame.jacobian.num_rows,
                   .jacobian = frame.jacobian,
                   .exact_edge_angle = {},
                   .start_force = {},
                   .due = {}};
  if (!contact_features) static_cast<FeatureView&>(input.features) = frame;
  return input;
}

}  // namespace taxelsim
