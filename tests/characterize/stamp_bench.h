// A bench with flat stamps under dead weights, which the reference's stages simulate.
#pragma once

#include "base/philox.h"
#include "characterize/footprint.h"
#include "reference/frame.h"
#include "reference/lag.h"
#include "reference/psf.h"
#include "reference/readout.h"
#include "support/test.h"
#include "taxelsim/characterize.h"
#include "taxelsim/object.h"

namespace taxelsim::testing {

inline constexpr double kPitch = 3.4e-3, kFrame = 0.1;

inline Sensor baseSensor() {
  Sensor sensor;
  sensor.name = "stamped";
  sensor.patches = {{.name = "p", .num_rows = 6, .num_cols = 8, .pitch = {kPitch, kPitch}, .X_SP = {}}};
  sensor.skin.thickness = 2e-3;
  sensor.skin.law = Winkler{.normal_contact_stiffness = 1.73e8};
  sensor.psf = gaussianPsf(0.6, 5);
  sensor.readout.curve = {2000};
  sensor.readout.trigger = 0.03;
  sensor.readout.creep = {{.fraction = 0.2, .time = 3}};
  return sensor;
}

// 6 taxels along x over a cylinder about y, in rows of 5.
inline Sensor curvedSensor(double radius) {
  Sensor sensor = baseSensor();
  sensor.name = "curved";
  sensor.patches.clear();
  sensor.samples_per_taxel = 8;
  for (int i = 0; i < 7; ++i) {
    for (int j = 0; j < 6; ++j) {
      const double angle = (i - 3) * kPitch / radius;
      const Vector3 normal{std::sin(angle), 0, std::cos(angle)};
      sensor.patches.push_back(taxelPatch("t" + std::to_string(i) + "_" + std::to_string(j),
                                          {radius * normal[0], (j - 2.5) * kPitch, radius * (normal[2] - 1)}, normal, {kPitch, kPitch}));
    }
  }
  sensor.psf = {.size = 1, .kernel = {1}, .sigma = 0.6 * kPitch, .reach = 0};
  return sensor;
}

struct Press {
  double load = 5;  // N
  double x = 0, y = 0, yaw = 0;
  double gain = 1;   // of all taxels
  double noise = 5;  // counts
  std::uint64_t seed = 1;
};

inline const Indenter kStamp{.shape = Indenter::Shape::kStamp, .size = {10.5e-3, 10.5e-3}};

// Forces of a rigid box that lies on the skin.
inline std::vector<double> forcesUnder(const Sensor& sensor, const Press& press) {
  if (sensor.patches.size() == 1) {
    const GridPatch& patch = sensor.patches[0];
    const Polygon polygon = moved(sectionOf(kStamp, 0), {press.x, press.y}, press.yaw);
    std::vector<double> forces;
    for (int i = 0; i < patch.num_rows; ++i) {
      for (int j = 0; j < patch.num_cols; ++j) {
        const double left = (i - patch.num_rows / 2.0) * kPitch, bottom = (j - patch.num_cols / 2.0) * kPitch;
        forces.push_back(press.load * overlap(polygon, {left, bottom}, {left + kPitch, bottom + kPitch}) / kStamp.sectionAt(0));
      }
    }
    return forces;
  }
  const Object box("box", Box{{kStamp.size[0], kStamp.size[1], 5e-3}});
  const Pose pose{.position = {press.x, press.y, 2.5e-3}, .rotation = axisAngle({0, 0, 1}, press.yaw)};
  reference::FrameInput input;
  input.objects = {{&box, pose}};
  input.load = press.load;
  return reference::simulateFrame(sensor, input).taxel_force;
}

inline StampImages recorded(const Sensor& sensor, const Press& press) {
  StampImages stamp{.indenter = kStamp, .load = press.load, .images = {}};
  const auto num_taxels = static_cast<std::size_t>(numTaxels(sensor));
  stamp.images.num_taxels = num_taxels;
  std::vector<double> spread = reference::spread(sensor, forcesUnder(sensor, press));
  for (double& force : spread) force *= press.gain;
  reference::Lag lag(sensor.readout, num_taxels);
  for (int frame = 1; frame <= 100; ++frame) {
    std::vector<double> read;
    for (const double share : {0.5, 0.5}) {
      const bool on = frame > 10 || (frame == 10 && !read.empty());
      read = lag.step(on ? spread : std::vector<double>(num_taxels), kFrame * share);
    }
    std::vector<double> noise;
    for (std::size_t t = 0; t < num_taxels; ++t) {
      noise.push_back(press.noise * gaussian({.seed = press.seed,
                                              .frame = static_cast<std::uint32_t>(frame),
                                              .taxel = static_cast<std::uint32_t>(t),
                                              .purpose = Purpose::kReadoutNoise}));
    }
    stamp.images.time.push_back(frame * kFrame);
    for (const std::uint32_t counts : reference::readOut(sensor, read, {.noise = noise})) {
      stamp.images.counts.push_back(static_cast<float>(counts));
    }
  }
  return stamp;
}

// Measurements with the layout of `truth`, and none of its readout and spread.
inline std::vector<Measurement> measured(const Sensor& truth, const std::vector<StampImages>& stamps) {
  Sensor known = truth;
  known.psf = {};
  known.readout.curve = {1};
  known.readout.trigger = 0;
  known.readout.creep.clear();
  known.readout.taxel_gain.clear();
  known.readout.taxel_trigger.clear();
  std::vector<Measurement> measurements;
  for (const StampImages& stamp : stamps) {
    const std::string name = "stamp" + std::to_string(measurements.size());
    measurements.push_back({.file = name + ".yaml", .name = name, .sensor = known, .resolved_sensor = "s", .data = stamp});
  }
  return measurements;
}

inline Characterization fitted(const Sensor& truth, const std::vector<StampImages>& stamps) {
  return characterize(measured(truth, stamps));
}

inline std::vector<Press> drawn(std::uint64_t seed, int count) {
  EpisodeRandom random(seed, 0);
  std::vector<Press> presses;
  for (int n = 0; n < count; ++n) {
    presses.push_back({.load = random.uniform(3, 9),
                       .x = random.uniform(-3e-3, 3e-3),
                       .y = random.uniform(-5e-3, 5e-3),
                       .yaw = random.uniform(-0.2, 0.2),
                       .seed = 100 * seed + static_cast<std::uint64_t>(n)});
  }
  return presses;
}

inline std::vector<StampImages> recordedAll(const Sensor& sensor, const std::vector<Press>& presses) {
  std::vector<StampImages> stamps;
  for (const Press& press : presses) stamps.push_back(recorded(sensor, press));
  return stamps;
}

}  // namespace taxelsim::testing
