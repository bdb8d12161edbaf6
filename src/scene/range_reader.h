// Ranges of the random variables of an episode.
#pragma once

#include <span>

#include "scene/scene_fields.h"
#include "scene/yaml_reader.h"
#include "taxelsim/scene.h"

namespace taxelsim {

// Reads each row of the table: a number, or [min, max]. Missing keys keep their values, and must be there where a variable has none.
void readRanges(const YamlMap& map, std::span<const RangeField> table, Randomization& random);

}  // namespace taxelsim
