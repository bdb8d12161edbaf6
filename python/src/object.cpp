// Objects: analytic solids, meshes from arrays or files.
#include "taxelsim/object.h"

#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/filesystem.h>
#include <nanobind/stl/optional.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/string_view.h>

#include <cstring>
#include <optional>

#include "any_object.h"
#include "geometry/object_fields.h"
#include "geometry/unit_check.h"
#include "interruptible.h"
#include "structs.h"
#include "taxelsim/error.h"

namespace taxelsim::python {
namespace {

using Vertices = nb::ndarray<const float, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
using Triangles = nb::ndarray<const std::uint32_t, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;

void makeMesh(Mesh* self, nb::handle vertex_array, nb::handle triangle_array) {
  const nb::tuple checked(nb::module_::import_("taxelsim._arrays").attr("mesh_arrays")(vertex_array, triangle_array));
  const auto vertices = nb::cast<Vertices>(checked[0]);
  const auto triangles = nb::cast<Triangles>(checked[1]);
  Mesh mesh;
  mesh.vertices.resize(vertices.shape(0));
  mesh.triangles.resize(triangles.shape(0));
  if (vertices.size() > 0) std::memcpy(mesh.vertices.data(), vertices.data(), vertices.nbytes());
  if (triangles.size() > 0) std::memcpy(mesh.triangles.data(), triangles.data(), triangles.nbytes());
  checkObject(mesh);
  new (self) Mesh(std::move(mesh));
}

// (num_rows x 3), read-only, without a copy: the array keeps the mesh alive.
template <typename T>
nb::ndarray<nb::numpy, const T, nb::shape<-1, 3>> rowsOf(nb::handle mesh, const std::vector<std::array<T, 3>>& rows) {
  return {rows.data(), {rows.size(), 3}, mesh};
}

Mesh centered(const Mesh& mesh) {
  const Bounds bounds = boundsOf(mesh);
  Mesh moved = mesh;
  for (std::array<float, 3>& vertex : moved.vertices) {
    for (std::size_t axis = 0; axis < 3; ++axis)
      vertex[axis] = static_cast<float>(vertex[axis] - (bounds.min[axis] + bounds.max[axis]) / 2);
  }
  return moved;
}

void bindMesh(nb::module_& module) {
  nb::class_<Mesh>(module, "Mesh", R"(A triangle mesh in its own frame O, m.

Order and winding are free, and the mesh need not be closed: only the lowest surface above a sample counts.)")
      .def("__init__", &makeMesh, "vertices"_a, "triangles"_a,
           nb::sig("def __init__(self, vertices: numpy.typing.ArrayLike, triangles: numpy.typing.ArrayLike) -> None"), R"(Copies arrays.

vertices: (num_vertices, 3), m, in O. triangles: (num_triangles, 3) integers, indices into `vertices`.

Raises InputError for another shape or dtype, NaN, an index out of range, or no triangle.)")
      .def_prop_ro(
          "vertices", [](nb::handle self) { return rowsOf(self, nb::cast<const Mesh&>(self).vertices); }, nb::rv_policy::automatic,
          "(num_vertices, 3) float32, m, in O. Read-only, no copy.")
      .def_prop_ro(
          "triangles", [](nb::handle self) { return rowsOf(self, nb::cast<const Mesh&>(self).triangles); }, nb::rv_policy::automatic,
          "(num_triangles, 3) uint32, indices into `vertices`. Read-only, no copy.")
      .def("centered", &centered, "A copy whose bounding box has its middle in the origin.")
      .def(
          "__eq__", [](const Mesh& a, const Mesh& b) { return a.vertices == b.vertices && a.triangles == b.triangles; }, nb::is_operator(),
          nb::sig("def __eq__(self, other: object, /) -> bool"))
      .def(
          "__reduce__",
          [](nb::handle self) { return nb::make_tuple(self.type(), nb::make_tuple(self.attr("vertices"), self.attr("triangles"))); },
          nb::sig("def __reduce__(self) -> tuple[typing.Any, ...]"))
      .def("__repr__", [](const Mesh& mesh) {
        return "<taxelsim.Mesh of " + std::to_string(mesh.vertices.size()) + " vertices, " + std::to_string(mesh.triangles.size()) +
               " triangles>";
      });
  nb::enum_<UpAxis>(module, "UpAxis", "Axis of a mesh file that becomes z.")
      .value("X", UpAxis::kX, "The file's x.")
      .value("Y", UpAxis::kY, "The file's y.")
      .value("Z", UpAxis::kZ, "The file's z.");
  module.def(
      "load_mesh",
      [](const std::filesystem::path& file, std::optional<double> scale, std::optional<double> size, const Argument<UpAxis>& up_axis,
         double max_depth_error) {
        if (scale && size) throw Error(ErrorKind::kInput, "load_mesh(): scale and size are not allowed: one of them");
        const MeshOptions options{.scale = scale.value_or(1), .size = size, .up_axis = up_axis.value, .max_depth_error = max_depth_error};
        return loadInterruptibly([&] { return loadMesh(file, options); });
      },
      "file"_a, nb::kw_only(), "scale"_a = nb::none(), "size"_a = nb::none(), "up_axis"_a = UpAxis::kZ,
      "max_depth_error"_a = MeshOptions{}.max_depth_error,
      R"(Reads OBJ, STL, PLY or glTF as a Mesh.

scale: metres per unit of the file, 0.001 for millimetres; default 1.
size: instead of scale: m, the longest side of the bounding box that the mesh gets.
up_axis: axis of the file that becomes z.
max_depth_error: m, bound of the simplification; 0 keeps every triangle. For a stiff skin use max_depth_error_of(sensor.skin).

Raises InputError for a file that is missing, too large, or not a mesh.)");
}

void bindSolids(nb::module_& module) {
  nb::class_<Sphere> sphere(module, "Sphere", "Sphere, centred on the origin.");
  addTables(sphere, fieldsOf<kSphereFields>());
  nb::class_<Cylinder> cylinder(module, "Cylinder", "Cylinder along z with flat ends, centred on the origin.");
  addTables(cylinder, fieldsOf<kCylinderFields>());
  nb::class_<Capsule> capsule(module, "Capsule", "Capsule along z, centred on the origin.");
  addTables(capsule, fieldsOf<kCapsuleFields>());
  nb::class_<Box> box(module, "Box", "Box, centred on the origin.");
  addTables(box, fieldsOf<kBoxFields>());
  nb::class_<HalfSpace> half_space(module, "HalfSpace", "All points with z >= 0 in O.");
  addFields(half_space);
  nb::class_<Cone> cone(module, "Cone", "Cone with its apex at the origin and its axis along +z.");
  addTables(cone, fieldsOf<kConeFields>());
  nb::class_<Torus> torus(module, "Torus", "Torus with axis z, centred on the origin.");
  addTables(torus, fieldsOf<kTorusFields>());
}

}  // namespace

void bindObjects(nb::module_& module) {
  bindMesh(module);
  bindSolids(module);
  nb::class_<Object> type(module, "Object", "A named shape.");
  type.def(
          "__init__",
          [](Object* self, const Shape& shape, const std::string& name) {
            new (self) Object(shape);
            if (!name.empty()) self->name = name;
          },
          "shape"_a, "name"_a = "", "shape: a Mesh or a solid. name: for messages and data sets; default: the kind of the shape.")
      .def_ro("shape", &Object::shape, "Geometry in O: a Mesh or a solid.")
      .def_ro("name", &Object::name, "Name in messages and data sets.");
  addValueSemantics(type, nb::make_tuple("shape", "name"));
  module.def(
      "parse_object",
      [](std::string_view text, double scale, const Argument<UpAxis>& up_axis, double max_depth_error) {
        return loadInterruptibly(
            [&] { return parseObject(text, {.scale = scale, .up_axis = up_axis.value, .max_depth_error = max_depth_error}); });
      },
      "text"_a, nb::kw_only(), "scale"_a = 1.0, "up_axis"_a = UpAxis::kZ, "max_depth_error"_a = MeshOptions{}.max_depth_error,
      R"(An Object from the notation of the command line.

text: a mesh file, or sphere:R, cylinder:R,L, capsule:R,L, box:X,Y,Z, half_space, cone:R,H, torus:MAJOR,MINOR, in metres.
scale, up_axis, max_depth_error: of a mesh file, as in load_mesh().)");
  module.attr("LONGEST_PLAUSIBLE") = kLongestPlausible;  // m
  module.def(
      "check_object", [](const AnyObject& object) { checkObject(objectOf(object)); }, "object"_a,
      "Raises InputError if a dimension is out of range or a mesh is not valid.");
  module.def(
      "bounds_of",
      [](const AnyObject& object) {
        const Bounds bounds = boundsOf(objectOf(object));
        return std::pair(bounds.min, bounds.max);
      },
      "object"_a, "Axis-aligned bounding box in O: lowest and highest coordinates, m.");
  module.def(
      "lowest_point", [](const AnyObject& object, const Quaternion& R_SO) { return lowestPoint(objectOf(object), R_SO); }, "object"_a,
      "R_SO"_a = Quaternion{1, 0, 0, 0},
      "Lowest point (m, in O) of the object rotated by the quaternion R_SO (w, x, y, z): its first contact with a flat skin.");
}

}  // namespace taxelsim::python
