// The 3-D view: projection, surfaces of shapes, what is hidden and in which order, colours of taxels.
#include "figures/scene_view.h"

#include "base/vector3.h"
#include "cli/picture.h"
#include "support/curved_sensor.h"
#include "support/temporary_directory.h"

namespace taxelsim::figures {
namespace {

constexpr double kRounding = 1e-12;  // a dozen operations in double on values of order 1
constexpr double kQuarterTurn = std::numbers::pi / 2;
constexpr unsigned kDark = 0x440154, kBright = 0xfde725;  // ends of the colour scale of tactile images

TEST(Camera, ProjectsAlongTheViewersDirection) {
  const Camera front(0, 0), above(0, kQuarterTurn), right(kQuarterTurn, 0);
  const Vector3 p{2, 3, 5};
  const auto expectAt = [&](const Camera& camera, double x, double y, double near) {
    const Camera::Point point = camera(p);
    EXPECT_NEAR(point.right, x, kRounding);
    EXPECT_NEAR(point.down, y, kRounding);
    EXPECT_NEAR(point.near, near, kRounding);
  };
  expectAt(front, 3, -5, 2);
  expectAt(above, 3, 2, 5);  // as in a tactile image: x down, y to the right
  expectAt(right, -2, -5, 3);
}

// By the divergence theorem: right only if all triangles have their outside on the same side.
double volumeOf(const ObjectSurface& surface) {
  double sum = 0;
  for (const auto& [a, b, c] : surface.triangles) sum += dot(a, cross(b, c));
  return sum / 6;
}

TEST(ObjectSurface, EnclosesTheVolumeOfTheSolid) {
  const double pi = std::numbers::pi;
  const std::vector<std::pair<Shape, double>> solids{{Sphere{2}, pi * 32 / 3},    {Cylinder{2, 5}, pi * 20}, {Capsule{1, 3}, pi * 13 / 3},
                                                     {Capsule{1, 0}, pi * 4 / 3}, {Box{{1, 2, 3}}, 6},       {Cone{2, 3}, pi * 4},
                                                     {Torus{3, 1}, pi * pi * 6}};
  for (const auto& [shape, volume] : solids) {
    const ObjectSurface surface = surfaceOf(shape, 1);
    EXPECT_TRUE(surface.is_outward);
    EXPECT_GT(volumeOf(surface), 0.98 * volume) << shape.index();
    EXPECT_LE(volumeOf(surface), volume * (1 + kRounding)) << shape.index() << ": inscribed";
  }
  EXPECT_FALSE(surfaceOf(HalfSpace{}, 1).is_outward);
}

TEST(SceneFaces, HideTheBackOfASolid) {
  const Camera camera(0.3, 0.4);
  const std::vector<ViewFace> faces = facesInOrder(surfaceOf(Box{{1, 1, 1}}, 1), {}, camera, false);
  EXPECT_EQ(faces.size(), 6u) << "two triangles on each of three sides";
  for (const ViewFace& face : faces) EXPECT_GT(dot(face.normal, camera.towardsViewer()), 0);
}

// The winding of a mesh is free.
TEST(SceneFaces, HideTheBackOfAClosedMesh) {
  Mesh mesh{.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, .triangles = {{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}}};
  const Camera camera(0.8, 0.6);  // towards the face that is not along an axis
  EXPECT_EQ(facesInOrder(surfaceOf(mesh, 1), {}, camera, false).size(), 1u);
  mesh.triangles = {{1, 0, 2}, {3, 0, 1}, {2, 0, 3}, {1, 2, 3}};
  EXPECT_EQ(facesInOrder(surfaceOf(mesh, 1), {}, camera, false).size(), 1u);
  mesh.triangles.pop_back();
  EXPECT_EQ(facesInOrder(surfaceOf(mesh, 1), {}, camera, false).size(), 3u) << "the inside is visible";
}

// Far to near, whatever the order of the triangles and their winding.
TEST(SceneFaces, AreDrawnFromTheFarthest) {
  const Camera camera(0, 0);  // near is x
  ObjectSurface surface;
  for (const double x : {2.0, -1.0, 3.0, 0.0}) {
    const Vector3 b{x, 1, 0}, c{x, 0, 1};
    surface.triangles.push_back(x < 1 ? Triangle3{Vector3{x, 0, 0}, b, c} : Triangle3{Vector3{x, 0, 0}, c, b});
  }
  std::vector<double> near;
  for (const ViewFace& face : facesInOrder(surface, {{0.5, 0, 0}, {1, 0, 0, 0}}, camera, false)) {
    near.push_back(face.near);
    EXPECT_NEAR(face.normal[0], 1, kRounding) << "towards the viewer";
  }
  EXPECT_EQ(near, (std::vector<double>{-0.5, 0.5, 2.5, 3.5}));
}

TEST(SceneFaces, AreCutAtTheSkin) {
  const Camera camera(0.3, 0.4);
  for (const double height : {0.4, -0.4, -2.0, 2.0}) {
    const Pose X_SO{{0, 0, height}, {1, 0, 0, 0}};
    double lowest = 1, highest = -1;
    const std::vector<ViewFace> faces = facesInOrder(surfaceOf(Sphere{1}, 1), X_SO, camera, true);
    EXPECT_EQ(faces.empty(), height == -2.0);
    for (const ViewFace& face : faces) {
      for (std::size_t k = 0; k < face.num_corners; ++k) {
        lowest = std::min(lowest, face.corners[k][2]);
        highest = std::max(highest, face.corners[k][2]);
      }
    }
    if (std::abs(height) < 1) {
      EXPECT_EQ(lowest, 0);
      EXPECT_NEAR(highest, height + 1, kRounding);
    }
  }
}

Sensor flatSensor() {
  Sensor sensor;
  sensor.patches = {{.name = "", .num_rows = 3, .num_cols = 5, .pitch = {0.004, 0.004}, .X_SP = {}}};
  return sensor;
}

// The ball is far above the picture.
testing::Picture viewOf(const Sensor& sensor, const std::vector<double>& values) {
  const testing::TemporaryDirectory root;
  const Canvas canvas(200, 150);
  const std::vector<Pose> poses{{{0, 0, 0.001}, {1, 0, 0, 0}}};
  ColourScale scale = valueScale();
  scale.max = 7;
  const Shape ball = Sphere{0.001};
  const Pose far{{0, 0, 1}, {1, 0, 0, 0}};
  SceneView(sensor, std::span(&ball, 1), poses, 200, 150).draw(canvas, std::span(&far, 1), values, scale);
  canvas.save(root / "view.png");
  return testing::Picture(root / "view.png");
}

TEST(SceneView, ColoursTaxelsAsTheTactileImageDoes) {
  std::vector<double> values(15, 0);
  const auto expectOneBright = [&](std::size_t taxel) {
    std::vector<double> pressed = values;
    pressed[taxel] = 7;
    const testing::Picture picture = viewOf(flatSensor(), pressed);
    const testing::Picture::Spot dark = picture.of(kDark), bright = picture.of(kBright);
    EXPECT_NEAR(dark.count, 14 * bright.count, 0.1 * dark.count) << "fourteen taxels against one";
    return bright;
  };
  const auto first = expectOneBright(0), row = expectOneBright(4), column = expectOneBright(10);
  EXPECT_GT(row.x, first.x + 100) << "y points to the right";
  EXPECT_GT(column.y, first.y + 30) << "x points to the viewer";
}

TEST(SceneView, ShowsCurvedSkinFromOutside) {
  const Sensor sensor = support::cylinderFingertip(0.008, 1.2, 7, 4, 0.004);
  const std::vector<double> values(static_cast<std::size_t>(numTaxels(sensor)), 7);
  EXPECT_GT(viewOf(sensor, values).of(kBright).count, 5000);
}

}  // namespace
}  // namespace taxelsim::figures
