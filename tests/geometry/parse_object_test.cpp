
#include "geometry/mesh_files.h"
#include "support/test.h"

namespace taxelsim {
namespace {

TEST(ParseObject, ReadsAllSolids) {
  EXPECT_EQ(std::get<Sphere>(parseObject("sphere:0.005").shape).radius, 0.005);
  EXPECT_EQ(std::get<Cylinder>(parseObject("cylinder:8e-3,0.04").shape).radius, 0.008);
  EXPECT_EQ(std::get<Cylinder>(parseObject("cylinder:8e-3,0.04").shape).length, 0.04);
  EXPECT_EQ(std::get<Capsule>(parseObject("capsule:0.01,0").shape).length, 0);
  EXPECT_EQ(std::get<Box>(parseObject("box:0.01,0.02,0.03").shape).size, (Vector3{0.01, 0.02, 0.03}));
  EXPECT_TRUE(std::holds_alternative<HalfSpace>(parseObject("half_space").shape));
  EXPECT_EQ(std::get<Cone>(parseObject("cone:0.01,0.02").shape).height, 0.02);
  EXPECT_EQ(std::get<Torus>(parseObject("torus:0.02,0.005").shape).minor_radius, 0.005);
  EXPECT_EQ(parseObject("sphere:0.005").name, "sphere:0.005");
}

TEST(ParseObject, ReadsAMeshFileAndUsesItsStemAsName) {
  const testing::TemporaryDirectory directory;
  const Object object = parseObject(directory.write("brick.obj", objText(brick())).string());
  EXPECT_EQ(object.name, "brick");
  EXPECT_EQ(canonical(std::get<Mesh>(object.shape)), canonical(brick()));
}

TEST(ParseObject, RejectsOtherTextWithOneLineThatListsTheSyntax) {
  for (const char* text :
       {"",          "ball:1",      "sphere",      "sphere:",      "sphere:1,2", "sphere:abc",   "sphere:1x",        "sphere: 1",
        "sphere:+1", "sphere:0x10", "sphere:1,",   "sphere:nan",   "sphere:inf", "sphere:1e999", "cylinder:1",       "cylinder:1,2,3",
        "box:1,2",   "box:1,,2",    "half_space:", "half_space:1", "cone:1",     "torus:1",      "no_such_file.obj", "two\nlines"}) {
    const std::string line = inputError([&] { parseObject(text); });
    EXPECT_NE(line.find("allowed: sphere:R"), std::string::npos) << text << " -> " << line;
    EXPECT_EQ(line.find('\n'), std::string::npos);
  }
  for (const char* text : {"sphere:0", "sphere:-1", "cylinder:1,0", "capsule:1,-1", "box:1,2,-3", "cone:0,1", "torus:1,1", "torus:1,2"}) {
    const std::string line = inputError([&] { parseObject(text); });
    EXPECT_NE(line.find("is not allowed: a number >"), std::string::npos) << text << " -> " << line;
  }
  EXPECT_NE(inputError([] { parseObject(std::string_view("a\0b", 3)); }), "");
}

}  // namespace
}  // namespace taxelsim
