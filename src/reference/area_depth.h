// Stage 1 of the reference for DepthSampling::kArea: mean penetration depth over the cell of each sample.
//
// The mean of f(z) (clipped_triangles.h) over the cell, z the lowest surface of the object along z of the patch. Closed meshes and boxes
// are summed over their triangles that look down, exactly; half-spaces likewise. Other solids are integrated over rays (mean_depth.h). A
// mesh that is not closed has the depth at the middle of the cell. Of several objects, the one with the largest mean counts; ties go to the
// lower index.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "reference/cell_points.h"
#include "reference/clipped_triangles.h"
#include "reference/depth.h"
#include "reference/mean_depth.h"
#include "taxelsim/sensor.h"

namespace taxelsim::reference {

// All of shape (num_taxels x s x s), in the order of samplesOf().
struct AreaDepths {
  std::vector<double> mean;   // m, 0 to thickness: the penetration
  std::vector<double> share;  // of the cell that the object with the largest mean covers, 0 to 1
  std::vector<int> touching;  // index of this object, or kNoContact
  // Of what this object covers; empty where the mean depth of a cell determines its forces, varies().
  std::vector<CellPoints> points;
};

// A cell is at the full thickness of the skin if an object covers this share of it, with this part of the thickness as the mean depth of
// what is covered.
inline constexpr double kLeastShareOfFull = 0.25, kFullDepth = 0.999;

// Whether forces depend on how the depth varies within a cell: with friction, for exponents other than 1, and on an elastic layer.
bool varies(const Sensor& sensor);

// Mean depth of the covered part of a cell, m; 0 for less than kLeastShareOfFull.
std::vector<double> coveredDepths(const AreaDepths& depths);

// Objects over a sensor, with their meshes oriented once for many offsets. Refers to both, which must outlive it.
class AreaDepth {
 public:
  AreaDepth(const Sensor& sensor, std::span<const PlacedObject> objects);

  // After a translation of the objects by `offset` (m) along z of S.
  AreaDepths at(double offset = 0) const;

  // Of one object alone, over the cells of all patches, after that translation.
  std::vector<CellDepth> cellsOf(std::size_t number, double offset) const;

  // Offset at which a surface first reaches a cell along z of S; a mesh that is not closed: a sample. -infinity if no object is over any.
  double firstTouch() const;

 private:
  struct Placed {
    PlacedObject placed;
    // In O, with outward winding; of boxes and meshes that are closed.
    std::optional<std::vector<Triangle>> faces;
  };
  std::vector<CellDepth> cellDepths(const Placed& object, const GridPatch& patch, const DepthRange& range, double offset) const;
  double lowestAlong(const Placed& object, const GridPatch& patch, const Vector3& direction_P) const;

  const Sensor& sensor_;
  std::vector<double> view_depths_;  // (num_patches), m
  std::vector<Placed> objects_;
};

// AreaDepths::mean of objects at rest.
std::vector<double> meanPenetrations(const Sensor& sensor, std::span<const PlacedObject> objects);

// Fraction of the samples whose cell is at the full thickness of the skin.
double overPenetration(const Sensor& sensor, const AreaDepths& depths);

}  // namespace taxelsim::reference
