// Line intersections in closed form, sixteen samples of a taxel at once: convex polyhedra by the planes of their faces, and cylinders.
// Taxels without a touching sample are culled first, sixteen taxels at once.
#pragma once

#include <vector>

#include "geometry/polyhedron.h"
#include "peers/sample_view.h"
#include "taxelsim/object.h"

namespace taxelsim::bench {

class VectorPolyhedron {
 public:
  static constexpr std::size_t kMaxFaces = kLanes;

  VectorPolyhedron(const std::vector<Face>& faces, const Bounds& bounds);

  // Stages 1 and 2: writes the forces of all touched taxels and returns their range.
  TaxelRange press(const SampleView& view, const TaxelStage& stage, TaxelStage::Scratch& taxels) const;

 private:
  Floats normal_x_{}, normal_y_{}, normal_z_{}, offset_{};
  unsigned faces_;  // bits
  Bounds bounds_;
};

class VectorCylinder {
 public:
  explicit VectorCylinder(const Cylinder& cylinder);

  TaxelRange press(const SampleView& view, const TaxelStage& stage, TaxelStage::Scratch& taxels) const;

 private:
  float radius_, half_length_;
  Bounds bounds_;
};

}  // namespace taxelsim::bench
