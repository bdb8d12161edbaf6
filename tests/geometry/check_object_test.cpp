

#include "geometry/mesh_files.h"
#include "support/test.h"

namespace taxelsim {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

TEST(CheckObject, AcceptsValuesInRange) {
  EXPECT_NO_THROW(checkObject(brick()));
  EXPECT_NO_THROW(checkObject(Sphere{1}));
  EXPECT_NO_THROW(checkObject(Cylinder{1, 2}));
  EXPECT_NO_THROW(checkObject(Capsule{1, 0}));
  EXPECT_NO_THROW(checkObject(Box{{1, 2, 3}}));
  EXPECT_NO_THROW(checkObject(HalfSpace{}));
  EXPECT_NO_THROW(checkObject(Cone{1, 2}));
  EXPECT_NO_THROW(checkObject(Torus{2, 1}));
}

TEST(CheckObject, MessageHasObjectFieldValueAndRange) {
  EXPECT_EQ(inputError([] { checkObject({"ball", Sphere{-1}}); }), "object 'ball': radius: -1 is not allowed: a number > 0 m");
  EXPECT_EQ(inputError([] {
              checkObject({"ring", Torus{1, 2}});
            }),
            "object 'ring': major_radius: 1 is not allowed: a number > minor_radius (2) m");
}

TEST(CheckObject, RejectsDimensionsOutOfRange) {
  const auto expectRejected = [](const Object& object, const char* field, double bad) {
    const std::string line = inputError([&] { checkObject(object); });
    EXPECT_NE(line.find(std::string(field) + ": "), std::string::npos) << object.name << " with " << bad << ": " << line;
  };
  for (const double bad : {0.0, -1.0, kNan, kInfinity, -kInfinity}) {
    expectRejected(Sphere{bad}, "radius", bad);
    expectRejected(Cylinder{bad, 1}, "radius", bad);
    expectRejected(Cylinder{1, bad}, "length", bad);
    expectRejected(Capsule{bad, 1}, "radius", bad);
    if (bad != 0) expectRejected(Capsule{1, bad}, "length", bad);
    expectRejected(Box{{bad, 1, 1}}, "size[0]", bad);
    expectRejected(Box{{1, bad, 1}}, "size[1]", bad);
    expectRejected(Box{{1, 1, bad}}, "size[2]", bad);
    expectRejected(Cone{bad, 1}, "radius", bad);
    expectRejected(Cone{1, bad}, "height", bad);
    expectRejected(Torus{bad, 1}, "major_radius", bad);
    expectRejected(Torus{1, bad}, "minor_radius", bad);
  }
}

TEST(CheckObject, RejectsInvalidMeshes) {
  EXPECT_NE(inputError([] { checkObject(Mesh{}); }).find("no triangle"), std::string::npos);
  Mesh mesh = brick();
  mesh.triangles[2][1] = 8;
  EXPECT_NE(inputError([&] { checkObject(mesh); }).find("triangles[2]: index 8"), std::string::npos);
  mesh = brick();
  mesh.vertices[4][2] = std::numeric_limits<float>::infinity();
  EXPECT_NE(inputError([&] { checkObject(mesh); }).find("vertices[4]: inf"), std::string::npos);
}

TEST(Object, DefaultNameIsTheKeywordOfItsShape) {
  EXPECT_EQ(Object(HalfSpace{}).name, "half_space");
  EXPECT_EQ(Object(brick()).name, "mesh");
  EXPECT_EQ(Object(Torus{2, 1}).name, "torus");
}

}  // namespace
}  // namespace taxelsim
