#include "figures/comparison_figure.h"

#include <spdlog/fmt/fmt.h>

#include <cmath>
#include <numbers>

#include "figures/tactile_figure.h"
#include "figures/taxel_chart.h"

namespace taxelsim::figures {
namespace {

TactilePanel emptyPanel(const Sensor& sensor) {
  TactilePanel panel;
  if (sensor.patches.size() == 1) {
    panel.num_rows = sensor.patches[0].num_rows;
    panel.num_cols = sensor.patches[0].num_cols;
    panel.pitch = sensor.patches[0].pitch;
  } else {
    panel.outlines = outlinesOf(sensor);
    panel.neighbours = false;
  }
  return panel;
}

TactilePanel imagePanel(const Sensor& layout, const Readout& readout, const ShownImage& image, const ImageContact& contact) {
  TactilePanel panel = emptyPanel(layout);
  panel.title = image.title;
  if (panel.neighbours) {
    for (const float counts : image.counts) panel.values.push_back(nominalForce(readout, counts));
    panel.axes = axesOfImage(panel);
  }
  panel.values.assign(image.counts.begin(), image.counts.end());
  panel.caption = fmt::format("{:.3g} N", contact.total_force);
  if (std::isfinite(contact.edge_angle)) panel.caption += fmt::format("   angle {:.1f}°", contact.edge_angle * 180 / std::numbers::pi);
  return panel;
}

}  // namespace

std::string percentText(double fraction) {
  return std::isfinite(fraction) ? fmt::format("{:.3g} %", 100 * fraction) : "-";
}

void writeComparisonFigure(const std::filesystem::path& file, const Sensor& real_sensor, const Sensor& simulated_sensor,
                           const std::vector<ShownPair>& pairs, const ComparisonTitles& titles) {
  std::vector<TactilePanel> panels;
  for (const auto& [real, simulated, comparison] : pairs) {
    panels.push_back(imagePanel(real_sensor, real_sensor.readout, real, comparison.real));
    panels.push_back(imagePanel(real_sensor, simulated_sensor.readout, simulated, comparison.simulated));
    TactilePanel& difference = panels.emplace_back(emptyPanel(real_sensor));
    difference.is_signed = true;
    difference.neighbours = false;
    difference.title = "simulated - real";
    for (std::size_t t = 0; t < real.counts.size(); ++t) difference.values.push_back(simulated.counts[t] - real.counts[t]);
    difference.caption = fmt::format("M1 {}   M4 {}", percentText(comparison.median_difference), percentText(comparison.relative_l1));
    if (std::isfinite(comparison.cosine)) difference.caption += fmt::format("   M5 {:.3f}", comparison.cosine);
  }
  writeTactileFigure(file, panels, {.title = titles.title, .subtitle = titles.subtitle, .unit = "counts", .num_columns = 3});
}

}  // namespace taxelsim::figures
