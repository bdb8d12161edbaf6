/// @file
/// Measurements of a real sensor on a test bench: a table (CSV) and a small YAML file with its metadata (docs/reference/measurements.md).
/// characterize.h and compare.h use them.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "taxelsim/sensor.h"

namespace taxelsim {

/// Indenter that presses on the skin: its lowest point faces down, its axis is the normal of the skin.
struct Indenter {
  /// Kind of indenter.
  enum class Shape {
    kFlatPin,   ///< Flat disc of `radius`.
    kStamp,     ///< Flat rectangle of `size`.
    kSphere,    ///< Sphere of `radius`.
    kCylinder,  ///< Lying cylinder of `radius` and `length`.
    kCone,      ///< Cone with `half_angle` between axis and side.
  };

  Shape shape = Shape::kFlatPin;     ///< Kind; selects which of the dimensions apply.
  double radius = 0;                 ///< m, > 0.
  double length = 0;                 ///< m, > 0.
  double half_angle = 0;             ///< rad, > 0, < pi/2.
  std::array<double, 2> size{0, 0};  ///< m, > 0, along x and y of the sensor.

  /// Cross-section (m^2) at `height` (m, >= 0) above the lowest point. Above the middle of a sphere or cylinder: the section at the middle.
  double sectionAt(double height) const;
};

/// A sequence of tactile images. A row is one reading of all taxels, in counts as recorded.
struct Images {
  std::size_t num_taxels = 0;  ///< Taxels of one image.
  std::vector<double> time;    ///< (rows), s, rising; empty if not recorded.
  std::vector<float> counts;   ///< (rows x num_taxels), storage order.
};

/// (a) Force on single taxels and their output, loading and unloading (paper, section III.B and figure 5).
struct ForceCurve {
  int curve_degree = 1;        ///< Degree of the fitted polynomial, 1 to kMaxCurveDegree. Default 1.
  bool divider = false;        ///< Whether to fit Readout::curve_limit, too. Default false.
  int curve_segments = 0;      ///< Number of line segments (Readout::curve_points), 2 to kMaxCurvePoints; 0 (default): a polynomial.
  std::vector<int> taxel;      ///< (rows), index of the taxel in storage order.
  std::vector<double> force;   ///< (rows), N.
  std::vector<double> counts;  ///< (rows).
  std::vector<double> time;    ///< (rows), s; empty if not recorded.
};

/// (b) Force and penetration depth (paper, section III.C and figure 6).
struct ForceDepth {
  Indenter indenter;          ///< What presses.
  std::vector<double> depth;  ///< (rows), m, from any zero: the fit finds the first contact.
  std::vector<double> force;  ///< (rows), N.
};

/// A footprint as a picture of high resolution, for example of a pressure film. Its middle is the origin of the footprint.
struct FootprintMask {
  std::size_t num_rows = 0;     ///< Pixels along x.
  std::size_t num_cols = 0;     ///< Pixels along y.
  double pixel = 0;             ///< m, > 0: side of a square pixel.
  std::vector<float> pressure;  ///< (num_rows x num_cols), >= 0, in any unit; 1 and 0 for a shape.
};

/// (c) Images of an indenter at known positions (`point_images`), or of a footprint (`footprint_images`).
struct PointImages {
  Indenter indenter;                            ///< What presses, unless there is a mask.
  std::vector<std::array<double, 2>> position;  ///< (rows), m, x and y in the frame of the sensor's first patch.
  std::vector<double> force;                    ///< (rows), N; empty if not measured.
  Images images;                                ///< One image per row.
  std::vector<double> yaw{};                    ///< (rows), rad, rotation of each footprint about z. Empty: all 0.
  std::optional<FootprintMask> mask{};          ///< The footprint.
  double position_error = 0;                    ///< m, >= 0, standard deviation of x and of y of an image; 0: they are exact.
};

/// (d) Output over time after one step of the load.
struct StepResponse {
  double load = 0;             ///< N, constant after the step.
  std::vector<double> time;    ///< (rows), s, rising.
  std::vector<double> counts;  ///< (rows), of one taxel, or the sum of all.
};

/// (e) Images over time under a flat stamp with a dead weight, at an unknown pose.
struct StampImages {
  Indenter indenter;      ///< The stamp.
  double load = 0;        ///< N, weight.
  Images images;          ///< Images over time.
  std::string fixture{};  ///< Stamps of one fixture have the same pose; empty: each stamp has its own.
  /// m, x and y of the stamp's middle in S, measured by hand. The fit does not use it; crossValidate() needs it where no other load was
  /// pressed at the same place.
  std::optional<std::array<double, 2>> position{};
};

/// (f) Images at rest under a pressure that is the same on the whole array, as under an air cushion.
struct UniformPress {
  std::vector<double> pressure;  ///< (rows), Pa; empty if not measured.
  std::vector<int> press;        ///< (rows), number of the press; rows of one press are frames that are averaged. Empty: a press per row.
  Images images;                 ///< One image per row.
};

/// Images for comparison only, of an unknown contact.
struct ImageSequence {
  Images images;  ///< Images over time.
};

/// One measurement.
struct Measurement {
  std::filesystem::path file;   ///< YAML file.
  std::string name;             ///< File name without extension.
  Sensor sensor;                ///< Prior: the layout, and all parameters that the measurements do not identify.
  std::string resolved_sensor;  ///< The sensor as canonical YAML text with all settings.
  std::variant<ForceCurve, ForceDepth, PointImages, StepResponse, StampImages, UniformPress, ImageSequence> data;  ///< The data, by kind.
  std::optional<double> temperature{};  ///< Degrees Celsius of the sensor; none if not recorded. Force curves and stamps only.
};

/// Reads a measurement. Throws Error(kInput), one line with file, line, column, key or column of the table, the value and what is allowed.
Measurement loadMeasurement(const std::filesystem::path& file);

}  // namespace taxelsim
