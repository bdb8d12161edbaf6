#include "cli/frame_figure.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "figures/tactile_figure.h"
#include "figures/taxel_chart.h"

namespace taxelsim::cli {

using namespace figures;

namespace {

// One panel per patch, one for a list of taxels. `values`: (num_taxels), of which the first one of panel p is at first[p].
struct Panels {
  std::vector<TactilePanel> panels{};
  std::vector<std::size_t> first{};
};

Panels panelsOf(const Sensor& sensor, std::span<const double> values, const std::string& title) {
  Panels all;
  if (isTaxelList(sensor)) {
    TactilePanel panel;
    panel.values.assign(values.begin(), values.end());
    panel.outlines = unrolled(sensor);
    panel.title = title;
    panel.caption = kUnrolled;
    panel.neighbours = false;
    all.panels.push_back(std::move(panel));
    all.first.push_back(0);
    return all;
  }
  std::size_t first = 0;
  for (const GridPatch& patch : sensor.patches) {
    TactilePanel panel;
    panel.num_rows = patch.num_rows;
    panel.num_cols = patch.num_cols;
    panel.pitch = patch.pitch;
    const auto part = values.subspan(first, static_cast<std::size_t>(patch.num_rows) * static_cast<std::size_t>(patch.num_cols));
    panel.values.assign(part.begin(), part.end());
    const std::string name = sensor.patches.size() > 1 ? patch.name : "";
    panel.title = name + (name.empty() || title.empty() ? "" : ": ") + title;
    all.panels.push_back(std::move(panel));
    all.first.push_back(first);
    first += part.size();
  }
  return all;
}

// The axes of the contact, for one patch from the features of the frame.
void addAxes(TactilePanel& panel, const Sensor& sensor, const FrameView& frame) {
  if (!panel.neighbours) return;
  panel.axes = axesOfImage(panel);
  if (!panel.axes || sensor.patches.size() != 1) return;
  const Vector3 p_SC_S{frame.center_of_pressure[0], frame.center_of_pressure[1], frame.center_of_pressure[2]};
  const Vector3 p_PC_P = inverse(sensor.patches[0].X_SP) * p_SC_S;
  panel.axes = ContactAxes{{p_PC_P[0], p_PC_P[1]}, frame.edge_angle[0], {frame.eigenvalues[0], frame.eigenvalues[1]}};
}

// Maps of the counts along the normal, with an arrow for the counts along x and y of each taxel. `counts`: (num_taxels x 3). The largest
// arrow is a taxel long, but cross-talk and noise without shear are shorter.
std::vector<TactilePanel> threeAxisPanels(const Sensor& sensor, std::span<const std::int32_t> counts) {
  std::vector<double> normal;
  constexpr double kLeastScale = 0.25;  // of the largest count along the normal
  double longest = 1;
  for (std::size_t i = 0; i < counts.size(); i += 3) {
    normal.push_back(counts[i + 2]);
    longest = std::max({longest, std::hypot(counts[i], counts[i + 1]), kLeastScale * normal.back()});
  }
  auto [panels, first] = panelsOf(sensor, normal, "three axes: counts along the normal");
  for (std::size_t p = 0; p < panels.size(); ++p) {
    TactilePanel& panel = panels[p];
    panel.longest_arrow = longest;
    panel.caption = fmt::format("arrows: counts along x and y; as long as a taxel: {:.0f}", longest);
    panel.neighbours = false;
    for (std::size_t t = first[p]; t < first[p] + panel.values.size(); ++t) {
      panel.arrows.push_back({static_cast<double>(counts[3 * t]), static_cast<double>(counts[3 * t + 1])});
    }
  }
  return std::move(panels);
}

}  // namespace

void writeFrameFigure(const std::filesystem::path& file, const Sensor& sensor, const FrameView& frame, const std::string& what) {
  const std::vector<double> image(frame.tactile_image.begin(), frame.tactile_image.end());
  std::vector<TactilePanel> panels = panelsOf(sensor, image, frame.taxel_counts.empty() ? "" : "tactile image").panels;
  for (TactilePanel& panel : panels) addAxes(panel, sensor, frame);
  if (!frame.taxel_counts.empty()) {
    for (TactilePanel& panel : threeAxisPanels(sensor, frame.taxel_counts)) panels.push_back(std::move(panel));
  }
  writeTactileFigure(
      file, panels,
      {.title = fmt::format("{} on {}", what, sensor.name),
       .subtitle = fmt::format("{:.4g} N   angle {:.1f}°   confidence {:.2f}   area {:.3g} mm²", frame.total_force[0],
                               frame.edge_angle[0] * 180 / std::numbers::pi, frame.edge_confidence[0], frame.contact_area[0] * 1e6)});
}

}  // namespace taxelsim::cli
