#include <sys/stat.h>

#include "base/text.h"
#include "geometry/mesh_files.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using ::testing::Test;

// Loading throws an Error(kInput) with a message of one line that contains the name of the file and `words`.
void expectRejected(const std::filesystem::path& file, const std::string& words, const MeshOptions& options = {}) {
  const std::string line = inputError([&] { loadMesh(file, options); });
  EXPECT_NE(line.find(file.filename().string()), std::string::npos) << line;
  EXPECT_NE(line.find(words), std::string::npos) << line;
  EXPECT_EQ(line.find('\n'), std::string::npos) << line;
}

// "data:" URI of a buffer.
std::string dataUri(const std::string& bytes) {
  static constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text = "data:application/octet-stream;base64,";
  for (std::size_t i = 0; i + 2 < bytes.size(); i += 3) {  // a brick's buffer has a multiple of 3 bytes
    const auto byte = [&](std::size_t k) { return static_cast<unsigned>(static_cast<unsigned char>(bytes[i + k])); };
    const unsigned group = byte(0) << 16 | byte(1) << 8 | byte(2);
    for (const int shift : {18, 12, 6, 0}) text += kDigits[group >> shift & 63];
  }
  return text;
}

class InvalidMeshFile : public Test {
 protected:
  testing::TemporaryDirectory directory_;
};

TEST_F(InvalidMeshFile, RejectsMissingFilesDirectoriesEmptyFilesAndPipes) {
  expectRejected(directory_ / "none.obj", "no such file");
  std::filesystem::create_directory(directory_ / "directory.obj");
  expectRejected(directory_ / "directory.obj", "is a directory");
  expectRejected(directory_.write("empty.stl", ""), "is empty");
  ASSERT_EQ(mkfifo((directory_ / "pipe.ply").c_str(), 0600), 0);
  expectRejected(directory_ / "pipe.ply", "not a regular file");
}

TEST_F(InvalidMeshFile, RejectsUnknownExtensions) {
  expectRejected(directory_.write("brick.dae", objText(brick())), ".obj, .stl, .ply, .glb or .gltf");
}

TEST_F(InvalidMeshFile, RejectsLargeFilesWithoutOpeningThem) {
  const std::filesystem::path file = directory_.write("huge.obj", "v 0 0 0\n");
  std::filesystem::resize_file(file, kMaxMeshFileBytes + 1);  // sparse
  expectRejected(file, "at most 1073741824");
}

TEST_F(InvalidMeshFile, RejectsTextThatIsNotAMesh) {
  const std::string text = "Sing, goddess, the anger of Peleus' son Achilleus\nand its devastation.\n";
  for (const char* name : {"text.obj", "text.stl", "text.ply", "text.gltf", "text.glb"}) expectRejected(directory_.write(name, text), "");
  // The format follows from the extension alone, not from the content.
  expectRejected(directory_.write("brick.stl", objText(brick())), "");
  expectRejected(directory_.write("xml.gltf", "<?xml version=\"1.0\"?><COLLADA version=\"1.4.1\"></COLLADA>"), "no JSON at byte 1");
}

TEST_F(InvalidMeshFile, RejectsMeshesWithoutTriangles) {
  expectRejected(directory_.write("points.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n"), "no triangle");
  expectRejected(directory_.write("line.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nl 1 2\n"), "no triangle");
  expectRejected(directory_.write("flat.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"), "no triangle");
  expectRejected(directory_.write("none.ply", plyHeader("ascii", 0, 0)), "");
  expectRejected(directory_.write("none.stl", "solid x\nendsolid x\n"), "");
}

TEST_F(InvalidMeshFile, RejectsCoordinatesThatAreNotFinite) {
  for (const char* bad : {"nan", "inf", "-inf", "1e999"}) {
    expectRejected(directory_.write("bad.obj", "v 0 0 0\nv 1 0 0\nv 0 " + std::string(bad) + " 0\nf 1 2 3\n"),
                   "line 3: vertex 2 has the coordinate " + std::string(bad));
  }
  Mesh mesh = brick();
  mesh.vertices[5][1] = std::numeric_limits<float>::quiet_NaN();
  expectRejected(directory_.write("bad.ply", plyBytes(mesh)), "vertex 5");
  expectRejected(directory_.write("bad.stl", stlBytes(mesh)), "is not finite");
  expectRejected(directory_.write("good.obj", objText(brick())), "is not finite", {.scale = 1e39});
}

TEST_F(InvalidMeshFile, RejectsCoordinatesThatAreNotNumbers) {
  for (const char* bad : {"1,5", "1.5.5", "0x1", "abc", "1e40", "--1"}) {
    expectRejected(directory_.write("bad.obj", "v 0 0 0\nv 1 0 0\nv 0 " + std::string(bad) + " 0\nf 1 2 3\n"), "line 3: vertex 2");
  }
  expectRejected(directory_.write("short.obj", "v 0 0 0\nv 1 0\nv 0 1 0\nf 1 2 3\n"), "line 2: vertex 1 lacks");
  EXPECT_NO_THROW(loadMesh(directory_.write("good.obj", "v 0 0 0\r\nv +1 0 0 1.0\r\nv 0 1e-3 0\r\nf 1 2 3\r\n")));
}

TEST_F(InvalidMeshFile, RejectsDamagedTextStl) {
  const std::string text = stlText(brick());
  expectRejected(directory_.write("cut.stl", text.substr(0, text.size() / 2)), "ends before endsolid");
  const auto withFacet = [&](const std::string& vertices) {
    return directory_.write("facet.stl",
                            "solid a vertex\nfacet normal 0 0 1\nouter loop\n" + vertices + "endloop\nendfacet\nendsolid a vertex\n");
  };
  const std::string two = "vertex 0 0 0\nvertex 1 0 0\n";
  EXPECT_NO_THROW(loadMesh(withFacet(two + "vertex 0 +1 0\n")));
  expectRejected(withFacet(two), "facet 0 has 2 vertices, not 3");
  expectRejected(withFacet(two + two), "facet 0 has more than 3 vertices");
  expectRejected(withFacet(two + "vertex 0 1,5 0\n"), "vertex 2 has the coordinate 1,5, which is not a finite number");
}

TEST_F(InvalidMeshFile, RejectsOptionsOutOfRange) {
  const std::filesystem::path file = directory_.write("brick.obj", objText(brick()));
  for (const double scale : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    expectRejected(file, "scale: ", {.scale = scale});
  }
  for (const double error : {-1e-9, -1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    expectRejected(file, "max_depth_error: " + numberText(error) + " is not allowed: a number >= 0 m", {.max_depth_error = error});
  }
  expectRejected(file, "no triangle", {.scale = 1e-60});  // every vertex rounds to the origin
}

TEST_F(InvalidMeshFile, RejectsIndicesOutOfRange) {
  const std::string vertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  for (const char* face : {"f 1 2 4\n", "f 1 2 4000000000\n", "f 1 2 99999999999999999999\n", "f 1 2 -7\n"}) {
    expectRejected(directory_.write("index.obj", vertices + face), "");
  }
  Mesh mesh = brick();
  mesh.triangles[3][1] = 4000000000u;
  expectRejected(directory_.write("index.ply", plyBytes(mesh)), "");
  expectRejected(directory_.write("index.glb", glbBytes(mesh, R"([{"mesh":0}])")),
                 "meshes[0].primitives[0]: index 4000000000 is not allowed: it has 8 vertices");
}

TEST_F(InvalidMeshFile, RejectsStlWithTooManyTrianglesInItsHeader) {
  std::string bytes = stlBytes(brick());
  bytes.replace(80, 4, "\xff\xff\xff\xff");
  expectRejected(directory_.write("claims.stl", bytes), "claims 4294967295 triangles");
  bytes.replace(0, 5, "solid");
  expectRejected(directory_.write("claims.stl", bytes), "");

  // A count whose size in bytes overflows 32 bits to the actual 684: 50 x 2147483660 = 600 mod 2^32.
  bytes = stlBytes(brick());
  bytes.replace(80, 4, std::string("\x0c\x00\x00\x80", 4));
  expectRejected(directory_.write("wraps.stl", bytes), "claims 2147483660 triangles");
  bytes.replace(0, 5, "solid");
  expectRejected(directory_.write("wraps.stl", bytes), "claims 2147483660 triangles");
}

TEST_F(InvalidMeshFile, RejectsPlyThatIsShorterThanItsHeaderClaims) {
  expectRejected(directory_.write("claims.ply", plyHeader("ascii", 4000000000u, 1) + "0 0 0\n"), "4000000000 x vertex");
  expectRejected(directory_.write("claims.ply", plyHeader("binary_little_endian", 3, 4000000000u)), "4000000000 x face");
  // A list with a length of 2^32 - 1.
  for (const char* format : {"binary_little_endian", "ascii"}) {
    std::string bytes = plyHeader(format, 3, 1);
    bytes.replace(bytes.find("uchar"), 5, "uint");
    if (format[0] == 'a') {
      bytes += "0 0 0\n1 0 0\n0 1 0\n4294967295 0 1 2\n";
    } else {
      bytes.append(36, '\0').append(4, '\xff').append(12, '\0');
    }
    expectRejected(directory_.write("list.ply", bytes), "ends before");
  }
}

TEST_F(InvalidMeshFile, RejectsGltfThatIsShorterThanItClaims) {
  directory_.write("brick.bin", gltfBuffer(brick()));
  const std::string nodes = R"([{"mesh":0}])";
  for (const char* count : {"4000000000", "40000000", "-3", "1e30"}) {
    expectRejected(directory_.write("claims.gltf", gltfJson(brick(), "brick.bin", nodes, count)), "");
  }
  expectRejected(directory_.write("device.gltf", gltfJson(brick(), "/dev/zero", nodes)), "no such file");
  expectRejected(directory_.write("absent.gltf", gltfJson(brick(), "absent.bin", nodes)), "no such file");
  std::filesystem::create_symlink("/dev/zero", directory_ / "link.bin");
  expectRejected(directory_.write("link.gltf", gltfJson(brick(), "link.bin", nodes)), "not a regular file");
  ASSERT_EQ(mkfifo((directory_ / "pipe.bin").c_str(), 0600), 0);
  expectRejected(directory_.write("pipe.gltf", gltfJson(brick(), "pipe.bin", nodes)), "buffers[0].uri: \"pipe.bin\": not a regular file");
}

// A scene stores the SHA-256 of the .glb alone.
TEST_F(InvalidMeshFile, RejectsGlbWithGeometryInOtherFiles) {
  directory_.write("brick.bin", gltfBuffer(brick()));
  const std::string nodes = R"([{"mesh":0}])";
  expectRejected(directory_.write("outside.glb", glbBytes(brick(), nodes, "brick.bin")),
                 "buffers[0] is in another file (\"brick.bin\"), which its SHA-256 does not cover");
  EXPECT_NO_THROW(loadMesh(directory_.write("inside.glb", glbBytes(brick(), nodes, dataUri(gltfBuffer(brick()))))));
}

TEST_F(InvalidMeshFile, RejectsGltfWithoutItsBuffers) {
  directory_.write("brick.bin", gltfBuffer(brick()));
  const std::string whole = gltfJson(brick(), "brick.bin", R"([{"mesh":0}])");
  for (const auto& [from, to, words] :
       {std::array{"\"buffers\"", "\"others\"", "bufferViews[0].buffer: 0 is not allowed: an index of buffers, which has 0 entries"},
        {"\"bufferView\":", "\"others\":", "accessors[0].bufferView is missing"},
        {"\"buffer\":0", "\"buffer\":9", "bufferViews[0].buffer: 9 is not allowed: an index of buffers, which has 1 entry"}}) {
    std::string text = whole;
    ASSERT_NE(text.find(from), std::string::npos) << from << text;
    text.replace(text.find(from), std::string(from).size(), to);
    expectRejected(directory_.write("brick.gltf", text), words);
  }
}

TEST_F(InvalidMeshFile, RejectsFacesWithoutCorners) {
  const std::string vertices = "0 0 0\n1 0 0\n0 1 0\n";
  expectRejected(directory_.write("face.ply", plyHeader("ascii", 3, 2) + vertices + "3 0 1 2\n0\n"), "face 1 has no corners");
  std::string bytes = plyBytes(brick());
  bytes.replace(bytes.find("face 12"), 7, "face 13");
  expectRejected(directory_.write("face.ply", bytes + '\0'), "face 12 has no corners");
  EXPECT_EQ(loadMesh(directory_.write("face.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf\n")).triangles.size(), 1u);
  expectRejected(directory_.write("face.stl", "solid x\nfacet normal 0 0 1\nouter loop\nendloop\nendfacet\nendsolid x\n"), "");
}

TEST_F(InvalidMeshFile, RejectsGltfThatNestsTooDeep) {
  directory_.write("brick.bin", gltfBuffer(brick()));
  expectRejected(directory_.write("deep.gltf", std::string(1000000, '[')), "nests deeper");
  expectRejected(directory_.write("cycle.gltf", gltfJson(brick(), "brick.bin", R"([{"children":[1]},{"children":[0],"mesh":0}])")),
                 "not a tree");
  std::string nodes = "[";
  for (int i = 1; i < 100000; ++i) nodes += R"({"children":[)" + std::to_string(i) + "]},";
  const std::filesystem::path chain = directory_.write("chain.gltf", gltfJson(brick(), "brick.bin", nodes + R"({"mesh":0}])"));
  EXPECT_EQ(canonical(loadMesh(chain)), canonical(brick())) << "nodes are not nested in the JSON";
}

TEST_F(InvalidMeshFile, RejectsPolygonsWithTooManyCorners) {
  std::string text;
  std::string face = "f";
  for (int i = 1; i <= 100000; ++i) {
    text += "v " + std::to_string(i) + " " + std::to_string(i % 7) + " 0\n";
    face.append(" ").append(std::to_string(i));
  }
  expectRejected(directory_.write("polygon.obj", text + face + "\n"), "corners");
}

TEST_F(InvalidMeshFile, MessageIsOneLineForAnyFileName) {
  EXPECT_EQ(inputError([&] { loadMesh(directory_ / "two\nlines.obj"); }).find('\n'), std::string::npos);
}

// Fuzz test: a truncated file, or one with changed bytes, is loaded or rejected. The oracle is that the process neither crashes nor hangs,
// and the sanitizers in builds that have them.
TEST_F(InvalidMeshFile, DamagedFilesAreLoadedOrRejected) {
  directory_.write("brick.bin", gltfBuffer(brick()));
  const std::vector<std::pair<std::string, std::string>> whole{{"damaged.obj", objText(brick())},
                                                               {"text.stl", stlText(brick())},
                                                               {"binary.stl", stlBytes(brick())},
                                                               {"text.ply", plyText(brick())},
                                                               {"binary.ply", plyBytes(brick())},
                                                               {"damaged.gltf", gltfJson(brick(), "brick.bin", R"([{"mesh":0}])")},
                                                               {"damaged.glb", glbBytes(brick(), R"([{"mesh":0}])")}};
  EXPECT_TRUE(rc::check([&] {
    auto [name, bytes] = *rc::gen::elementOf(whole);
    bytes.resize(*rc::gen::inRange<std::size_t>(1, bytes.size() + 1));
    const int num_changes = *rc::gen::inRange(0, 4);
    for (int i = 0; i < num_changes; ++i) bytes[*rc::gen::inRange<std::size_t>(0, bytes.size())] = *rc::gen::arbitrary<char>();
    const std::filesystem::path file = directory_.write(name, bytes);
    const std::string line = inputError([&] { checkObject(loadMesh(file)); });
    RC_ASSERT(line.find("wrong kind") == std::string::npos);
    RC_ASSERT(line.find('\n') == std::string::npos);
  }));
}

}  // namespace
}  // namespace taxelsim
