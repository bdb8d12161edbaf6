// The Open Dynamics Engine, used by the paper's simulator, as a source of contact points: collision only, no dynamics.
//
// Trusted as a record of what ODE reports: position and number of points depend on the kinds of shapes and on triangles.
#pragma once

#include "support/test.h"
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

// At most `cap` contacts, 1 to 65535: the buffer of the caller limits what ODE searches for.
std::vector<OdeContact> odeContacts(const OdeShape& sensor, const Pose& X_S_sensor, const OdeShape& object, const Pose& X_SO, int cap);

// The paper's penalty force: `stiffness` (N/m) times depth; its component along z of S is the normal force.
std::vector<ContactPoint> penaltyForces(const std::vector<OdeContact>& contacts, double stiffness);

}  // namespace taxelsim::support
