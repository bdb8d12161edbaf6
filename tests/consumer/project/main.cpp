// Presses a cylinder on 4096 sensors, with 0 to 5 N. Its argument is a sensor file.
#include <taxelsim/taxelsim.h>

#include <cstdio>
#include <numbers>
#include <vector>

int main(int argc, char** argv) {
  constexpr int kNumInstances = 4096;
  if (argc != 2) return 2;
  try {
    const taxelsim::Device device = taxelsim::Device::open();  // the best GPU, or the CPU
    const taxelsim::Model model(device, {.sensor = taxelsim::loadSensor(argv[1]), .objects = {taxelsim::Cylinder{0.008, 0.04}}});
    taxelsim::Simulator simulator(model, {.num_instances = kNumInstances});

    // Every sensor touches object 0, which lies along y.
    const taxelsim::Pose X_SO{{0, 0, 0.0075}, taxelsim::axisAngle({1, 0, 0}, std::numbers::pi / 2)};
    simulator.setObjects(std::vector(kNumInstances, 0), std::vector(kNumInstances, X_SO));
    std::vector<float> loads(kNumInstances);  // N
    for (int i = 0; i < kNumInstances; ++i) loads[i] = 5.0f * i / (kNumInstances - 1);
    simulator.setLoads(loads);

    simulator.step(0.001);                               // s; submits, does not wait
    const taxelsim::FrameView frame = simulator.read();  // waits; valid until the next step()
    const int num_taxels = taxelsim::numTaxels(model.sensor());
    std::printf("image of the last sensor, counts:");
    for (const auto count : frame.tactile_image.last(num_taxels)) std::printf(" %u", count);
    std::printf("\nforce %.2f N, edge angle %.2f rad\n", frame.ground_truth.total_force.back(), frame.edge_angle.back());
  } catch (const taxelsim::Error& error) {
    std::fprintf(stderr, "%s\n", error.what());
    return 1;
  }
}
