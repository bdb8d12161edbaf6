// OBJ text: what is read, skipped and refused. Whole files in all formats: mesh_loading_test.cpp.
#include "geometry/obj_file.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

const std::string kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

Mesh meshOf(const std::string& text) {
  Mesh mesh;
  EXPECT_EQ(readObj(text, mesh), "");
  return mesh;
}

std::string problemOf(const std::string& text) {
  Mesh mesh;
  return readObj(text, mesh);
}

TEST(Obj, CornersHaveFourForms) {
  for (const char* face : {"f 1 2 3 4", "f 1/1 2/2 3/3 4/4", "f 1//9 2//9 3//9 4//9", "f 1/1/1 2/2/2 3/3/3 4/4/4", "f -4 -3 -2 -1"})
    EXPECT_EQ(meshOf(kSquare + face).triangles, (Triangles{{0, 1, 2}, {0, 2, 3}})) << face;
}

TEST(Obj, VerticesMayFollowTheirFaces) {
  EXPECT_EQ(meshOf("f 1 2 4\n" + kSquare).triangles, (Triangles{{0, 1, 3}}));
  EXPECT_EQ(problemOf("f 1 2 4\nv 0 0 0\n"), "line 1: a face uses vertex 2 of 1");
  EXPECT_EQ(problemOf(kSquare + "f 1 2 5\n"), "line 5: a face uses vertex 5 of 4");
}

TEST(Obj, StatementsContinueAfterABackslash) {
  EXPECT_EQ(meshOf("v 0 \\\r\n 0 \\\n0\nv 1 0 0\nv 0 1 0\nf 1 \\\n 2 3").triangles, (Triangles{{0, 1, 2}}));
  EXPECT_EQ(meshOf("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\\").triangles, (Triangles{{0, 1, 2}})) << "at the end of the file";
  EXPECT_NE(problemOf("v 1\\5 0 0\n"), "");
}

TEST(Obj, ColoursAndAWeightOfOneAreSkipped) {
  EXPECT_EQ(meshOf("v 1 2 3 1.0\nv 1 2 3 0.5 0.5 0.5\n").vertices.size(), 2u);
  EXPECT_EQ(problemOf("v 1 2 3 0.5\n"), "line 1: vertex 0 has the weight 0.5; only 1 is allowed");
}

// Rounded once, 16.526 would be 0x1.086a7ep+4.
TEST(Obj, CoordinatesHaveTheBitsOfEarlierVersions) {
  const Mesh mesh = meshOf("v 16.526 -16.526 +16.526\nv 1.6526e1 -0.75E-2 3e+2\n");
  EXPECT_EQ(mesh.vertices[0], (std::array{0x1.086a8p+4f, -0x1.086a8p+4f, 0x1.086a8p+4f}));
  EXPECT_EQ(mesh.vertices[1], (std::array{0x1.086a8p+4f, -0.0075f, 300.0f}));
}

TEST(Obj, OtherStatementsAreSkipped) {
  const std::string others = "# v\no a\ng b c\ns 1\nmtllib x\nusemtl y\nvn 0 0 1\nvt 0 0\nvp 0\nl 1 2\np 1\ncurv 0 1 1 2\n\n  \t\n";
  EXPECT_EQ(meshOf(others + kSquare + others + "\tf  1 2 3\r\n" + others + "f 1\nf 1 2\nf\n").triangles, (Triangles{{0, 1, 2}}));
}

TEST(Obj, RefusesWhatIsNoVertex) {
  for (const char* corner : {"0", "5x", "x", "1/x", "1.5", "-9", "+1", "4294967296", "99999999999999999999", "\xfd\xff"})
    EXPECT_NE(problemOf(kSquare + "f 1 2 " + corner).find("line 5: a face has the corner "), std::string::npos) << corner;
}

}  // namespace
}  // namespace taxelsim
