#include "reference/frame.h"

#include "reference/area_depth.h"
#include "reference/psf.h"

namespace taxelsim::reference {
namespace {

// Stages 1 and 2 for law ElasticLayer.
void solveElasticLayer(const Sensor& sensor, const FrameInput& input, const SkinStep& skin, Frame& frame) {
  LayerContact solved =
      input.load ? loadedLayerContact(sensor, input.objects, *input.load, skin) : layerContact(sensor, input.objects, skin);
  if (input.skin) input.skin->advance(input.dt, solved.strain, solved.dent_compliance);
  const std::vector<PlacedObject> placed = movedAlongZ(input.objects, solved.offset);
  frame.shear = contactShear(sensor, placed, pressedNodes(sensor, placed, solved), input.previous_friction, input.dt);
  frame.load.offset = solved.offset;
  frame.load.reached = solved.load_reached;
  frame.contact.taxel_force = solved.taxel_force;
  frame.contact.mean_penetration = solved.mean_penetration;
  frame.contact.wrench = solved.wrench;
  frame.contact.total_force = solved.total_force;
  frame.contact.over_penetration = solved.over_penetration;
  frame.off_array_load = solved.off_array_load;
  frame.layer = std::move(solved);
}

}  // namespace

Frame simulateFrame(const Sensor& sensor, const FrameInput& input) {
  Frame frame;
  frame.load.reached = true;
  const SkinStep skin = input.skin ? input.skin->step(input.dt) : SkinStep{};
  const bool is_solved = std::holds_alternative<ElasticLayer>(sensor.skin.law);
  if (is_solved) {
    solveElasticLayer(sensor, input, skin, frame);
  } else if (input.load) {
    frame.load = findLoad(sensor, input.objects, *input.load, skin);
  }
  const std::vector<PlacedObject> placed = movedAlongZ(input.objects, frame.load.offset);
  frame.heights = surfaceHeights(sensor, placed);
  const bool is_area = sensor.depth_sampling == DepthSampling::kArea;
  const AreaDepths depths = is_area ? AreaDepth(sensor, placed).at() : AreaDepths{};
  frame.penetration = is_area ? depths.mean : penetrations(frame.heights, sensor.skin.thickness);
  frame.share = depths.share;
  frame.points = depths.points;
  if (!is_solved) {
    const std::span<const double> previous = input.previous_penetration;
    const std::span<const double> before = input.load ? std::span<const double>{} : previous;
    frame.contact = is_area ? computeContact(sensor, depths, before, input.dt, skin)
                            : computeContact(sensor, frame.penetration, before, input.dt, skin);
    if (is_area) frame.contact.over_penetration = overPenetration(sensor, depths);
    if (input.skin) input.skin->advance(input.dt, frame.contact.strain);
    const PressedSkin pressed = pressedSamples(sensor, placed, depths, frame.penetration, frame.contact.pressure);
    frame.shear = contactShear(sensor, placed, pressed, input.previous_friction, input.dt);
  }
  for (std::size_t i = 0; i < frame.wrench.size(); ++i) frame.wrench[i] = frame.contact.wrench[i] + frame.shear.wrench[i];
  if (!input.load) frame.taxel_state = input.taxel_state;
  frame.taxel_force = taxelResponse(sensor, frame.contact.taxel_force, input.dt, frame.taxel_state);
  frame.spread_force = spread(sensor, frame.taxel_force);
  frame.taxel_shear = taxelShear(sensor, frame.shear.taxel_force, frame.taxel_force);
  frame.spread_shear = spreadShear(sensor, frame.taxel_shear);
  frame.lagged_force = input.lag ? input.lag->step(frame.spread_force, input.dt) : frame.spread_force;
  frame.counts = readOut(sensor, frame.lagged_force, input.draw);
  frame.measured_force = measuredForce(sensor, frame.counts);
  frame.saturated = saturatedFraction(sensor, frame.counts);
  frame.clean = cleanFeatures(sensor, frame.spread_force);
  frame.measured = measuredFeatures(sensor, frame.counts);
  return frame;
}

}  // namespace taxelsim::reference
