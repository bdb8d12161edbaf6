#include "figures/sensor_panels.h"

#include <utility>

#include "figures/taxel_chart.h"

namespace taxelsim::figures {

SensorPanels panelsOf(const Sensor& sensor, std::span<const double> values, const std::string& title) {
  SensorPanels all;
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

}  // namespace taxelsim::figures
