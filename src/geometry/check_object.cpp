#include <cmath>
#include <string>

#include "base/field_checks.h"
#include "geometry/object_fields.h"

namespace taxelsim {
namespace {

// Errors have the field alone.
struct ShapeChecker {
  void operator()(const Sphere& sphere) const { checkFields("", kSphereFields, sphere); }
  void operator()(const Cylinder& cylinder) const { checkFields("", kCylinderFields, cylinder); }
  void operator()(const Capsule& capsule) const { checkFields("", kCapsuleFields, capsule); }
  void operator()(const Box& box) const { checkFields("", kBoxFields, box); }
  void operator()(const HalfSpace&) const {}
  void operator()(const Cone& cone) const { checkFields("", kConeFields, cone); }

  void operator()(const Torus& torus) const {
    checkFields("", kTorusFields, torus);
    if (torus.major_radius > torus.minor_radius) return;
    failField("major_radius", numberText(torus.major_radius), "a number > minor_radius (" + numberText(torus.minor_radius) + ") m");
  }

  void operator()(const Mesh& mesh) const {
    if (mesh.triangles.empty()) throw Error(ErrorKind::kInput, "the mesh has no triangle");
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
      for (const float coordinate : mesh.vertices[i]) {
        if (!std::isfinite(coordinate)) failField(elementOf("vertices", i), numberText(coordinate), "finite coordinates");
      }
    }
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      for (const std::uint32_t index : mesh.triangles[i]) {
        if (index >= mesh.vertices.size()) {
          failField(elementOf("triangles", i), "index " + std::to_string(index),
                    "< " + std::to_string(mesh.vertices.size()) + ", the number of vertices");
        }
      }
    }
  }
};

}  // namespace

void checkObject(const Object& object) {
  try {
    std::visit(ShapeChecker{}, object.shape);
  } catch (const Error& error) {
    throw Error(ErrorKind::kInput, "object '" + oneLine(object.name) + "': " + error.what());
  }
}

}  // namespace taxelsim
