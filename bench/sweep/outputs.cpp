#include "sweep/outputs.h"

#include <cstring>

#include "base/sha256.h"

namespace taxelsim::bench {
namespace {

// Calls `visit(name, values)` for every non-empty output of a frame except tactile_image.
template <typename Visit>
void forEachFloat(const FrameView& frame, const Visit& visit) {
  const auto features = [&](const std::string& of, const FeatureView& view) {
    visit(of + "total_force", view.total_force);
    visit(of + "peak_force", view.peak_force);
    visit(of + "center_of_pressure", view.center_of_pressure);
    visit(of + "second_moments", view.second_moments);
    visit(of + "eigenvalues", view.eigenvalues);
    visit(of + "edge_angle", view.edge_angle);
    visit(of + "edge_confidence", view.edge_confidence);
    visit(of + "contact_area", view.contact_area);
  };
  const GroundTruthView& truth = frame.ground_truth;
  features("", frame);
  visit("saturated", frame.saturated);
  features("ground_truth.", truth);
  visit("tactile_normal_force", truth.tactile_normal_force);
  visit("penetration_depth", truth.penetration_depth);
  visit("contact_wrench", truth.contact_wrench);
  visit("over_penetration", truth.over_penetration);
}

// Index of the first instance whose row differs; num_instances: none.
template <typename T>
std::size_t firstInstance(std::span<const T> a, std::span<const T> b, std::size_t num_instances) {
  if (a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size_bytes()) == 0) return num_instances;
  if (a.size() != b.size()) return 0;
  const std::size_t row = a.size() / num_instances;
  std::size_t instance = 0;
  while (std::memcmp(a.data() + instance * row, b.data() + instance * row, row * sizeof(T)) == 0) ++instance;
  return instance;
}

}  // namespace

Outputs copyOf(const FrameView& frame, int num_instances) {
  Outputs outputs{.num_instances = num_instances, .tactile_image = {frame.tactile_image.begin(), frame.tactile_image.end()}, .floats = {}};
  forEachFloat(frame, [&](const std::string& name, std::span<const float> values) {
    if (!values.empty()) outputs.floats.emplace_back(name, std::vector<float>(values.begin(), values.end()));
  });
  return outputs;
}

std::string firstDifference(const Outputs& outputs, const FrameView& frame) {
  const auto n = static_cast<std::size_t>(outputs.num_instances);
  std::string difference;
  const auto compare = [&](const std::string& name, auto kept, auto found) {
    if (!difference.empty()) return;
    const std::size_t instance = firstInstance(kept, found, n);
    if (instance < n) difference = name + " of instance " + std::to_string(instance);
  };
  compare("tactile_image", std::span<const std::uint32_t>(outputs.tactile_image), frame.tactile_image);
  std::size_t k = 0;
  forEachFloat(frame, [&](const std::string& name, std::span<const float> values) {
    if (!values.empty()) compare(name, std::span<const float>(outputs.floats[k++].second), values);
  });
  return difference;
}

std::string hashOf(std::span<const std::uint32_t> values) {
  return sha256Hex(std::as_bytes(values));
}

std::vector<std::string> hashesOfImages(const Outputs& outputs) {
  constexpr std::size_t kDigits = 16;  // enough to distinguish a few images
  const auto n = static_cast<std::size_t>(outputs.num_instances);
  const std::span<const std::uint32_t> all = outputs.tactile_image;
  std::vector<std::string> hashes;
  for (std::size_t i = 0; i < n; ++i) hashes.push_back(hashOf(all.subspan(i * all.size() / n, all.size() / n)).substr(0, kDigits));
  return hashes;
}

std::string hashOfFloats(const Outputs& outputs) {
  std::vector<float> all;
  for (const auto& [name, values] : outputs.floats) all.insert(all.end(), values.begin(), values.end());
  return sha256Hex(std::as_bytes(std::span<const float>(all)));
}

}  // namespace taxelsim::bench
