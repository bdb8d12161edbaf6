// The Open Dynamics Engine, which the paper's simulator stands on, as a source of contact points: collision only, no bodies move.
//
// Trusted for what it reports, not for what that should be: where the points lie and how many there are depends on the shapes' kinds and
// triangles.
#pragma once

#include <memory>
#include <vector>

#include "taxelsim/contact_point.h"
#include "taxelsim/object.h"
#include "taxelsim/sensor.h"

namespace taxelsim::support {

// A sphere, cylinder, box or mesh in ODE.
class OdeShape {
 public:
  explicit OdeShape(const Object& object);
  ~OdeShape();
  OdeShape(OdeShape&&) noexcept;

  struct Impl;
  Impl& impl() const { return *impl_; }

 private:
  std::unique_ptr<Impl> impl_;
};

// The sensor as one box under the skin's surface, over a patch whose frame is S; its pose is boxPose(). As a mesh: reference/skin_mesh.h.
Box sensorBox(const GridPatch& patch);
Pose boxPose(const GridPatch& patch);

struct OdeContact {
  Vector3 position;  // m, in S
  Vector3 normal;    // in S
  double depth;      // m, >= 0
};

// At most `cap` of them, 1 to 65535: in ODE the caller's buffer decides, and what does not fit is not looked for.
std::vector<OdeContact> odeContacts(const OdeShape& sensor, const Pose& X_S_sensor, const OdeShape& object, const Pose& X_SO, int cap);

// The paper's penalty, `stiffness` (N/m) times depth, of which what presses along z of S is the normal force.
std::vector<ContactPoint> penaltyForces(const std::vector<OdeContact>& contacts, double stiffness);

}  // namespace taxelsim::support
