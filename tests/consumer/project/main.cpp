// One frame through an installed taxelsim: every public header, a sensor and an object from the installed scenes.
#include <taxelsim/dataset.h>
#include <taxelsim/device.h>
#include <taxelsim/error.h>
#include <taxelsim/generate.h>
#include <taxelsim/model.h>
#include <taxelsim/object.h>
#include <taxelsim/pose.h>
#include <taxelsim/scene.h>
#include <taxelsim/sensor.h>
#include <taxelsim/simulator.h>
#include <taxelsim/version.h>

#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

int main() {
  constexpr float kLoad = 5;               // N
  constexpr float kLoadTolerance = 0.01f;  // N; the search ends well below it, a wrong unit or a missing contact is far above
  try {
    const taxelsim::Device device = taxelsim::Device::open();
    const taxelsim::Model model(device, {.sensor = taxelsim::loadSensor(std::string(SCENES) + "/sensors/wts0614.yaml"),
                                         .objects = {taxelsim::Cylinder{.radius = 0.008, .length = 0.04}}});
    taxelsim::Simulator simulator(model, {.num_instances = 1});

    // The cylinder lies along y of the sensor and carries the load.
    const std::vector<int> ids{0};
    const std::vector<taxelsim::Pose> X_SO{{.position = {0, 0, 0.0075}, .rotation = taxelsim::axisAngle({1, 0, 0}, 1.5707963267948966)}};
    simulator.setObjects(ids, X_SO);
    simulator.setLoad(0, kLoad);
    simulator.step(0.001);
    const taxelsim::FrameView frame = simulator.read();

    const float force = frame.ground_truth.total_force[0];
    std::printf("taxelsim %s on %s: total force %.3f N, edge angle %.3f rad\n", taxelsim::kVersion, device.info().name.c_str(), force,
                frame.edge_angle[0]);
    return std::abs(force - kLoad) < kLoadTolerance && frame.ground_truth.load_reached[0] == 1 ? 0 : 1;
  } catch (const taxelsim::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 2;
  }
}
