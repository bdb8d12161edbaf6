#include "taxelsim/counts_range.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>
#include <vector>

#include "base/yaml_parse.h"
#include "taxelsim/error.h"

namespace taxelsim {
namespace {

constexpr double kQuantile = 0.999;                        // one taxel of a thousand may be brighter, such as a spike
constexpr double kNoiseDeviations = 10;                    // noise of three standard deviations stays in the lower third of the colours
constexpr std::uint64_t kBlocks = 16;                      // in a sample; each may lie in another shard, whose checksum is verified
constexpr std::uint64_t kFrames = 4096;                    // in a sample
constexpr std::uint64_t kValues = std::uint64_t{1} << 22;  // in a sample, 32 MiB; large arrays give fewer frames

constexpr std::size_t kAxes = 3, kNormalAxis = 2;

// The largest number in a scalar or a sequence; 0 without any.
double largest(const YamlTree& node) {
  double result = 0;
  std::from_chars(node.text.data(), node.text.data() + node.text.size(), result);
  for (const YamlTree& child : node.children) result = std::max(result, largest(child));
  return result;
}

// `noise` and `bias` of the blocks with that key, counts; the largest of several sensors.
double noiseOf(const YamlTree& node, const std::string& block) {
  double result = 0;
  for (std::size_t i = 0; i < node.children.size(); ++i) {
    const YamlTree& child = node.children[i];
    result = std::max(result, noiseOf(child, block));
    if (i >= node.keys.size() || node.keys[i].text != block) continue;
    double noise = 0;
    for (std::size_t k = 0; k < child.keys.size(); ++k) {
      const std::string& key = child.keys[k].text;
      if (key == "noise" || key == "bias") noise = std::hypot(noise, largest(child.children[k]));
    }
    result = std::max(result, noise);
  }
  return result;
}

bool hasThreeAxes(const std::string& column) {
  return column.ends_with("/taxel_counts");
}

std::uint64_t rowSize(const Manifest& manifest, const std::string& name) {
  std::uint64_t size = 1;
  for (const Column& column : manifest.columns) {
    if (column.name != name) continue;
    for (const std::size_t side : column.shape) size *= side;
  }
  return std::max<std::uint64_t>(size, 1);
}

}  // namespace

double countsRange(std::span<const double> counts, double noise) {
  const double least = std::max(1.0, std::ceil(kNoiseDeviations * noise));
  std::vector<double> beyond;
  std::copy_if(counts.begin(), counts.end(), std::back_inserter(beyond), [least](double value) { return value > least; });
  if (beyond.empty()) return least;
  const auto rank = static_cast<std::ptrdiff_t>(std::ceil(kQuantile * static_cast<double>(beyond.size()))) - 1;
  std::nth_element(beyond.begin(), beyond.begin() + rank, beyond.end());
  return beyond[static_cast<std::size_t>(rank)];
}

double countsRange(const DatasetReader& reader, const std::string& column, std::uint64_t first, std::uint64_t end) {
  const bool three_axes = hasThreeAxes(column);
  const std::uint64_t num_frames = end - first, most = std::clamp(kValues / rowSize(reader.manifest(), column), kBlocks, kFrames);
  const std::uint64_t sampled = std::min(num_frames, most), blocks = std::min(sampled, kBlocks);
  std::vector<double> counts;
  for (std::uint64_t k = 0; k < blocks; ++k) {
    const std::uint64_t begin = k * sampled / blocks, skipped = blocks > 1 ? k * (num_frames - sampled) / (blocks - 1) : 0;
    const std::vector<double> rows = reader.readAsDouble(column, first + begin + skipped, (k + 1) * sampled / blocks - begin);
    for (std::size_t i = three_axes ? kNormalAxis : 0; i < rows.size(); i += three_axes ? kAxes : 1) counts.push_back(rows[i]);
  }
  return countsRange(counts, countsNoise(reader.manifest(), column));
}

double countsNoise(const Manifest& manifest, const std::string& column) {
  try {
    const YamlTree scene = parseYaml(manifest.scene, "scene of the data set");
    return std::hypot(noiseOf(scene, hasThreeAxes(column) ? "three_axis" : "readout"), noiseOf(scene, "randomization"));
  } catch (const Error&) {
    return 0;
  }
}

}  // namespace taxelsim
