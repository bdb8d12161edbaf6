#include "sensor/curve.h"
#include "taxelsim/sensor.h"

namespace taxelsim {

double nominalForce(const Readout& readout, double counts) {
  if (!(counts > 0)) return 0;
  if (!readout.curve_points.empty()) return invertPoints(readout.curve_points, counts / readout.output_scale) + readout.trigger;
  return invertCurve(readout.curve, withoutLimit(counts / readout.output_scale, readout.curve_limit)) + readout.trigger;
}

}  // namespace taxelsim
