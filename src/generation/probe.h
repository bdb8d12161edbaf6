// A few frames whose bytes differ between machines that compute different values under equal names of device and driver: a software
// renderer compiles for the processor that it runs on, and the host's mathematical functions choose their code by it.
#pragma once

#include <string>

#include "taxelsim/model.h"
#include "taxelsim/scene.h"

namespace taxelsim {

// SHA-256, as hexadecimal digits, of all recorded columns in the first frames of episodes 0 to 3, under the scene's own controllers.
// Depends neither on the number of episodes nor on a policy. Throws what Simulator throws.
std::string probeHash(const Model& model, const Scene& scene);

}  // namespace taxelsim
