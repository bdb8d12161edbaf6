#include "reference/frame.h"

#include "reference/psf.h"

namespace taxelsim::reference {

Frame simulateFrame(const Sensor& sensor, const FrameInput& input) {
  Frame frame;
  frame.load.reached = true;
  if (input.load) {
    frame.load = findLoad(sensor, input.objects, *input.load);
  }
  frame.heights = surfaceHeights(sensor, movedAlongZ(input.objects, frame.load.offset));
  frame.penetration = penetrations(frame.heights, sensor.skin.thickness);
  frame.contact =
      input.load ? contactOf(sensor, frame.penetration, {}, 0) : contactOf(sensor, frame.penetration, input.previous_penetration, input.dt);
  frame.spread_force = spread(sensor, frame.contact.taxel_force);
  frame.counts = readOut(sensor, frame.spread_force, input.draw);
  frame.measured_force = measuredForce(sensor, frame.counts);
  frame.saturated = saturatedFraction(sensor, frame.counts);
  frame.clean = cleanFeatures(sensor, frame.spread_force);
  frame.measured = measuredFeatures(sensor, frame.counts);
  return frame;
}

}  // namespace taxelsim::reference
