// glTF: what is read and what is refused, by changes of the JSON of a brick. Whole files in all formats: mesh_loading_test.cpp.
#include "geometry/gltf_file.h"

#include "geometry/mesh_files.h"
#include "support/test.h"

namespace taxelsim {
namespace {

constexpr const char* kRoot = R"([{"mesh":0}])";

std::string withChange(std::string text, const std::string& from, const std::string& to) {
  EXPECT_NE(text.find(from), std::string::npos) << from << " in " << text;
  return text.replace(text.find(from), from.size(), to);
}

class Gltf : public ::testing::Test {
 protected:
  Gltf() { directory_.write("brick.bin", gltfBuffer(brick())); }

  std::string read(const std::string& json, Mesh& mesh) const {
    const auto place = [](const std::array<double, 3>& p, std::size_t) {
      return Corner{static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])};
    };
    return readGltf(directory_.write("brick.gltf", json), false, place, mesh);
  }

  std::string problemOf(const std::string& json) const {
    Mesh mesh;
    return read(json, mesh);
  }

  Mesh meshOf(const std::string& json) const {
    Mesh mesh;
    EXPECT_EQ(read(json, mesh), "");
    return mesh;
  }

  // The brick with the first `from` of its JSON replaced.
  std::string changed(const std::string& from, const std::string& to) const {
    return withChange(gltfJson(brick(), "brick.bin", kRoot), from, to);
  }

  testing::TemporaryDirectory directory_;
};

struct Change {
  const char *from, *to, *problem;
};

TEST_F(Gltf, RefusesWhatItDoesNotReadByName) {
  for (const auto& [from, to, problem] : {
           Change{R"("asset":{"version":"2.0"})", R"("asset":{"version":"1.0"})", R"(asset.version: "1.0" is not allowed: 2.0)"},
           {R"("asset")", R"("assets")", "asset is missing: an object"},
           {R"("scene":0)", R"("scene":0,"extensionsRequired":["KHR_draco_mesh_compression"])",
            "it requires the extension KHR_draco_mesh_compression, which is not read: save the mesh without it"},
           {R"("scene":0)", R"("scene":1)", "scene: 1 is not allowed: an index of scenes, which has 1 entry"},
           {R"("scenes":)", R"("scenes":[{"nodes":[]}],"scenes":)", R"(its JSON has the key "scenes" twice in one object)"},
           {R"("nodes":[0])", R"("nodes":[0,0])", "its nodes are not a tree: two lists name node 0"},
           {R"("nodes":[0])", R"("nodes":[-1])", "scenes[0].nodes[0]: -1 is not allowed: an index of nodes, which has 1 entry"},
           {R"({"mesh":0})", R"({"mesh":0,"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,2]})",
            "nodes[0].matrix: a list is not allowed: the last row"},
           {R"({"mesh":0})", R"({"mesh":0,"rotation":[0,0,0,2]})", "nodes[0].rotation: a list is not allowed: a quaternion of length 1"},
           {R"({"mesh":0})", R"({"mesh":0,"scale":[1,1]})", "nodes[0].scale: a list is not allowed: a list of 3 numbers"},
           {R"({"mesh":0})", R"({"mesh":0,"weights":[0,0.5]})", "nodes[0].weights: a list is not allowed: zeros: apply the morph targets"},
           {R"({"mesh":0})", R"({"mesh":0,"extensions":{"EXT_mesh_gpu_instancing":{}}})",
            "nodes[0].extensions.EXT_mesh_gpu_instancing: an object is not allowed: a node for each instance"},
           {R"("indices":1)", R"("indices":1,"mode":7)", "meshes[0].primitives[0].mode: 7 is not allowed: a whole number up to 6"},
           {R"("POSITION":0)", R"("POSITION":0,"JOINTS_0":1)",
            "accessors[1].count: 36 is not allowed: 8, the count of meshes[0].primitives[0].attributes.POSITION"},
           {R"("POSITION":0)", R"("NORMAL":0)", "meshes[0].primitives[0].attributes.POSITION is missing: an index of accessors"},
           {R"("count":8)", R"("count":9)",
            "accessors[0].count: 9 is not allowed: its last element ends at byte 108 of a bufferView of 96 bytes"},
           {R"("count":8)", R"("count":0)", "accessors[0].count: 0 is not allowed: a whole number >= 1"},
           {R"("count":8)", R"("count":8,"byteOffset":1)", "accessors[0].count: 8 is not allowed: its last element ends at byte 97"},
           {R"("count":8)", R"("count":8,"byteOffset":18446744073709551615)",
            "accessors[0].byteOffset: 18446744073709551615 is not allowed"},
           {R"("count":8)", R"("count":8,"sparse":{"count":1})", "accessors[0].sparse: an object is not allowed"},
           {"5126", "5124", "accessors[0].componentType: 5124 is not allowed: 5120 to 5123, 5125 or 5126"},
           {"5126", "5122", "accessors[0].componentType: 5122 is not allowed: 5126 for POSITION, others if extensionsRequired has"},
           {R"("VEC3")", R"("VEC2")", R"(accessors[0].type: "VEC2" is not allowed: VEC3 for POSITION)"},
           {"5125", "5124", "accessors[1].componentType: 5124 is not allowed"},
           {"5125", "5120", "accessors[1].componentType: 5120 is not allowed: 5121, 5123 or 5125 for indices"},
           {R"("count":36)", R"("count":35)", "accessors[1].count: 35 is not allowed: a multiple of 3 for triangles"},
           {R"("byteOffset":0)", R"("byteOffset":241)", "bufferViews[0].byteOffset: 241 is not allowed: a whole number up to 240"},
           {R"("byteLength":96)", R"("byteLength":96,"byteStride":8)", "bufferViews[0].byteStride: 8 is not allowed: at least 12 bytes"},
           {R"("byteLength":240)", R"("byteLength":241)",
            "buffers[0].byteLength: 241 is not allowed: at most 240 bytes, which the buffer has"},
           {R"("uri":"brick.bin")", R"("uri":"data:,brick")", R"(buffers[0].uri: "data:,brick" is not allowed: data in base 64)"},
           {R"("uri":"brick.bin")", R"("uri":"data:;base64,A-")", R"(buffers[0].uri: "data:;base64,A-" is not allowed: data in base 64)"},
           {R"(,"uri":"brick.bin")", "", "buffers[0].uri is missing"},
           {R"({"nodes":[0]})", "1e999", "its JSON has a number that is too large, before byte"},
       }) {
    const std::string found = problemOf(changed(from, to));
    EXPECT_TRUE(found.starts_with(problem)) << found << "\ninstead of\n" << problem;
  }
}

TEST_F(Gltf, ReadsWhatOnlyAppearanceNeeds) {
  for (const auto& [from, to] : {std::pair{R"("scene":0)", R"("extensionsRequired":["KHR_texture_transform","KHR_materials_unlit"])"},
                                 {R"({"mesh":0})", R"({"mesh":0,"skin":7,"weights":[0,0]})"},
                                 {R"("indices":1)", R"("indices":1,"material":7)"},
                                 {R"("uri":"brick.bin")", R"("uri":"%62rick.bin")"}}) {
    EXPECT_EQ(canonical(meshOf(changed(from, to))), canonical(brick())) << to;
  }
}

// Corners of a square in turn as a strip, in a circle as a fan. Both have the same two triangles up to the diagonal.
TEST_F(Gltf, ReadsStripsAndFansWithOneOrientation) {
  const auto ofMode = [&](const std::string& mode, const std::vector<Corner>& corners) {
    Mesh mesh;
    mesh.vertices = corners;
    directory_.write("brick.bin", gltfBuffer(mesh));
    return meshOf(withChange(gltfJson(mesh, "brick.bin", kRoot), R"("indices":1)", R"("mode":)" + mode));
  };
  using Triangles = std::vector<std::array<std::uint32_t, 3>>;
  EXPECT_EQ(ofMode("5", {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 2, 0}}).triangles, (Triangles{{0, 1, 2}, {2, 1, 3}, {2, 3, 4}}));
  EXPECT_EQ(ofMode("6", {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}).triangles, (Triangles{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_TRUE(ofMode("5", {{0, 0, 0}, {1, 0, 0}}).triangles.empty());
  EXPECT_TRUE(ofMode("3", {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}}).triangles.empty()) << "a strip of lines";
}

// KHR_mesh_quantization: a coordinate c of a normalized accessor is max(c / largest, -1).
TEST_F(Gltf, ReadsQuantizedPositions) {
  const auto quantized = [&](const std::string& type, const std::string& flag, const std::string& buffer) {
    directory_.write("q.bin", buffer);
    return meshOf(R"({"asset":{"version":"2.0"},"extensionsRequired":["KHR_mesh_quantization"],"scenes":[{"nodes":[0]}],)"
                  R"("nodes":[{"mesh":0,"scale":[2,2,2]}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],)"
                  R"("buffers":[{"byteLength":)" +
                  std::to_string(buffer.size()) + R"(,"uri":"q.bin"}],"bufferViews":[{"buffer":0,"byteLength":)" +
                  std::to_string(buffer.size()) +
                  R"(,"byteStride":8}],"accessors":[{"bufferView":0,"count":3,"type":"VEC3","componentType":)" + type + flag + "}]}")
        .vertices;
  };
  const auto bytesOf = [](auto... numbers) {
    std::string bytes;
    (append(bytes, numbers), ...);
    return bytes;
  };
  using Vertices = std::vector<Corner>;
  const std::string shorts = bytesOf(std::int16_t{-32768}, std::int16_t{32767}, std::int16_t{0}, std::int16_t{9}, std::int16_t{1},
                                     std::int16_t{2}, std::int16_t{3}, std::int16_t{9}, std::int16_t{0}, std::int16_t{0}, std::int16_t{0});
  EXPECT_EQ(quantized("5122", R"(,"normalized":true)", shorts)[0], (Corner{-2, 2, 0}));
  EXPECT_EQ(quantized("5122", "", shorts), (Vertices{{-65536, 65534, 0}, {2, 4, 6}, {0, 0, 0}}));
  const std::string bytes("\xff\x80\x00.....\x01\x02\x03.....\x00\x00\x00", 19);
  EXPECT_EQ(quantized("5121", "", bytes), (Vertices{{510, 256, 0}, {2, 4, 6}, {0, 0, 0}}));
  EXPECT_EQ(quantized("5120", "", bytes), (Vertices{{-2, -256, 0}, {2, 4, 6}, {0, 0, 0}}));
  EXPECT_EQ(quantized("5121", R"(,"normalized":true)", bytes)[0], (Corner{2, static_cast<float>(2 * (128 / 255.0)), 0}));
}

// 17 nodes that share a mesh of 2^20 vertices.
TEST_F(Gltf, LimitsTheVerticesOfNodesThatShareAMesh) {
  Mesh mesh;
  mesh.vertices.resize(std::size_t{1} << 20);
  mesh.triangles = {{0, 1, 2}};
  directory_.write("brick.bin", gltfBuffer(mesh));
  std::string nodes = R"([{"children":[1)", list = "{\"mesh\":0}";
  for (int i = 2; i <= 17; ++i) {
    nodes += "," + std::to_string(i);
    list += ",{\"mesh\":0}";
  }
  EXPECT_EQ(problemOf(gltfJson(mesh, "brick.bin", nodes + "]}," + list + "]")),
            "its nodes have more than 16777216 vertices or 16777216 triangles in all");
}

TEST_F(Gltf, LimitsTheValuesOfTheJson) {
  EXPECT_EQ(problemOf("[" + std::string(std::size_t{1} << 24, ' ') + "]"), "it is not glTF: no JSON object");
  std::string zeros = "[0";
  for (int i = 0; i < 1 << 23; ++i) zeros += ",0";
  EXPECT_EQ(problemOf(zeros + "]"), "its JSON has more than 8388608 values");
}

TEST_F(Gltf, RefusesDamagedContainers) {
  const std::string whole = glbBytes(brick(), kRoot);
  const auto problemOfGlb = [&](const std::string& bytes) {
    Mesh mesh;
    return readGltf(
        directory_.write("brick.glb", bytes), true, [](const auto&, std::size_t) { return Corner{}; }, mesh);
  };
  EXPECT_EQ(problemOfGlb(whole), "");
  EXPECT_EQ(problemOfGlb("glTF"), "it is not binary glTF");
  EXPECT_EQ(problemOfGlb(whole.substr(0, whole.size() - 1)),
            "its header claims " + std::to_string(whole.size()) + " bytes, but it has " + std::to_string(whole.size() - 1));
  EXPECT_EQ(problemOfGlb(withChange(whole, std::string("glTF\2", 5), std::string("glTF\1", 5))),
            "it is binary glTF of version 1; 2 is allowed");
  EXPECT_EQ(problemOfGlb(withChange(whole, "JSON", "JSOM")), "its first chunk is not JSON");
  EXPECT_EQ(problemOfGlb(withChange(whole, std::string("\0JSON", 5), std::string("\x7fJSON", 5))), "its chunk 0 is longer than the file");
  EXPECT_EQ(problemOfGlb(withChange(whole, std::string("BIN\0", 4), "BINS")),
            "buffers[0].byteLength: 240 is not allowed: at most 0 bytes, which the buffer has");
}

}  // namespace
}  // namespace taxelsim
