#include <cmath>
#include <string>

#include "base/text.h"
#include "taxelsim/error.h"
#include "taxelsim/object.h"

namespace taxelsim {
namespace {

struct ShapeChecker {
  const std::string& name;

  [[noreturn]] void fail(const std::string& field, double value, const char* allowed) const {
    throw Error(ErrorKind::kInput, "object '" + oneLine(name) + "': " + field + ": " + numberText(value) + " is not allowed: " + allowed);
  }

  void positive(const char* field, double value) const {
    if (!(std::isfinite(value) && value > 0)) fail(field, value, "m, > 0");
  }

  void operator()(const Sphere& sphere) const { positive("radius", sphere.radius); }

  void operator()(const Cylinder& cylinder) const {
    positive("radius", cylinder.radius);
    positive("length", cylinder.length);
  }

  void operator()(const Capsule& capsule) const {
    positive("radius", capsule.radius);
    if (!(std::isfinite(capsule.length) && capsule.length >= 0)) fail("length", capsule.length, "m, >= 0");
  }

  void operator()(const Box& box) const {
    positive("size[0]", box.size[0]);
    positive("size[1]", box.size[1]);
    positive("size[2]", box.size[2]);
  }

  void operator()(const HalfSpace&) const {}

  void operator()(const Cone& cone) const {
    positive("radius", cone.radius);
    positive("height", cone.height);
  }

  void operator()(const Torus& torus) const {
    positive("minor_radius", torus.minor_radius);
    positive("major_radius", torus.major_radius);
    if (!(torus.major_radius > torus.minor_radius)) fail("major_radius", torus.major_radius, "m, > minor_radius");
  }

  void operator()(const Mesh& mesh) const {
    if (mesh.triangles.empty()) throw Error(ErrorKind::kInput, "object '" + oneLine(name) + "': the mesh has no triangle");
    for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
      for (const float coordinate : mesh.vertices[i]) {
        if (!std::isfinite(coordinate)) fail("vertices[" + std::to_string(i) + "]", coordinate, "finite coordinates");
      }
    }
    for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
      for (const std::uint32_t index : mesh.triangles[i]) {
        if (index >= mesh.vertices.size()) {
          throw Error(ErrorKind::kInput, "object '" + oneLine(name) + "': triangles[" + std::to_string(i) + "]: index " +
                                             std::to_string(index) + " is not allowed: < " + std::to_string(mesh.vertices.size()) +
                                             ", the number of vertices");
        }
      }
    }
  }
};

}  // namespace

void checkObject(const Object& object) {
  std::visit(ShapeChecker{object.name}, object.shape);
}

}  // namespace taxelsim
