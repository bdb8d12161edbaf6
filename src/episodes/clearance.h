// Distance between the taxels of a sensor and an object, for messages.
#pragma once

#include <vector>

#include "taxelsim/scene.h"

namespace taxelsim {

class Clearance {
 public:
  Clearance(const Sensor& sensor, const std::vector<SceneObject>& objects);

  // m, between the boxes around taxels and object: a lower bound, 0 where the boxes meet.
  double of(std::size_t object, const Pose& X_SO) const;
  // m, of a point in S.
  double of(const Vector3& point) const;

 private:
  Bounds taxels_;                // in S
  std::vector<Bounds> objects_;  // each in its O
};

}  // namespace taxelsim
