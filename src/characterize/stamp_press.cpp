#include "characterize/stamp_press.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "characterize/footprint.h"

namespace taxelsim {
namespace {

using namespace stamp_own;

constexpr double kLeastCosine = 0.3;  // between the normals of stamp and taxel; taxels that lean more are not touched

// The stamp's face in the frame P of one patch.
struct Face {
  Polygon outline{};  // empty if the patch leans too much
  Vector3 normal{};
  Vector3 middle{};
  std::array<double, 2> low{1e300, 1e300}, high{-1e300, -1e300};  // of the outline, m
};

std::vector<Face> facesOf(const StampModel& model, const Stamp& stamp, const double* own) {
  const Vector3 n_S{-own[kSlopeX], -own[kSlopeY], 1};
  const Polygon outline_S = moved(sectionOf(stamp.data->indenter, 0), {own[kX], own[kY]}, own[kYaw]);
  std::vector<Face> faces;
  for (const Pose& X_PS : model.X_PS) {
    Face& face = faces.emplace_back();
    face.normal = rotate(X_PS.rotation, n_S);
    face.middle = X_PS * Vector3{own[kX], own[kY], 0};
    if (face.normal[2] < kLeastCosine) continue;
    for (const auto& corner : outline_S) {
      const double z = own[kSlopeX] * (corner[0] - own[kX]) + own[kSlopeY] * (corner[1] - own[kY]);
      const Vector3 corner_P = X_PS * Vector3{corner[0], corner[1], z};
      face.outline.push_back({corner_P[0], corner_P[1]});
      for (std::size_t axis = 0; axis < 2; ++axis) {
        face.low[axis] = std::min(face.low[axis], corner_P[axis]);
        face.high[axis] = std::max(face.high[axis], corner_P[axis]);
      }
    }
  }
  return faces;
}

// A cell of the skin under the stamp.
struct Cell {
  int taxel;
  double area;    // m^2, covered
  double height;  // m, of the face over the skin along the taxel's normal, at descent 0
  double rate;    // m of depth per m of descent
};

struct CoveredCells {
  std::vector<Cell> cells{};
  double first_touch = 1e300;  // m: descent at which the first cell touches
};

CoveredCells coveredCells(const StampModel& model, const std::vector<Face>& faces) {
  CoveredCells covered;
  double deepest = -1e300;
  for (const reference::Sample& sample : model.samples) {
    const auto p = static_cast<std::size_t>(sample.patch);
    const Face& face = faces[p];
    if (face.outline.empty()) continue;
    const double x = sample.position_P[0], y = sample.position_P[1];
    const auto& half = model.half_cell[p];
    if (x + half[0] <= face.low[0] || x - half[0] >= face.high[0] || y + half[1] <= face.low[1] || y - half[1] >= face.high[1]) continue;
    const double area = overlap(face.outline, {x - half[0], y - half[1]}, {x + half[0], y + half[1]});
    if (area <= 0) continue;
    const Vector3& n = face.normal;
    const double height = face.middle[2] - (n[0] * (x - face.middle[0]) + n[1] * (y - face.middle[1])) / n[2];
    covered.cells.push_back({sample.taxel, area, height, 1 / n[2]});
    deepest = std::max(deepest, -height * n[2]);
  }
  covered.first_touch = -deepest;
  return covered;
}

// pressure = stiffness depth^exponent over the covered cells.
class Press {
 public:
  Press(const CoveredCells& covered, double stiffness, double exponent)
      : cells_(covered.cells), first_touch_(covered.first_touch), stiffness_(stiffness), exponent_(exponent) {}

  // Descent (m) that carries `load`, by Newton's method. Force is convex in the descent, so that steps from above never pass the root.
  double descentUnder(double load) const {
    double descent = first_touch_ + 1e-4;
    while (at(descent).force < load && descent < 1) descent = first_touch_ + 2 * (descent - first_touch_);
    for (int iteration = 0; iteration < 30; ++iteration) {
      const auto [force, slope] = at(descent);
      const double step = (force - load) / slope;
      if (!(step > 1e-13)) break;
      descent -= step;
    }
    return descent;
  }

  double forceAt(double descent) const { return at(descent).force; }

  void addForces(double descent, std::vector<double>& force) const {
    for (const Cell& cell : cells_) {
      const double depth = descent * cell.rate - cell.height;
      if (depth > 0) force[static_cast<std::size_t>(cell.taxel)] += cell.area * stiffness_ * std::pow(depth, exponent_);
    }
  }

 private:
  struct Response {
    double force = 0;  // N
    double slope = 0;  // N per m of descent
  };

  Response at(double descent) const {
    Response sum;
    for (const Cell& cell : cells_) {
      const double depth = descent * cell.rate - cell.height;
      if (depth <= 0) continue;
      const double below = exponent_ == 1 ? 1 : std::pow(depth, exponent_ - 1);
      sum.force += cell.area * stiffness_ * below * depth;
      sum.slope += cell.area * stiffness_ * exponent_ * below * cell.rate;
    }
    return sum;
  }

  const std::vector<Cell>& cells_;
  double first_touch_, stiffness_, exponent_;
};

}  // namespace

std::vector<double> forcesUnder(const StampModel& model, const Stamp& stamp, const double* own, double stiffness) {
  std::vector<double> force(model.gain.size(), 0.0);
  const CoveredCells covered = coveredCells(model, facesOf(model, stamp, own));
  if (covered.cells.empty()) return force;
  const Press press(covered, stiffness, model.foundation.normal_exponent);
  const double load = stamp.data->load, descent = press.descentUnder(load);
  press.addForces(descent, force);
  const double correction = load / std::max(press.forceAt(descent), 1e-300);
  for (double& value : force) value *= correction;
  return force;
}

}  // namespace taxelsim
