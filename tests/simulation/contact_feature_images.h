// Tactile images made of contact points, for tests of contact features.
#pragma once

#include <vector>

#include "simulation/comparison.h"
#include "support/random_scene.h"

namespace taxelsim::support {

inline constexpr double kImageStep = 0.01;  // s
inline constexpr OutputOptions kContactFeatures{.penetration_depth = false, .contact_features = true, .clean_contact_features = true};

// Steps the simulator with the given force (N) on each taxel of each instance: a contact point at each taxel centre. Shape (instances x
// taxels).
FrameView press(Simulator& simulator, const std::vector<std::vector<double>>& forces);

// The largest number of contact points that press() sets for an instance.
int maxContacts(const std::vector<std::vector<double>>& forces);

// Force on each taxel, N: loose taxels, discs and lines of random density.
std::vector<double> randomImage(Random& random, const Sensor& sensor);

}  // namespace taxelsim::support
