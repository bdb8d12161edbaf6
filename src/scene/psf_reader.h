// The block `psf` of a sensor: the point spread function.
#pragma once

#include "scene/yaml_reader.h"
#include "taxelsim/sensor.h"

namespace taxelsim {

Psf readPsf(const YamlMap& sensor);

}  // namespace taxelsim
