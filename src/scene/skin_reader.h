// The block `skin` of a sensor: thickness, contact law, friction, relaxation.
#pragma once

#include "scene/yaml_reader.h"
#include "taxelsim/sensor.h"

namespace taxelsim {

Skin readSkin(const YamlMap& sensor);

}  // namespace taxelsim
