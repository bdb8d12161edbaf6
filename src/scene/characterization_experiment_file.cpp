// Experiment files of kind characterization: a folder of recordings, the settings that they have in common, and one line for each
// recording.
#include <algorithm>
#include <cstdlib>
#include <utility>

#include "scene/experiment_reader.h"
#include "scene/measurement_reader.h"
#include "scene/scene_fields.h"
#include "scene/sensor_file.h"

namespace taxelsim {
namespace {

constexpr const char* kRecordings = "a list of recordings, such as {table: a.csv, load: 2}";
constexpr std::size_t kMaxRecordings = 1000;

// A folder relative to TAXELSIM_REAL_DATA, if this variable is set, else relative to the folder of the experiment file.
struct Folder {
  std::filesystem::path path;
  std::string missing;  // one line if there is none
};

Folder folderOf(const std::string& name, const std::filesystem::path& directory) {
  const char* const recordings = std::getenv("TAXELSIM_REAL_DATA");
  const std::filesystem::path local = directory / name;
  const std::filesystem::path path = recordings != nullptr && *recordings != '\0' ? std::filesystem::path(recordings) / name : local;
  std::error_code error;
  for (const std::filesystem::path& tried : {path, local}) {
    if (std::filesystem::is_directory(tried, error)) return {tried, ""};
  }
  return {path, "no recordings: " + path.generic_string() + " is not a folder; TAXELSIM_REAL_DATA names the folder that holds " + name};
}

// The keys of `item`, and those of `common` that it does not have.
YamlTree joined(const YamlTree& common, const YamlTree& item) {
  YamlTree tree = item;
  for (std::size_t k = 0; k < common.keys.size(); ++k) {
    const auto has = [&](const YamlTree::Key& key) { return key.text == common.keys[k].text; };
    if (std::any_of(item.keys.begin(), item.keys.end(), has)) continue;
    tree.keys.push_back(common.keys[k]);
    tree.children.push_back(common.children[k]);
  }
  return tree;
}

}  // namespace

CharacterizationExperiment readCharacterizationExperiment(const YamlNode& root, const std::filesystem::path& directory) {
  Canonical canonical;
  const YamlMap map(root, {"format_version", "name", "experiment", "data", "light_below", "separate", "common", "recordings"}, canonical);
  CharacterizationExperiment experiment;
  map.integer("format_version", 1, kFormatVersion);
  experiment.name = map.text("name", "a name");
  map.choice("experiment", {"characterization"});
  experiment.light_below = map.number("light_below", Allowed::above(0, "N"), 0.0);
  experiment.separate = map.choice("separate", {"true", "false"}, "false") == "true";
  const Folder folder = folderOf(map.text("data", "the folder of the recordings"), directory);
  const YamlNode recordings = map.require("recordings", kRecordings);
  const std::optional<YamlNode> common = map.find("common");
  if (common && !common->isMap()) common->refuse("the keys of a measurement that all recordings have");
  const std::vector<YamlNode> items = recordings.items(kRecordings);
  if (items.empty() || items.size() > kMaxRecordings) recordings.refuse("a list of 1 to " + std::to_string(kMaxRecordings) + " recordings");
  for (const YamlNode& item : items) {
    if (!item.isMap()) item.refuse("a recording, such as {table: a.csv, load: 2}");
  }
  experiment.missing = folder.missing;
  std::vector<std::string> skipped;
  for (const YamlNode& item : items) {
    if (!folder.missing.empty()) break;
    const YamlTree tree = common ? joined(common->tree(), item.tree()) : item.tree();
    const std::optional<YamlNode> table = item.child("table");
    if (!table) item.fail("table is missing: a table of numbers (CSV)");
    const std::filesystem::path file = table->text("a table of numbers (CSV)");
    const std::string name = file.stem().string();
    if (std::error_code error; !std::filesystem::exists(folder.path / file, error)) {
      skipped.push_back(file.generic_string());
      continue;
    }
    experiment.measurements.push_back(readMeasurement(
        YamlNode(tree, item.file()), {.file = item.file(), .name = name, .sensors = directory, .tables = folder.path, .is_file = false}));
  }
  if (!skipped.empty()) {
    std::string& line = skipped.size() == items.size() ? experiment.missing : experiment.skipped;
    line = "no recordings: " + folder.path.generic_string() + " has no " + skipped.front();
    if (skipped.size() > 1) line += " and " + std::to_string(skipped.size() - 1) + " more of the tables";
  }
  return experiment;
}

}  // namespace taxelsim
