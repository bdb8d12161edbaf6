#include "geometry/ply_file.h"

#include "geometry/mesh_files.h"
#include "support/test.h"

namespace taxelsim {
namespace {

const std::string kSquare = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";

std::string header(const std::string& lines, const std::string& format = "ascii") {
  return "ply\nformat " + format + " 1.0\n" + lines + "end_header\n";
}

const std::string kVertices = "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n";
const std::string kFaces = "element face 1\nproperty list uchar int vertex_indices\n";

Mesh read(const std::string& bytes) {
  Mesh mesh;
  EXPECT_EQ(readPly(bytes, mesh), "");
  return mesh;
}

std::string problemOf(const std::string& bytes) {
  Mesh mesh;
  return readPly(bytes, mesh);
}

using Triangles = std::vector<std::array<std::uint32_t, 3>>;

// Readers that skip blanks take the first byte for a part of the header.
TEST(Ply, BodyMayBeginWithABlank) {
  for (const char first : {'\n', '\r', ' ', '\t', '\0'}) {
    Mesh mesh = brick();
    std::uint32_t bits = 0x3da3d700u | static_cast<unsigned char>(first);  // 0.08
    std::memcpy(&mesh.vertices[0][0], &bits, sizeof(bits));
    EXPECT_EQ(read(plyBytes(mesh)).vertices, mesh.vertices) << static_cast<int>(first);
    EXPECT_EQ(read(plyBytes(mesh)).triangles, mesh.triangles);
  }
}

TEST(Ply, BigEndianIsTheSame) {
  std::string body;
  const auto appendReversed = [&](auto value) {
    std::string raw;
    append(raw, value);
    body.append(raw.rbegin(), raw.rend());
  };
  for (const Corner& v : brick().vertices)
    for (const float coordinate : v) appendReversed(coordinate);
  for (const auto& t : brick().triangles) {
    body += '\3';
    for (const std::uint32_t index : t) appendReversed(index);
  }
  const Mesh mesh = read(plyHeader("binary_big_endian", 8, 12) + body);
  EXPECT_EQ(mesh.vertices, brick().vertices);
  EXPECT_EQ(mesh.triangles, brick().triangles);
}

TEST(Ply, SkipsOtherElementsAndProperties) {
  const Mesh mesh =
      read(header("comment made by hand\nelement material 1\nproperty list uchar float shades\nelement vertex 4\nproperty uchar "
                  "red\nproperty double x\n"
                  "property list int8 uint16 more\nproperty double y\nproperty double z\nelement face 1\nproperty float quality\n"
                  "property list uint8 uint32 vertex_index\nelement edge 1\nproperty int vertex1\n") +
           "2 0.5 0.25\n9 0 0 0 0\n9 1 1 7 0 0\n9 1 2 7 7 1 0\n9 0 0 1 0\n0.5 3 0 1 2\n3\n");
  EXPECT_EQ(mesh.vertices[2], (Corner{1, 1, 0}));
  EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 2}}));
}

TEST(Ply, StripsAlternateTheirOrientation) {
  const Mesh mesh =
      read(header(kVertices + "element tristrips 1\nproperty list int int vertex_indices\n") + kSquare + "8 0 1 3 2 -1 3 2 1\n");
  EXPECT_EQ(mesh.triangles, (Triangles{{0, 1, 3}, {3, 1, 2}, {3, 2, 1}}));
}

TEST(Ply, RefusesWhatItCannotRead) {
  const std::string good = header(kVertices + kFaces) + kSquare + "4 0 1 2 3\n";
  EXPECT_EQ(problemOf(good), "");
  EXPECT_EQ(problemOf("x" + good), "it does not begin with ply");
  EXPECT_EQ(problemOf(header(kVertices + kFaces, "ascii_2") + kSquare), "its PLY header has a bad line: format ascii_2 1.0");
  EXPECT_EQ(problemOf("ply\n" + kVertices + "end_header\n" + kSquare), "its PLY header has no format");
  EXPECT_EQ(problemOf(header("element vertex 1\nproperty float x\nproperty float y\n") + "0 0\n"),
            "its element vertex has not one x, y and z each");
  EXPECT_EQ(problemOf(header(kVertices + "element face 1\nproperty list uchar int corners\n") + kSquare + "3 0 1 2\n"),
            "its element face has no list vertex_indices");
  const auto withFace = [&](const std::string& face) { return problemOf(header(kVertices + kFaces) + kSquare + face); };
  EXPECT_EQ(withFace("3 0 1 4\n"), "a face uses vertex 4 of 4");
  EXPECT_EQ(withFace("3 0 1 -1\n"), "a face uses vertex -1 of 4");
  EXPECT_EQ(withFace("3 0 1 1.5\n"), "a face uses vertex 1.5 of 4");
  EXPECT_EQ(withFace("3 0 1 2,5\n"), "it has the value 2,5, which is not a finite number");
  EXPECT_EQ(withFace("-1 0 1 2\n"), "it has a list of -1 values");
  EXPECT_EQ(withFace("0\n"), "face 0 has no corners; 1 to 1000 are allowed");
  EXPECT_EQ(withFace("3 0 1\n"), "it ends before the last element that its header or a list claims");
  EXPECT_EQ(withFace("1e300 0 1 2\n"), "it ends before the last element that its header or a list claims");
}

}  // namespace
}  // namespace taxelsim
