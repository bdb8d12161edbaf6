// Figures of tactile images, like figure 3 of the paper: heat maps with the contact outline (red) and its principal axes (blue).
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "figures/canvas.h"

namespace taxelsim::figures {

// The ellipse of second moments of a contact, in the frame of the patch.
struct ContactAxes {
  std::array<double, 2> centre{0, 0};       // m, x and y
  double angle = 0;                         // rad, of the longer axis, from x towards y
  std::array<double, 2> eigenvalues{0, 0};  // m^2, larger first
};

// Corners (x, y) of a taxel outside a grid, m, in the frame of the picture: x points down, y to the right.
using TaxelOutline = std::array<std::array<double, 2>, 4>;

// A line across an image, m, in the frame of its patch or of its outlines.
struct TactileLine {
  std::array<double, 2> through{0, 0};  // x and y
  double angle = 0;                     // rad, from x towards y
  Colour colour = kRed;
  std::string name{};  // in the legend
};

// One image. Rows go down and columns to the right: x points down, y to the right, z (out of the skin) towards the reader.
struct TactilePanel {
  int num_rows = 0, num_cols = 0;
  std::array<double, 2> pitch{1, 1};   // m, of rows and of columns, > 0
  std::vector<double> values;          // (num_rows x num_cols); NaN leaves a cell empty
  std::vector<TaxelOutline> outlines;  // (num_values), for taxels outside a grid; then rows, columns and pitch are not used
  std::string title;
  std::string caption;
  std::optional<ContactAxes> axes;
  std::vector<TactileLine> lines{};
  std::vector<std::array<double, 2>> arrows{};  // (num_values) along x and y of each taxel, or none; kArrowTaxels gives their scale
  bool numbers = true;                          // writes values into cells that are large enough
  bool neighbours = true;                       // false if adjacent cells are not adjacent on the sensor: no outline and no axes
  bool is_signed = false;                       // differences: blue below 0, red above, with their own scale
};

inline constexpr double kArrowTaxels = 2;  // length, in taxels, of an arrow with the value of the brightest colour

struct FigureOptions {
  std::string title;
  std::string subtitle;
  std::string unit = "counts";  // of the colour bar
  int num_columns = 0;          // of panels; 0: for an aspect ratio close to 4:3
  double range = 0;             // value of the brightest colour, larger ones have it too; 0: the largest value of the panels
};

// Axes from the moments of the image, for data without features; none without contact.
std::optional<ContactAxes> axesOfImage(const TactilePanel& panel);

// Draws all panels with one colour scale from 0 to FigureOptions::range, and a symmetric one for signed values. Throws Error(kInput) if
// there is no panel or the picture is larger than Cairo supports.
Canvas drawTactileFigure(const std::vector<TactilePanel>& panels, const FigureOptions& options);

// Writes that figure as a PNG. Throws also Error(kIo) if the file cannot be written.
void writeTactileFigure(const std::filesystem::path& file, const std::vector<TactilePanel>& panels, const FigureOptions& options);

}  // namespace taxelsim::figures
