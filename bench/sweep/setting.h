// Parameters of a sweep: how the passes are divided into workgroups.
#pragma once

#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "taxelsim/model.h"

namespace taxelsim::bench {

// The pass that an axis affects; its time is the objective.
enum class Pass { kContact, kImage };

struct Axis {
  const char* name;  // name in ModelOptions or Tuning
  Pass pass;
  std::vector<int> values;  // ascending
};

enum AxisNumber : std::size_t { kContactWorkgroup, kContactRepeat, kGroupsPerBatch, kImageWorkgroup, kImageTeam, kImageRepeat, kNumAxes };

// (kNumAxes): a value on each axis.
using Setting = std::array<int, kNumAxes>;

const std::array<Axis, kNumAxes>& axes();

// Indices of the named axes; empty: all. Throws Error(kInput) for an unknown name.
std::vector<std::size_t> axesNamed(const std::vector<std::string>& names);

// The setting of a model.
Setting settingOf(const Model& model);

// A model of `options` with all sizes as in `setting`. Throws as Model does, and Error(kInput) for a setting out of range.
Model modelWith(const Device& device, ModelOptions options, const Setting& setting);

// The setting with another value on one axis. A team is at most as large as its workgroup.
Setting moved(Setting setting, std::size_t axis, int value);

// Differences from `from`: "contact_workgroup 128, image_team 4"; "as chosen" without any.
std::string differenceText(const Setting& setting, const Setting& from);

}  // namespace taxelsim::bench
