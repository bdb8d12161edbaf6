// The numbers that a sweep turns: how the passes are cut into workgroups.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "taxelsim/model.h"

namespace taxelsim::bench {

// Which pass an axis is for, so that the time of the other does not hide what it does.
enum class Pass { kContact, kImage };

struct Axis {
  const char* name;  // as ModelOptions and Tuning call it
  Pass pass;
  std::vector<int> values;  // rising
};

enum AxisNumber : std::size_t { kContactWorkgroup, kContactRepeat, kGroupsPerBatch, kImageWorkgroup, kImageTeam, kImageRepeat, kNumAxes };

// (kNumAxes): a value on each axis.
using Setting = std::array<int, kNumAxes>;

const std::array<Axis, kNumAxes>& axes();

// Numbers of the axes of these names; empty: all. Throws Error(kInput) for an unknown name.
std::vector<std::size_t> axesNamed(const std::vector<std::string>& names);

// What the model works with.
Setting settingOf(const Model& model);

// A model of `options` with all sizes as in `setting`. Throws as Model does, and Error(kInput) for a setting out of range.
Model modelWith(const Device& device, ModelOptions options, const Setting& setting);

// The setting with another value on one axis. A team is a part of its workgroup: where it would be larger than that, it becomes as large.
Setting moved(Setting setting, std::size_t axis, int value);

// "contact_workgroup 128, image_team 4": where `setting` differs from `from`; "as chosen" where nowhere.
std::string differenceText(const Setting& setting, const Setting& from);

}  // namespace taxelsim::bench
