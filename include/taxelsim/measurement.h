// Measurements of a real sensor on a bench, as files that people write: a table (CSV) and a small YAML file that says what the table
// cannot (docs/measurements.md). What they are good for: characterize.h, compare.h.
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "taxelsim/sensor.h"

namespace taxelsim {

// What presses on the skin, its lowest point downwards and its axis along the skin's normal.
struct Indenter {
  enum class Shape {
    kFlatPin,   // a circle of `radius`
    kStamp,     // a rectangle of `size`
    kSphere,    // of `radius`
    kCylinder,  // lying: of `radius` and `length`
    kCone,      // of `half_angle` between axis and side
  };

  Shape shape = Shape::kFlatPin;
  double radius = 0;                 // m, > 0 where the shape has one
  double length = 0;                 // m, > 0
  double half_angle = 0;             // rad, > 0, < pi/2
  std::array<double, 2> size{0, 0};  // m, > 0: along x, along y of the sensor

  // Area (m^2) of the indenter's section `height` (m, >= 0) over its lowest point; of what a sphere or a cylinder is above its middle the
  // middle's.
  double sectionAt(double height) const;
};

// Images one after another. A row is a reading of all taxels, counts as recorded.
struct Images {
  std::size_t num_taxels = 0;
  std::vector<double> time;   // (rows), s, rising; empty where none was recorded
  std::vector<float> counts;  // (rows x num_taxels), storage order
};

// (a) Force on single taxels against their output, as the force goes up and down; paper, section III.B and figure 5.
struct ForceCurve {
  int curve_degree = 1;        // of the polynomial to fit, 1 to kMaxCurveDegree
  bool divider = false;        // whether Readout::curve_limit is fitted, too
  int curve_segments = 0;      // 2 to kMaxCurvePoints: instead of both, straight pieces (Readout::curve_points); 0: none
  std::vector<int> taxel;      // (rows), index in storage order
  std::vector<double> force;   // (rows), N
  std::vector<double> counts;  // (rows)
  std::vector<double> time;    // (rows), s; empty where none was recorded
};

// (b) Force against penetration depth; paper, section III.C and figure 6.
struct ForceDepth {
  Indenter indenter;
  std::vector<double> depth;  // (rows), m, from wherever the stage's zero is: contact is found
  std::vector<double> force;  // (rows), N
};

// (c) Images under an indenter at known places.
struct PointImages {
  Indenter indenter;
  std::vector<std::array<double, 2>> position;  // (rows), m, x and y in the frame of the sensor's first patch
  std::vector<double> force;                    // (rows), N; empty where none was measured
  Images images;
};

// (d) Output over time under a constant load that is put on once.
struct StepResponse {
  double load = 0;             // N
  std::vector<double> time;    // (rows), s, rising
  std::vector<double> counts;  // (rows): of one taxel, or the sum of all
};

// (e) Images over time under a flat stamp with a dead weight, which lies where it lies.
struct StampImages {
  Indenter indenter;
  double load = 0;  // N
  Images images;
};

// Images to hold others against: no claim about what touched.
struct ImageSequence {
  Images images;
};

struct Measurement {
  std::filesystem::path file;
  std::string name;             // of the file, without its ending
  Sensor sensor;                // as known before: where its taxels are, and all that the measurements do not tell
  std::string resolved_sensor;  // the same as text: every setting, in one spelling
  std::variant<ForceCurve, ForceDepth, PointImages, StepResponse, StampImages, ImageSequence> data;
};

// Reads a measurement. Throws Error(kInput), one line with file, line, column, key or column of the table, value, and what is allowed.
Measurement loadMeasurement(const std::filesystem::path& file);

}  // namespace taxelsim
