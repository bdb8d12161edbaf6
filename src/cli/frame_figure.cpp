#include "cli/frame_figure.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "figures/sensor_panels.h"
#include "figures/tactile_figure.h"
#include "taxelsim/counts_range.h"

namespace taxelsim::cli {

using namespace figures;

namespace {

// The axes of the contact, for one patch from the features of the frame.
void addAxes(TactilePanel& panel, const Sensor& sensor, const FrameView& frame) {
  if (!panel.neighbours) return;
  panel.axes = axesOfImage(panel);
  if (!panel.axes || sensor.patches.size() != 1) return;
  const Vector3 p_SC_S{frame.center_of_pressure[0], frame.center_of_pressure[1], frame.center_of_pressure[2]};
  const Vector3 p_PC_P = inverse(sensor.patches[0].X_SP) * p_SC_S;
  panel.axes = ContactAxes{{p_PC_P[0], p_PC_P[1]}, frame.edge_angle[0], {frame.eigenvalues[0], frame.eigenvalues[1]}};
}

// Counts of three-axis taxels along the normal, (num_taxels). `counts`: (num_taxels x 3).
std::vector<double> alongNormal(std::span<const std::int32_t> counts) {
  std::vector<double> normal;
  for (std::size_t i = 2; i < counts.size(); i += 3) normal.push_back(counts[i]);
  return normal;
}

// Noise of the noisiest axis, counts.
double axisNoise(const Sensor& sensor) {
  return sensor.readout.three_axis ? std::ranges::max(sensor.readout.three_axis->noise) : 0;
}

// Counts of the brightest colour of all panels.
double rangeOf(const Sensor& sensor, std::span<const double> image, std::span<const double> normal) {
  const double range = countsRange(image, std::hypot(sensor.readout.noise, sensor.readout.bias));
  return normal.empty() ? range : std::max(range, countsRange(normal, axisNoise(sensor)));
}

// Maps of the counts along the normal, with an arrow for the counts along x and y of each taxel. `counts`: (num_taxels x 3).
std::vector<TactilePanel> threeAxisPanels(const Sensor& sensor, std::span<const std::int32_t> counts, std::span<const double> normal,
                                          double range) {
  auto [panels, first] = panelsOf(sensor, normal, "three axes: counts along the normal");
  for (std::size_t p = 0; p < panels.size(); ++p) {
    TactilePanel& panel = panels[p];
    panel.caption = fmt::format("arrows: counts along x and y; as long as a taxel: {:.0f}", range / kArrowTaxels);
    panel.neighbours = false;
    for (std::size_t t = first[p]; t < first[p] + panel.values.size(); ++t) {
      const std::array<double, 2> shear{static_cast<double>(counts[3 * t]), static_cast<double>(counts[3 * t + 1])};
      const bool is_noise = std::hypot(shear[0], shear[1]) < kShearDeviations * axisNoise(sensor);
      panel.arrows.push_back(is_noise ? std::array{0.0, 0.0} : shear);
    }
  }
  return std::move(panels);
}

}  // namespace

void writeFrameFigure(const std::filesystem::path& file, const Sensor& sensor, const FrameView& frame, const std::string& what) {
  const std::vector<double> image(frame.tactile_image.begin(), frame.tactile_image.end()), normal = alongNormal(frame.taxel_counts);
  const double range = rangeOf(sensor, image, normal);
  std::vector<TactilePanel> panels = panelsOf(sensor, image, frame.taxel_counts.empty() ? "" : "tactile image").panels;
  for (TactilePanel& panel : panels) addAxes(panel, sensor, frame);
  if (!frame.taxel_counts.empty()) {
    for (TactilePanel& panel : threeAxisPanels(sensor, frame.taxel_counts, normal, range)) panels.push_back(std::move(panel));
  }
  writeTactileFigure(
      file, panels,
      {.title = fmt::format("{} on {}", what, sensor.name),
       .subtitle = fmt::format("{:.4g} N   angle {:.1f}°   confidence {:.2f}   area {:.3g} mm²", frame.total_force[0],
                               frame.edge_angle[0] * 180 / std::numbers::pi, frame.edge_confidence[0], frame.contact_area[0] * 1e6),
       .range = range});
}

}  // namespace taxelsim::cli
