#include "sweep/setting.h"

#include <algorithm>

#include "simulation/model_access.h"
#include "simulation/model_impl.h"
#include "taxelsim/error.h"

namespace taxelsim::bench {

const std::array<Axis, kNumAxes>& axes() {
  static const std::array<Axis, kNumAxes> all{{
      {"contact_workgroup", Pass::kContact, {4, 8, 16, 32, 64, 128, 256}},
      {"contact_repeat", Pass::kContact, {1, 2, 4, 8, 16, 32, 64}},
      {"groups_per_batch", Pass::kContact, {16, 32, 64, 128}},
      {"image_workgroup", Pass::kImage, {4, 8, 16, 32, 64, 128, 256}},
      {"image_team", Pass::kImage, {1, 2, 4, 8, 16, 32, 64, 128, 256}},
      {"image_repeat", Pass::kImage, {1, 2, 4, 8, 16, 32, 64}},
  }};
  return all;
}

std::vector<std::size_t> axesNamed(const std::vector<std::string>& names) {
  std::vector<std::size_t> chosen;
  std::string known;
  for (std::size_t axis = 0; axis < kNumAxes; ++axis) {
    known += (axis == 0 ? "" : ", ") + std::string(axes()[axis].name);
    if (names.empty() || std::find(names.begin(), names.end(), axes()[axis].name) != names.end()) chosen.push_back(axis);
  }
  for (const std::string& name : names) {
    if (std::none_of(axes().begin(), axes().end(), [&](const Axis& axis) { return axis.name == name; })) {
      throw Error(ErrorKind::kInput, "--axes " + name + ": not one of " + known);
    }
  }
  return chosen;
}

Setting settingOf(const Model& model) {
  const Model::Impl& impl = implOf(model);
  Setting setting{};
  setting[kContactWorkgroup] = static_cast<int>(impl.tiles.sizes().workgroup);
  setting[kContactRepeat] = static_cast<int>(impl.tiles.sizes().repeat);
  setting[kGroupsPerBatch] = static_cast<int>(impl.tiles.groupsPerBatch());
  setting[kImageWorkgroup] = static_cast<int>(impl.image.sizes().pass.workgroup);
  setting[kImageTeam] = static_cast<int>(impl.image.sizes().team);
  setting[kImageRepeat] = static_cast<int>(impl.image.sizes().pass.repeat);
  return setting;
}

Model modelWith(const Device& device, ModelOptions options, const Setting& setting) {
  options.contact_workgroup = setting[kContactWorkgroup];
  options.image_workgroup = setting[kImageWorkgroup];
  return ModelAccess::make(device, options,
                           {.contact_repeat = setting[kContactRepeat],
                            .image_team = setting[kImageTeam],
                            .image_repeat = setting[kImageRepeat],
                            .groups_per_batch = setting[kGroupsPerBatch]});
}

Setting moved(Setting setting, std::size_t axis, int value) {
  setting[axis] = value;
  setting[kImageTeam] = std::min(setting[kImageTeam], setting[kImageWorkgroup]);
  return setting;
}

std::string differenceText(const Setting& setting, const Setting& from) {
  std::string text;
  for (std::size_t axis = 0; axis < kNumAxes; ++axis) {
    if (setting[axis] != from[axis])
      text += (text.empty() ? "" : ", ") + std::string(axes()[axis].name) + " " + std::to_string(setting[axis]);
  }
  return text.empty() ? "as chosen" : text;
}

}  // namespace taxelsim::bench
