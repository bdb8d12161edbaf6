// A readout's curve as our files write it: a straight line, a polynomial, either with a limit, or straight pieces.
#pragma once

#include "scene/yaml_reader.h"
#include "taxelsim/sensor.h"

namespace taxelsim {

// The block `curve` of the readout `from`, which must be there.
void readCurve(const YamlMap& from, Readout& readout);

}  // namespace taxelsim
