#include "dataset/scene_difference.h"

#include <algorithm>
#include <vector>

#include "base/text.h"

namespace taxelsim::dataset {
namespace {

constexpr std::size_t kMaxShownValue = 60;    // bytes of a value
constexpr std::size_t kShownBeforeDiff = 20;  // bytes of a long value before the first difference

// Key path and value of a line.
struct Setting {
  std::string path;   // "objects[1].sphere.radius"
  std::string value;  // empty for a block
};

std::vector<std::string_view> linesOf(std::string_view text) {
  std::vector<std::string_view> lines;
  while (!text.empty()) {
    lines.push_back(text.substr(0, text.find('\n')));
    text.remove_prefix(std::min(lines.back().size() + 1, text.size()));
  }
  return lines;
}

// The setting of line `index`; its path follows from the indentation of the lines before it. Empty after the last line.
Setting settingAt(const std::vector<std::string_view>& lines, std::size_t index) {
  struct Level {
    std::size_t indent;
    std::string_view key;
    int item;  // index of the current item if the key has a list, else -1
  };
  if (index >= lines.size()) return {};
  std::vector<Level> levels;
  Setting setting;
  for (std::size_t i = 0; i <= index; ++i) {
    std::size_t indent = std::min(lines[i].find_first_not_of(' '), lines[i].size());
    const bool begins_item = lines[i].substr(indent).starts_with("- ");
    if (begins_item) indent += 2;
    while (!levels.empty() && levels.back().indent >= indent) levels.pop_back();
    if (begins_item && !levels.empty()) ++levels.back().item;
    const std::string_view content = lines[i].substr(indent);
    const std::string_view key = content.substr(0, content.find(':'));
    levels.push_back({indent, key, -1});
    setting.value = content.substr(std::min(key.size() + 2, content.size()));
  }
  for (const Level& level : levels) {
    setting.path += (setting.path.empty() ? "" : ".") + std::string(level.key);
    if (level.item >= 0) setting.path += "[" + std::to_string(level.item) + "]";
  }
  return setting;
}

// At most kMaxShownValue bytes of `text`, around the byte `place`.
std::string shortened(const std::string& text, std::size_t place) {
  if (text.size() <= kMaxShownValue) return oneLine(text);
  const std::size_t first = place < kMaxShownValue - kShownBeforeDiff ? 0 : place - kShownBeforeDiff;
  const std::string shown = (first > 0 ? "..." : "") + text.substr(first, kMaxShownValue);
  return oneLine(shown + (first + kMaxShownValue < text.size() ? "..." : ""));
}

std::string described(const Setting& setting) {
  if (setting.path.empty()) return "nothing more";
  return oneLine(setting.path + (setting.value.empty() ? "" : ": " + shortened(setting.value, 0)));
}

}  // namespace

std::string describeSceneDifference(std::string_view there, std::string_view requested) {
  if (there == requested) return {};
  const std::vector<std::string_view> a = linesOf(there), b = linesOf(requested);
  const auto index = static_cast<std::size_t>(std::mismatch(a.begin(), a.end(), b.begin(), b.end()).first - a.begin());
  const Setting x = settingAt(a, index), y = settingAt(b, index);
  if (x.path != y.path || x.value == y.value) return described(x) + " there, " + described(y) + " requested";
  const auto place =
      static_cast<std::size_t>(std::mismatch(x.value.begin(), x.value.end(), y.value.begin(), y.value.end()).first - x.value.begin());
  return oneLine(x.path) + ": " + shortened(x.value, place) + " there, " + shortened(y.value, place) + " requested";
}

}  // namespace taxelsim::dataset
