// The features in a few first frames. Their SHA-256 differs between machines that compute different values under equal names of device and
// driver, as the probe of a data set does (generation/probe.h).
#pragma once

#include <string>

#include "taxelsim/model.h"
#include "taxelsim/scene.h"

namespace taxelsim {

// SHA-256, as hexadecimal digits, of the measured and clean features in the first frames of episodes 0 to 3 under the first controller of
// the scene. Depends neither on the number of episodes nor on a policy. Throws what Simulator throws.
std::string featureProbe(const Model& model, const Scene& scene);

}  // namespace taxelsim
