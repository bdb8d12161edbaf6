// Questions about lengths of a sensor that were probably given in millimetres: "1.5 m thick; is it in millimetres?". Empty for others.
#pragma once

#include <string>

#include "taxelsim/sensor_hints.h"

namespace taxelsim {

std::string unitQuestion(const GridPatch& patch);
std::string unitQuestion(const Skin& skin);

}  // namespace taxelsim
