// Pictures of tactile images, in the manner of figure 3 of the paper: heat maps with the outline of the contact (red) and its principal
// axes (blue). Not a plotting library, and nothing here knows where the values come from.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "figures/canvas.h"

namespace taxelsim::cli {

// The ellipse of second moments of a contact, in the frame of the patch.
struct ContactAxes {
  std::array<double, 2> centre{0, 0};       // m, x and y
  double angle = 0;                         // rad, of the longer axis from x towards y
  std::array<double, 2> eigenvalues{0, 0};  // m^2, larger first
};

// Corners (x, y) of a taxel that is no cell of a grid, m, in the picture's own frame: x runs down the page, y to the right.
using TaxelOutline = std::array<std::array<double, 2>, 4>;

// A line across an image, m, in the frame of its patch; of outlines in theirs.
struct TactileLine {
  std::array<double, 2> through{0, 0};  // x and y
  double angle = 0;                     // rad, from x towards y
  Colour colour = kRed;
  std::string name{};  // in the legend
};

// One image. Rows run down the page and columns to the right, so x points down, y to the right and z, out of the skin, at the reader.
struct TactilePanel {
  int num_rows = 0, num_cols = 0;
  std::array<double, 2> pitch{1, 1};   // m, of rows and of columns, > 0
  std::vector<double> values;          // (num_rows x num_cols); NaN leaves a cell empty
  std::vector<TaxelOutline> outlines;  // (num_values), where they are no grid; rows, columns and pitch do not matter then
  std::string title;
  std::string caption;
  std::optional<ContactAxes> axes;
  std::vector<TactileLine> lines{};
  bool numbers = true;     // values are written into cells that have room
  bool neighbours = true;  // false when cells side by side are not so on the sensor: then no outline and no axes are drawn
  bool is_signed = false;  // values are differences: blue below 0, red above, by a scale of their own
};

struct FigureOptions {
  std::string title;
  std::string subtitle;
  std::string unit = "counts";  // of the colour bar
  int num_columns = 0;          // of panels; 0: as many as bring the page nearest to four by three
};

// Moments of the image itself, for data that come without features; none without contact.
std::optional<ContactAxes> axesOfImage(const TactilePanel& panel);

// Writes a PNG of all panels with one colour scale from 0 to the largest value, and one for signed values, as far up as down. Throws
// Error(kIo) when the file cannot be written, Error(kInput) when there is nothing to draw or the picture would be larger than Cairo can
// make.
void writeTactileFigure(const std::filesystem::path& file, const std::vector<TactilePanel>& panels, const FigureOptions& options);

}  // namespace taxelsim::cli
