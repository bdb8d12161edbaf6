
#include <clocale>

#include "geometry/mesh_files.h"
#include "support/random_scene.h"
#include "support/test.h"

namespace taxelsim {
namespace {

constexpr const char* kRoot = R"([{"mesh":0}])";

struct FormatCase {
  const char* file;
  std::string (*write)(const Mesh&);
};

class EveryFormat : public ::testing::TestWithParam<FormatCase> {};

TEST_P(EveryFormat, GivesTheSameWeldedMesh) {
  const testing::TemporaryDirectory directory;
  directory.write("brick.bin", gltfBuffer(brick()));
  const Mesh mesh = loadMesh(directory.write(GetParam().file, GetParam().write(brick())));
  EXPECT_EQ(mesh.vertices.size(), 8u);
  EXPECT_EQ(mesh.triangles.size(), 12u);
  EXPECT_EQ(canonical(mesh), canonical(brick()));
}

TEST_P(EveryFormat, IsDeterministic) {
  const testing::TemporaryDirectory directory;
  directory.write("brick.bin", gltfBuffer(brick()));
  const std::filesystem::path file = directory.write(GetParam().file, GetParam().write(brick()));
  EXPECT_EQ(loadMesh(file).vertices, loadMesh(file).vertices);
  EXPECT_EQ(loadMesh(file).triangles, loadMesh(file).triangles);
}

INSTANTIATE_TEST_SUITE_P(Formats, EveryFormat,
                         ::testing::Values(FormatCase{"brick.obj", objText}, FormatCase{"BRICK.OBJ", objText},
                                           FormatCase{"text.stl", stlText}, FormatCase{"binary.stl", stlBytes},
                                           FormatCase{"text.ply", plyText}, FormatCase{"binary.ply", plyBytes},
                                           FormatCase{"brick.gltf", [](const Mesh& mesh) { return gltfJson(mesh, "brick.bin", kRoot); }},
                                           FormatCase{"brick.glb", [](const Mesh& mesh) { return glbBytes(mesh, kRoot); }}),
                         [](const auto& format) {
                           std::string name = format.param.file;
                           std::replace(name.begin(), name.end(), '.', '_');
                           return name;
                         });

TEST(LoadMesh, SkipsAByteOrderMark) {
  const testing::TemporaryDirectory directory;
  directory.write("brick.bin", gltfBuffer(brick()));
  const std::string mark = "\xEF\xBB\xBF";
  for (const auto& [name, text] : {std::pair{"brick.obj", objText(brick()).substr(sizeof("# a brick"))},
                                   {"brick.stl", stlText(brick())},
                                   {"brick.ply", plyText(brick())},
                                   {"brick.gltf", gltfJson(brick(), "brick.bin", kRoot)}})
    EXPECT_EQ(canonical(loadMesh(directory.write(name, mark + text))), canonical(brick())) << name;
}

TEST(LoadMesh, AppliesTheTransformsOfAllAncestors) {
  const testing::TemporaryDirectory directory;
  // Scaled by 2, rotated by 90 degrees about z, then translated by (1, 2, 4): (x, y, z) -> (1 - 2 y, 2 + 2 x, 4 + 2 z).
  const std::string nodes =
      R"([{"translation":[1,2,4],"children":[1]},{"rotation":[0,0,0.70710678118,0.70710678118],"children":[2]},{"scale":[2,2,2],"mesh":0}])";
  const Mesh mesh = loadMesh(directory.write("brick.glb", glbBytes(brick(), nodes)));
  Mesh expected = brick();
  for (Corner& v : expected.vertices) v = {1 - 2 * v[1], 2 + 2 * v[0], 4 + 2 * v[2]};
  const Bounds bounds = boundsOf(mesh);
  const Bounds expected_bounds = boundsOf(expected);
  // Nodes rotate in float32: four rounding errors of coordinates up to 8.
  constexpr double kTolerance = 8 * 4 * 1.2e-7;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    EXPECT_NEAR(bounds.min[axis], expected_bounds.min[axis], kTolerance);
    EXPECT_NEAR(bounds.max[axis], expected_bounds.max[axis], kTolerance);
  }
}

TEST(LoadMesh, IncludesAMeshOncePerNode) {
  const testing::TemporaryDirectory directory;
  const std::string nodes = R"([{"mesh":0,"children":[1]},{"mesh":0,"translation":[10,0,0]}])";
  const Mesh mesh = loadMesh(directory.write("brick.glb", glbBytes(brick(), nodes)));
  EXPECT_EQ(mesh.vertices.size(), 16u);
  EXPECT_EQ(mesh.triangles.size(), 24u);
  EXPECT_EQ(boundsOf(mesh).max, (Vector3{10.5, 0.25, 2}));
}

TEST(LoadMesh, MergesObjectsOfAnObjFile) {
  const testing::TemporaryDirectory directory;
  const Mesh mesh = loadMesh(directory.write("two.obj", "o one\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\no two\nv 0 0 5\nf 1 2 4\n"));
  EXPECT_EQ(mesh.vertices.size(), 4u);
  EXPECT_EQ(mesh.triangles.size(), 2u);
}

TEST(LoadMesh, ScalesAndPermutesAxesCyclically) {
  const testing::TemporaryDirectory directory;
  const std::filesystem::path file = directory.write("brick.obj", objText(brick()));
  // The brick is 0.5 x 0.25 x 2 in the file.
  EXPECT_EQ(boundsOf(loadMesh(file, {.scale = 0.5})).max, (Vector3{0.25, 0.125, 1}));
  EXPECT_EQ(boundsOf(loadMesh(file, {.up_axis = UpAxis::kY})).max, (Vector3{2, 0.5, 0.25}));
  EXPECT_EQ(boundsOf(loadMesh(file, {.up_axis = UpAxis::kX})).max, (Vector3{0.25, 2, 0.5}));
}

TEST(LoadMesh, TriangulatesConcavePolygons) {
  const testing::TemporaryDirectory directory;
  // An L shape of area 3. A fan from its first corner would overlap itself.
  const Mesh mesh = loadMesh(directory.write("l.obj", "v 0 2 0\nv 0 0 0\nv 2 0 0\nv 2 1 0\nv 1 1 0\nv 1 2 0\nf 1 2 3 4 5 6\n"));
  ASSERT_EQ(mesh.triangles.size(), 4u);
  double area = 0;
  for (const auto& t : mesh.triangles) {
    const Corner &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    area += 0.5 * std::abs((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
  }
  EXPECT_EQ(area, 3);
}

TEST(LoadMesh, DropsLinesPointsAndDegenerateTriangles) {
  const testing::TemporaryDirectory directory;
  const Mesh mesh =
      loadMesh(directory.write("mixed.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nv 9 9 9\nf 1 2 3\nf 1 2 4\nf 1 1 2\nl 1 5\np 5\n"));
  EXPECT_EQ(mesh.triangles.size(), 1u);
  EXPECT_EQ(mesh.vertices.size(), 3u);
}

TEST(LoadMesh, DoesNotOpenMaterialFiles) {
  const testing::TemporaryDirectory directory;
  const Mesh mesh = loadMesh(directory.write("brick.obj", "mtllib /dev/zero\nusemtl grey\n" + objText(brick())));
  EXPECT_EQ(canonical(mesh), canonical(brick()));
}

TEST(LoadMesh, MaxDepthErrorIsInMetresAfterScaling) {
  const testing::TemporaryDirectory directory;
  support::Random random(1);
  // A sphere of radius 10 mm, in millimetres. Edges are at most 0.83 mm; vertices of adjacent triangles are 9 to 34 um off
  // a triangle's plane.
  const Mesh sphere = support::icosphere(10, 4, 0, random);
  const std::filesystem::path file = directory.write("sphere.stl", stlBytes(sphere));
  EXPECT_EQ(loadMesh(file, {.scale = 1e-3, .max_depth_error = 0}).triangles.size(), 5120u);
  EXPECT_EQ(loadMesh(file, {.scale = 1e-3, .max_depth_error = 1e-6}).triangles.size(), 5120u);
  EXPECT_LT(loadMesh(file, {.scale = 1e-3, .max_depth_error = 1e-4}).triangles.size(), 1500u);
  EXPECT_EQ(loadMesh(file, {.scale = 1, .max_depth_error = 1e-4}).triangles.size(), 5120u);
}

TEST(LoadMesh, DefaultMaxDepthErrorIsTenMicrometres) {
  EXPECT_EQ(MeshOptions{}.max_depth_error, 1e-5);
  const testing::TemporaryDirectory directory;
  support::Random random(1);
  const Mesh plate = support::sheetWithHoles(30, 0.02, 4e-6, 0, random);
  const std::filesystem::path file = directory.write("plate.stl", stlBytes(plate));
  EXPECT_EQ(loadMesh(file, {.max_depth_error = 0}).triangles.size(), 1800u);
  EXPECT_LT(loadMesh(file).triangles.size(), 600u);
  EXPECT_LT(std::get<Mesh>(parseObject(file.string()).shape).triangles.size(), 600u);
}

TEST(LoadMesh, IsIndependentOfTheLocale) {
  const testing::TemporaryDirectory directory;
  const std::filesystem::path file = directory.write("brick.obj", objText(brick()));
  const std::string before = std::setlocale(LC_ALL, nullptr);
  for (const char* locale : {"de_DE.UTF-8", "fr_FR.UTF-8", "C"}) std::setlocale(LC_ALL, locale);
  EXPECT_EQ(canonical(loadMesh(file)), canonical(brick()));
  std::setlocale(LC_ALL, before.c_str());
}

}  // namespace
}  // namespace taxelsim
