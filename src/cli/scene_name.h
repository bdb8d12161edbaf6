// What a data set's scene calls itself.
#pragma once

#include <string>

#include "taxelsim/dataset.h"

namespace taxelsim::cli {

// "-" when the scene has no name.
std::string sceneName(const Manifest& manifest);

}  // namespace taxelsim::cli
