#include "support/ode_contacts.h"

#include <ode/ode.h>

#include "support/test.h"

namespace taxelsim::support {
namespace {

// ODE prints a warning about full tables once per collision of two meshes.
void ignoreMessage(int, const char*, va_list) {}

struct Engine {
  Engine() {
    dInitODE2(0);
    dAllocateODEDataForThread(dAllocateMaskAll);
    dSetMessageHandler(ignoreMessage);
  }
  ~Engine() { dCloseODE(); }
};

void startEngine() {
  static const Engine engine;
}

struct GeomRelease {
  void operator()(dGeomID geom) const { dGeomDestroy(geom); }
};
struct MeshRelease {
  void operator()(dTriMeshDataID mesh) const { dGeomTriMeshDataDestroy(mesh); }
};

void place(dGeomID geom, const Pose& X_SG) {
  const dQuaternion q{X_SG.rotation[0], X_SG.rotation[1], X_SG.rotation[2], X_SG.rotation[3]};
  dGeomSetPosition(geom, X_SG.position[0], X_SG.position[1], X_SG.position[2]);
  dGeomSetQuaternion(geom, q);
}

}  // namespace

struct OdeShape::Impl {
  // ODE keeps pointers into these.
  std::vector<double> vertices;
  std::vector<dTriIndex> triangles;
  std::unique_ptr<std::remove_pointer_t<dTriMeshDataID>, MeshRelease> mesh_data;
  std::unique_ptr<std::remove_pointer_t<dGeomID>, GeomRelease> geom;

  void make(const Sphere& sphere) { geom.reset(dCreateSphere(nullptr, sphere.radius)); }
  void make(const Cylinder& cylinder) { geom.reset(dCreateCylinder(nullptr, cylinder.radius, cylinder.length)); }
  void make(const Box& box) { geom.reset(dCreateBox(nullptr, box.size[0], box.size[1], box.size[2])); }
  void make(const Mesh& mesh) {
    for (const std::array<float, 3>& vertex : mesh.vertices) vertices.insert(vertices.end(), vertex.begin(), vertex.end());
    for (const std::array<std::uint32_t, 3>& corners : mesh.triangles) triangles.insert(triangles.end(), corners.begin(), corners.end());
    mesh_data.reset(dGeomTriMeshDataCreate());
    dGeomTriMeshDataBuildDouble(mesh_data.get(), vertices.data(), 3 * sizeof(double), static_cast<int>(vertices.size() / 3),
                                triangles.data(), static_cast<int>(triangles.size()), 3 * sizeof(dTriIndex));
    dGeomTriMeshDataPreprocess2(mesh_data.get(), 1u << dTRIDATAPREPROCESS_BUILD_CONCAVE_EDGES, nullptr);
    geom.reset(dCreateTriMesh(nullptr, mesh_data.get(), nullptr, nullptr, nullptr));
  }
  template <typename Other>
  void make(const Other&) {
    throw std::logic_error("not one of the shapes that are compared with ODE");
  }
};

OdeShape::OdeShape(const Object& object) : impl_(std::make_unique<Impl>()) {
  startEngine();
  std::visit([&](const auto& shape) { impl_->make(shape); }, object.shape);
}
OdeShape::~OdeShape() = default;
OdeShape::OdeShape(OdeShape&&) noexcept = default;

namespace {
constexpr double kBoxHeight = 0.01;  // m; deeper than anything is pressed
}

Box sensorBox(const GridPatch& patch) {
  return {{patch.num_rows * patch.pitch[0], patch.num_cols * patch.pitch[1], kBoxHeight}};
}

Pose boxPose(const GridPatch&) {
  return {.position = {0, 0, -kBoxHeight / 2}};
}

std::vector<OdeContact> odeContacts(const OdeShape& sensor, const Pose& X_S_sensor, const OdeShape& object, const Pose& X_SO, int cap) {
  place(sensor.impl().geom.get(), X_S_sensor);
  place(object.impl().geom.get(), X_SO);
  std::vector<dContactGeom> found(static_cast<std::size_t>(cap));
  found.resize(static_cast<std::size_t>(
      dCollide(sensor.impl().geom.get(), object.impl().geom.get(), cap, found.data(), static_cast<int>(sizeof(dContactGeom)))));
  std::vector<OdeContact> contacts;
  for (const dContactGeom& contact : found) {
    contacts.push_back({{contact.pos[0], contact.pos[1], contact.pos[2]},
                        {contact.normal[0], contact.normal[1], contact.normal[2]},
                        std::max(contact.depth, 0.0)});
  }
  return contacts;
}

std::vector<ContactPoint> penaltyForces(const std::vector<OdeContact>& contacts, double stiffness) {
  std::vector<ContactPoint> points;
  for (const OdeContact& contact : contacts) {
    points.push_back({contact.position, stiffness * contact.depth * std::abs(contact.normal[2])});
  }
  return points;
}

}  // namespace taxelsim::support
