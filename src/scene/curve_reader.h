// The curve of a readout: a straight line or a polynomial, each with or without a limit, or straight pieces.
#pragma once

#include "scene/yaml_reader.h"
#include "taxelsim/sensor.h"

namespace taxelsim {

// The required block `curve` of the readout `from`.
void readCurve(const YamlMap& from, Readout& readout);

}  // namespace taxelsim
