// Draws one panel of a tactile figure: heat map, values, contact outline, principal axes, lines, arrows. The origin is the panel's upper
// left corner.
#pragma once

#include <span>

#include "figures/tactile_figure.h"

namespace taxelsim::figures {

inline constexpr Colour kContour = kRed, kAxis = kBlue, kArrow = kRed;

// A colour scale from 0 to `max`, or from -`max` to `max` for signed values.
struct ColourScale {
  std::span<const Colour> colours;
  double max = 0;
  bool is_signed = false;

  double low() const { return is_signed ? -top() : 0; }
  double top() const { return max > 0 ? max : 1; }
  Colour at(double value) const;
};

// Scales with max 0: viridis for values, blue to red for differences.
ColourScale valueScale();
ColourScale differenceScale();

// Sizes of one panel in points; cells keep the proportions of the taxels.
struct PanelSize {
  double cell_width = 0, cell_height = 0;
  double width = 0, height = 0;  // of the grid
};

PanelSize sizeOf(const TactilePanel& panel);

void drawPanel(const Canvas& canvas, const TactilePanel& panel, const PanelSize& size, const ColourScale& scale);

}  // namespace taxelsim::figures
