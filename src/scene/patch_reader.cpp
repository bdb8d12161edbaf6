#include "scene/patch_reader.h"

#include <algorithm>
#include <optional>
#include <set>
#include <string>

#include "scene/keys/sensor.h"
#include "scene/pose_reader.h"
#include "scene/taxel_reader.h"
#include "sensor/fields.h"
#include "sensor/hints.h"

namespace taxelsim {
namespace {

// All settings of a patch but its name.
GridPatch readGrid(const YamlMap& map, std::string name) {
  GridPatch patch;
  patch.name = std::move(name);
  readFields(map, kGridPatchFields, patch);
  const Allowed& allowed = map.allowedOf("pitch");
  const YamlNode pitch = map.require("pitch", "a number > 0 m, or a list of two");
  if (pitch.isList()) {
    const std::vector<double> numbers = pitch.numbers(allowed, 2);
    patch.pitch = {numbers[0], numbers[1]};
  } else {
    patch.pitch.fill(pitch.number(allowed));
  }
  if (const std::string question = unitQuestion(patch); !question.empty()) pitch.warn(question + " pitch_mm");
  map.canonical().line("pitch", canonicalList(patch.pitch));
  patch.X_SP = readPose(map, "pose");
  return patch;
}

// The key that defines the taxels; none for a sensor of one grid.
std::optional<std::string_view> layoutKey(const YamlMap& map) {
  std::optional<std::string_view> chosen;
  for (const std::string_view key : {"patches", "taxels", "taxel_mesh", "urdf"}) {
    if (chosen) map.rejectBoth(key, *chosen);
    if (map.has(key)) chosen = key;
  }
  if (!chosen) return chosen;
  for (const std::string_view key : {"num_rows", "num_cols", "pitch", "pose"}) {
    map.rejectBoth(key, *chosen, chosen == "patches" ? "give it in each patch instead" : "it belongs to a sensor of one grid");
  }
  return chosen;
}

}  // namespace

std::vector<GridPatch> readPatches(const YamlMap& map, const std::filesystem::path& directory) {
  const std::optional<std::string_view> layout = layoutKey(map);
  if (layout == "taxels") return readTaxelList(map);
  if (layout == "taxel_mesh") return readTaxelMesh(map, directory);
  if (layout == "urdf") return readTaxelUrdf(map, directory);
  Canonical& canonical = map.canonical();
  std::vector<GridPatch> patches;
  canonical.open("patches");
  if (const std::optional<YamlNode> list = map.find("patches")) {
    const std::vector<YamlNode> items = list->items("a list of patches");
    if (items.empty()) list->refuse("a list of at least one patch");
    std::set<std::string> names;
    int num_taxels = 0;
    for (const YamlNode& item : items) {
      const YamlMap patch = YamlMap::item(item, patchKeys(), canonical);
      const std::string name = patch.text("name", "a name", "patch_" + std::to_string(patches.size()));
      if (!names.insert(name).second) item.fail("the name '" + name + "' is taken by an earlier patch");
      patches.push_back(readGrid(patch, name));
      num_taxels += patches.back().num_rows * patches.back().num_cols;
      if (num_taxels > kMaxTaxels) item.fail("more than " + std::to_string(kMaxTaxels) + " taxels with those of the earlier patches");
    }
  } else {
    const std::string name = "patch_0";
    canonical.openItem();
    canonical.line("name", name);
    patches.push_back(readGrid(map, name));
    canonical.close();
  }
  canonical.close();
  return patches;
}

}  // namespace taxelsim
