// The probe of an evaluation: features that all machines that play its episodes must reproduce (episodes/probe.h).
#pragma once

#include <string>

#include "taxelsim/model.h"
#include "taxelsim/scene.h"

namespace taxelsim {

// SHA-256, as hexadecimal digits, of the measured and clean features in the first frames of episodes 0 to 3 under the first controller of
// the scene. Depends neither on the number of episodes nor on a policy. Throws what Simulator throws.
std::string featureProbe(const Model& model, const Scene& scene);

// Takes the first frames of episode 0 of a scene of kind grasp, under the law of the scene.
std::string graspProbe(const Device& device, const Scene& scene);

}  // namespace taxelsim
