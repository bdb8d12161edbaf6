#include "simulation/contact_feature_images.h"

#include <algorithm>

#include "base/vector3.h"

namespace taxelsim::support {

FrameView press(Simulator& simulator, const std::vector<std::vector<double>>& forces) {
  const std::vector<Vector3> positions = taxelPositions(simulator.model().sensor());
  for (std::size_t i = 0; i < forces.size(); ++i) {
    std::vector<ContactPoint> contacts;
    for (std::size_t t = 0; t < forces[i].size(); ++t) {
      if (forces[i][t] > 0) contacts.push_back({positions[t], forces[i][t]});
    }
    simulator.setContacts(static_cast<int>(i), contacts);
  }
  return stepOnce(simulator, kImageStep);
}

int maxContacts(const std::vector<std::vector<double>>& forces) {
  std::size_t most = 1;
  for (const std::vector<double>& image : forces) {
    most = std::max(most, static_cast<std::size_t>(std::count_if(image.begin(), image.end(), [](double f) { return f > 0; })));
  }
  return static_cast<int>(most);
}

std::vector<double> randomImage(Random& random, const Sensor& sensor) {
  std::vector<double> force(static_cast<std::size_t>(numTaxels(sensor)), 0);
  if (random.chance(0.1)) return force;
  const double loose = random.chance(0.5) ? 0 : std::min(random.uniform(0, 0.7), 1200.0 / static_cast<double>(force.size()));
  for (double& f : force) {
    if (random.chance(loose)) f = random.uniform(0.05, 1);
  }
  const std::vector<Vector3> positions = taxelPositions(sensor);
  const double extent = extentOf(sensor);
  for (int discs = random.integer(0, 5); discs > 0; --discs) {
    const Vector3 middle = positions[static_cast<std::size_t>(random.integer(0, static_cast<int>(positions.size()) - 1))];
    const double radius = random.uniform(0.02, 0.3) * extent, across = random.chance(0.5) ? 1 : 8, height = random.uniform(0.1, 1);
    int num_left = 500;
    for (std::size_t t = 0; t < force.size(); ++t) {
      const Vector3 d = subtract(positions[t], middle);
      const double q = (d[0] * d[0] + across * d[1] * d[1] + d[2] * d[2]) / (radius * radius);
      if (q < 1 && num_left-- > 0) force[t] = height * (1.1 - q);
    }
  }
  return force;
}

}  // namespace taxelsim::support
