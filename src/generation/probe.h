// The probe of a data set: frames that all machines that write it must reproduce (episodes/probe.h).
#pragma once

#include <string>

#include "generation/columns.h"
#include "taxelsim/model.h"
#include "taxelsim/scene.h"

namespace taxelsim {

// SHA-256, as hexadecimal digits, of the columns, those of the scene, in the first frames of episodes 0 to 3, under the scene's own
// controllers. Depends neither on the number of episodes nor on a policy. Throws what Simulator throws.
std::string probeHash(const Model& model, const Scene& scene, const ColumnPlan& columns);

}  // namespace taxelsim
