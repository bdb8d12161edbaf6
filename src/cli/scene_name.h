// Name of a data set's scene.
#pragma once

#include <string>

#include "taxelsim/dataset.h"

namespace taxelsim::cli {

// "-" if the scene has no name.
std::string sceneName(const Manifest& manifest);

}  // namespace taxelsim::cli
