// Sensors given as a list of taxels, a mesh or a URDF: positions in closed form, canonical texts, and the message of each error.
#include "scene_text.h"
#include "support/test.h"
#include "taxelsim/scene.h"
#include "taxelsim/sensor.h"

namespace taxelsim {
namespace {

constexpr double kRounding = 1e-14;
constexpr const char* kRest = "skin: {thickness: 0.002, normal_contact_stiffness: 1.73e8}\nreadout: {curve: {counts_per_newton: 2400}}\n";

// Two taxels of 2 mm, side by side along x, in millimetres.
constexpr std::string_view kTaxelMesh = "v 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nv 4 0 0\nv 4 2 0\nf 1 2 3 4\nf 2 5 6 3\n";

constexpr std::string_view kUrdf = R"(<?xml version="1.0"?>
<robot name="hand">
  <link name="palm"/>
  <sensor name="camera"><parent link="palm"/><camera/></sensor>
  <sensor name="grid" update_rate="100">
    <parent link="palm"/>
    <origin xyz="0 0 0.034" rpy="0 0 0"/>
    <tactile channel="c"><array rows="2" cols="3" order="row-major" size="0.002 0.003"/></tactile>
  </sensor>
  <sensor name="gaps">
    <tactile><array rows="2" cols="3" order="row-major" size="0.002 0.003" spacing="0.004 0.005" offset="0.001 0.002"/></tactile>
  </sensor>
  <sensor name="columns">
    <tactile channel="c"><array rows="2" cols="3" order="col-major" size="0.002 0.003"/></tactile>
  </sensor>
  <sensor name="flipped">
    <tactile channel="c"><array rows="2" cols="3" size="0.002 0.003" spacing="-0.002 0.003"/></tactile>
  </sensor>
  <sensor name="list">
    <tactile channel="c">
      <taxel idx="1" xyz="0.01 0.02 0.03" rpy="0 1.5707963267948966 0"><geometry><box size="0.004 0.005 0.001"/></geometry></taxel>
      <taxel idx="0"><geometry><cylinder radius="0.002" length="0.001"/></geometry></taxel>
      <taxel idx="2" xyz="1 0 0"><geometry><sphere radius="0.001"/></geometry></taxel>
    </tactile>
  </sensor>
</robot>
)";

Sensor load(const std::string& text) {
  const testing::TemporaryDirectory directory;
  directory.write("taxels.obj", kTaxelMesh);
  directory.write("hand.urdf", kUrdf);
  return loadSensor(directory.write("sensor.yaml", "format_version: 1\nname: x\n" + text + kRest));
}

std::string refusalOf(const std::string& text, std::string_view urdf = kUrdf, std::string_view mesh = kTaxelMesh) {
  const testing::TemporaryDirectory directory;
  directory.write("taxels.obj", mesh);
  directory.write("hand.urdf", urdf);
  const std::filesystem::path file = directory.write("sensor.yaml", "format_version: 1\nname: x\n" + text + kRest);
  std::string message = refusal(file, [&] { loadSensor(file); });
  const std::string prefix = directory.path().string() + "/";
  for (std::size_t at = message.find(prefix); at != std::string::npos; at = message.find(prefix)) message.erase(at, prefix.size());
  return message;
}

void expectTaxel(const GridPatch& patch, const Vector3& position, const std::array<double, 2>& size) {
  EXPECT_EQ(patch.num_rows, 1);
  EXPECT_EQ(patch.num_cols, 1);
  for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(patch.X_SP.position[axis], position[axis], kRounding);
  for (int axis = 0; axis < 2; ++axis) EXPECT_NEAR(patch.pitch[axis], size[axis], kRounding);
}

TEST(TaxelList, ReadsEverySetting) {
  const Sensor sensor = load(R"(taxels:
  - {position_mm: [1, 2, 3], normal: [0, 0, 4], size_mm: 2}
  - {position: [0.01, 0, 0], normal: [1, 0, 0], size: [0.002, 0.003], x_axis: [1, 1, 0]}
psf: {skin_gaussian: {sigma_mm: 1.5, reach_mm: 4}, normalization: none}
)");
  ASSERT_EQ(sensor.patches.size(), 2u);
  expectTaxel(sensor.patches[0], {0.001, 0.002, 0.003}, {0.002, 0.002});
  EXPECT_EQ(sensor.patches[0].X_SP.rotation, (Quaternion{1, 0, 0, 0}));
  expectTaxel(sensor.patches[1], {0.01, 0, 0}, {0.002, 0.003});
  EXPECT_NEAR(rotate(sensor.patches[1].X_SP.rotation, {0, 0, 1})[0], 1, kRounding);
  EXPECT_NEAR(rotate(sensor.patches[1].X_SP.rotation, {1, 0, 0})[1], 1, kRounding);
  EXPECT_EQ(sensor.psf.sigma, 0.0015);
  EXPECT_EQ(sensor.psf.reach, 0.004);
  EXPECT_EQ(sensor.psf.normalization, Psf::Normalization::kNone);
}

TEST(TaxelList, ReachIsThreeSigmaByDefault) {
  const Sensor sensor = load("taxels: [{position: [0, 0, 0], normal: [0, 0, 1], size: 0.001}]\npsf: {skin_gaussian: {sigma: 0.5}}\n");
  EXPECT_EQ(sensor.psf.reach, 1.5);
}

TEST(TaxelList, Has1To4096Taxels) {
  const auto list = [](int count) {
    std::string text = "taxels:\n";
    for (int t = 0; t < count; ++t) text += "  - {position_mm: [" + std::to_string(t) + ", 0, 0], normal: [0, 0, 1], size_mm: 1}\n";
    return text;
  };
  EXPECT_EQ(numTaxels(load(list(1))), 1);
  EXPECT_EQ(numTaxels(load(list(4096))), 4096);
  EXPECT_THAT(refusalOf(list(4097)), ::testing::StartsWith(":4:3: taxels: a list of 4097 is not allowed: at most 4096 taxels"));
}

TEST(TaxelMeshFile, AppliesScale) {
  const Sensor sensor = load("taxel_mesh: {file: taxels.obj, scale: 0.001}\n");
  ASSERT_EQ(sensor.patches.size(), 2u);
  constexpr double kFloat = 2e-10;  // vertices are float32, up to 4 mm
  EXPECT_NEAR(sensor.patches[0].X_SP.position[0], 0.001, kFloat);
  EXPECT_NEAR(sensor.patches[1].X_SP.position[0], 0.003, kFloat);
  EXPECT_NEAR(sensor.patches[1].pitch[0], 0.002, kFloat);
}

// Positions by hand: (i spacing_x - offset_x, j spacing_y - offset_y).
TEST(Urdf, ReadsRowMajorArrayWithoutGapsAsGrid) {
  const Sensor sensor = load("urdf: {file: hand.urdf, sensor: grid}\n");
  ASSERT_EQ(sensor.patches.size(), 1u);
  EXPECT_EQ(sensor.patches[0].num_rows, 2);
  EXPECT_EQ(sensor.patches[0].num_cols, 3);
  EXPECT_EQ(sensor.patches[0].pitch, (std::array<double, 2>{0.002, 0.003}));
  const std::vector<Vector3> p = taxelPositions(sensor);
  for (int t = 0; t < 6; ++t) {
    EXPECT_NEAR(p[t][0], t / 3 * 0.002, kRounding);
    EXPECT_NEAR(p[t][1], t % 3 * 0.003, kRounding);
    EXPECT_EQ(p[t][2], 0);
  }
}

TEST(Urdf, SpacingAndOffset) {
  const Sensor sensor = load("urdf: {file: hand.urdf, sensor: gaps}\n");
  ASSERT_EQ(sensor.patches.size(), 6u);
  for (int t = 0; t < 6; ++t) expectTaxel(sensor.patches[t], {t / 3 * 0.004 - 0.001, t % 3 * 0.005 - 0.002, 0}, {0.002, 0.003});
}

TEST(Urdf, ReadsColumnMajorArrays) {
  const Sensor sensor = load("urdf: {file: hand.urdf, sensor: columns}\n");
  ASSERT_EQ(sensor.patches.size(), 6u);
  EXPECT_EQ(refusalOf("urdf: {file: hand.urdf, sensor: columns}\n", edited(kUrdf, "col-major", "column-major")), "was accepted");
  for (int t = 0; t < 6; ++t) expectTaxel(sensor.patches[t], {t % 2 * 0.002, t / 2 * 0.003, 0}, {0.002, 0.003});
}

TEST(Urdf, NegativeSpacingFlips) {
  const Sensor sensor = load("urdf: {file: hand.urdf, sensor: flipped}\n");
  ASSERT_EQ(sensor.patches.size(), 6u);
  for (int t = 0; t < 6; ++t) expectTaxel(sensor.patches[t], {t / 3 * -0.002, t % 3 * 0.003, 0}, {0.002, 0.003});
}

TEST(Urdf, OrdersTaxelsByIndex) {
  const Sensor sensor = load("urdf: {file: hand.urdf, sensor: list}\n");
  ASSERT_EQ(sensor.patches.size(), 3u);
  const double side = 0.002 * std::sqrt(std::numbers::pi);
  expectTaxel(sensor.patches[0], {0, 0, 0}, {side, side});
  expectTaxel(sensor.patches[1], {0.01, 0.02, 0.03}, {0.004, 0.005});
  EXPECT_NEAR(rotate(sensor.patches[1].X_SP.rotation, {0, 0, 1})[0], 1, kRounding) << "pitch of 90 degrees turns z to x";
  expectTaxel(sensor.patches[2], {1, 0, 0}, {side / 2, side / 2});
}

// The canonical text of a scene with the taxels of `layout`; its files are in the same directory.
std::string resolved(const std::string& layout, std::string_view mesh = kTaxelMesh, std::string_view urdf = kUrdf) {
  const testing::TemporaryDirectory directory;
  directory.write("taxels.obj", mesh);
  directory.write("hand.urdf", urdf);
  const std::string text = edited(kScene, "  num_rows: 3\n  num_cols: 4\n  pitch_mm: 3.4\n", layout);
  return loadScene(directory.write("scene.yaml", text)).resolved;
}

TEST(TaxelFiles, ResolveToThemselves) {
  for (const std::string layout : {"  taxels: [{position_mm: [1, 2, 3], normal: [0, 0, 1], size_mm: 2}, "
                                   "{position_mm: [5, 2, 3], normal: [0, 1, 1], size_mm: [2, 3], x_axis: [1, 0, 0]}]\n",
                                   "  taxel_mesh: {file: taxels.obj, scale: 0.001}\n", "  urdf: {file: hand.urdf, sensor: columns}\n"}) {
    SCOPED_TRACE(layout);
    const std::string text = resolved(layout);
    const testing::TemporaryDirectory directory;
    directory.write("taxels.obj", kTaxelMesh);
    directory.write("hand.urdf", kUrdf);
    EXPECT_EQ(loadScene(directory.write("scene.yaml", text)).resolved, text);
  }
  const std::string spread = resolved("  taxels: [{position_mm: [1, 2, 3], normal: [0, 0, 1], size_mm: 2}]\n");
  const std::string metres = edited(spread, "    gaussian:\n      sigma: 0.5\n      size: 3\n", "    skin_gaussian:\n      sigma: 0.001\n");
  const testing::TemporaryDirectory directory;
  const std::string once = loadScene(directory.write("scene.yaml", metres)).resolved;
  EXPECT_EQ(loadScene(directory.write("again.yaml", once)).resolved, once);
}

TEST(TaxelFiles, BytesArePartOfTheResolvedScene) {
  const std::string mesh = "  taxel_mesh: {file: taxels.obj, scale: 0.001}\n", urdf = "  urdf: {file: hand.urdf, sensor: grid}\n";
  EXPECT_NE(resolved(mesh), resolved(mesh, edited(kTaxelMesh, "v 0 0 0", "v 0 0 0.01")));
  EXPECT_NE(resolved(urdf), resolved(urdf, kTaxelMesh, edited(kUrdf, "name=\"hand\"", "name=\"arm\"")));
  EXPECT_EQ(resolved(mesh), resolved(mesh, kTaxelMesh, "<robot/>"));
}

struct Bad {
  std::string from, to, message;
};

TEST(BadTaxels, Lists) {
  const std::string good = "taxels:\n  - {position: [0, 0, 0], normal: [0, 0, 1], size: 0.001}\n";
  for (const Bad& bad : {Bad{"position: [0, 0, 0], ", "", ":4:5: taxels[0]: position[_mm] is missing: a list of 3 numbers"},
                         Bad{"normal: [0, 0, 1], ", "", ":4:5: taxels[0]: normal is missing: a list of 3 numbers"},
                         Bad{", size: 0.001", "", ":4:5: taxels[0]: size[_mm] is missing: the side of a square"},
                         Bad{"[0, 0, 1]", "[0, 0, 0]", ":4:5: taxels[0]: normal: no direction"},
                         Bad{"[0, 0, 1]", "[0, 1]", ":4:35: taxels[0].normal: a list of 2 is not allowed: a list of 3 numbers"},
                         Bad{"0.001}", "0.001, x_axis: [0, 0, 2]}", ":4:5: taxels[0]: x_axis: runs along the normal"},
                         Bad{"0.001}", "0}", ":4:52: taxels[0].size: 0 is not allowed: a number > 0 m"},
                         Bad{"0.001}", "[1, 2, 3]}", ":4:52: taxels[0].size: a list of 3 is not allowed: a list of 2 numbers"},
                         Bad{"0.001}", "0.001, pitch: 1}", ":4:59: taxels[0].pitch: unknown key"},
                         Bad{"taxels:", "patches: []\ntaxels:", ":4:1: taxels: conflicts with `patches`: give only one of them"},
                         Bad{"taxels:", "num_rows: 1\ntaxels:", ":3:11: num_rows: conflicts with `taxels`"}}) {
    const std::string message = refusalOf(edited(good, bad.from, bad.to));
    if (bad.from == "taxels:") {
      EXPECT_THAT(message, ::testing::HasSubstr(bad.message.substr(bad.message.find(' ')))) << bad.to;
    } else {
      EXPECT_THAT(message, ::testing::StartsWith(bad.message)) << bad.to;
    }
  }
  EXPECT_THAT(refusalOf("taxels: []\n"), ::testing::StartsWith(":3:9: taxels: a list of 0 is not allowed: a list of at least one taxel"));
  EXPECT_THAT(refusalOf("taxels: 3\n"), ::testing::StartsWith(":3:9: taxels: 3 is not allowed: a list of at least one taxel"));
}

TEST(BadTaxels, Spreads) {
  const std::string taxel = "taxels: [{position: [0, 0, 0], normal: [0, 0, 1], size: 0.001}]\npsf: ";
  EXPECT_THAT(refusalOf(taxel + "{skin_gaussian: {}}\n"), ::testing::HasSubstr("psf.skin_gaussian: sigma[_mm] is missing: a number > 0 m"));
  EXPECT_THAT(refusalOf(taxel + "{skin_gaussian: {sigma: 0}}\n"), ::testing::HasSubstr("psf.skin_gaussian.sigma: 0 is not allowed"));
  EXPECT_THAT(refusalOf(taxel + "{skin_gaussian: {sigma: 1, reach: -1}}\n"),
              ::testing::HasSubstr("psf.skin_gaussian.reach: -1 is not allowed"));
  EXPECT_THAT(refusalOf(taxel + "{skin_gaussian: {sigma: 1, size: 3}}\n"), ::testing::HasSubstr("psf.skin_gaussian.size: unknown key"));
  EXPECT_THAT(refusalOf(taxel + "{skin_gaussian: {sigma: 1}, kernel: [[1]]}\n"),
              ::testing::HasSubstr("psf.kernel: conflicts with `skin_gaussian`: give only one of them"));
  EXPECT_THAT(refusalOf(taxel + "{skin_gaussian: {sigma: 1}, gaussian: {sigma: 1, size: 1}}\n"),
              ::testing::HasSubstr("psf.skin_gaussian: conflicts with `gaussian`: give only one of them"));
  EXPECT_THAT(refusalOf("num_rows: 40\nnum_cols: 40\npitch: 0.001\npsf: {skin_gaussian: {sigma: 0.01}}\n"),
              ::testing::HasSubstr("psf: reach: 0.03 is not allowed: m, within which taxel"));
}

TEST(BadTaxels, Meshes) {
  EXPECT_THAT(refusalOf("taxel_mesh: taxels.obj\n"),
              ::testing::StartsWith(":3:13: taxel_mesh: taxels.obj is not allowed: a mapping of file"));
  EXPECT_THAT(refusalOf("taxel_mesh: {}\n"), ::testing::HasSubstr("taxel_mesh: file is missing: a mesh file"));
  EXPECT_THAT(refusalOf("taxel_mesh: {file: nowhere.obj}\n"), ::testing::HasSubstr("nowhere.obj is not there, or not a file"));
  EXPECT_THAT(refusalOf("taxel_mesh: {file: hand.urdf}\n"), ::testing::HasSubstr("hand.urdf: unsupported mesh format"));
  EXPECT_THAT(refusalOf("taxel_mesh: {file: taxels.obj, scale: 0}\n"), ::testing::HasSubstr("taxel_mesh.scale: 0 is not allowed"));
  EXPECT_THAT(refusalOf("taxel_mesh: {file: taxels.obj, sha256: '00'}\n"), ::testing::HasSubstr("taxel_mesh.sha256: not the SHA-256"));
  EXPECT_THAT(refusalOf("taxel_mesh: {file: taxels.obj}\n", kUrdf, "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"),
              ::testing::HasSubstr("taxel_mesh.file: triangle 0 has no other with which it makes a taxel"));
  std::string many;
  for (int t = 0; t < 4097; ++t) {
    const std::string x = std::to_string(2 * t), next = std::to_string(2 * t + 1);
    many += "v " + x + " 0 0\nv " + next + " 0 0\nv " + next + " 1 0\nv " + x + " 1 0\nf -4 -3 -2 -1\n";
  }
  EXPECT_THAT(refusalOf("taxel_mesh: {file: taxels.obj}\n", kUrdf, many), ::testing::HasSubstr("8194 triangles are not allowed"));
}

TEST(BadTaxels, Urdfs) {
  const std::string list = "urdf: {file: hand.urdf, sensor: list}\n", gaps = "urdf: {file: hand.urdf, sensor: gaps}\n";
  EXPECT_THAT(refusalOf("urdf: {file: hand.urdf}\n"), ::testing::HasSubstr("urdf: sensor is missing"));
  EXPECT_THAT(refusalOf("urdf: {file: no.urdf, sensor: list}\n"), ::testing::HasSubstr("no.urdf is not there"));
  EXPECT_THAT(refusalOf("urdf: {file: hand.urdf, sensor: palm}\n"),
              ::testing::HasSubstr("hand.urdf:2: <robot> has no tactile sensor palm; it has grid, gaps, columns, flipped, list"));
  EXPECT_THAT(refusalOf("urdf: {file: hand.urdf, sensor: camera}\n"), ::testing::HasSubstr("has no tactile sensor camera"));
  EXPECT_THAT(refusalOf(list, "<robot>"), ::testing::HasSubstr("is not XML"));
  EXPECT_THAT(refusalOf(list, ""), ::testing::HasSubstr("is not XML"));
  EXPECT_THAT(refusalOf(list, "<sdf/>"), ::testing::HasSubstr("is not a URDF: no <robot>"));
  EXPECT_THAT(refusalOf(list, "<robot><sensor name='list'><tactile/></sensor></robot>"),
              ::testing::HasSubstr("neither an <array> nor a <taxel>"));
  std::string deep;
  for (int level = 0; level < 100'000; ++level) deep += "<a>";
  EXPECT_THAT(refusalOf(list, deep), ::testing::HasSubstr("is not XML"));
  const auto expect = [](const std::string& yaml, std::string_view from, std::string_view to, const std::string& message) {
    EXPECT_THAT(refusalOf(yaml, edited(kUrdf, from, to)), ::testing::HasSubstr(message)) << to;
  };
  const std::string_view array = "size=\"0.002 0.003\" spacing=\"0.004 0.005\" offset=\"0.001 0.002\"";
  expect(gaps, array, "", "hand.urdf:11: <array> size is missing: two lengths > 0 m");
  expect(gaps, array, "size=\"0.002\"", "<array> size: \"0.002\" is not allowed: 2 numbers between blanks");
  expect(gaps, array, "size=\"0.002 x\"", "<array> size: \"0.002 x\" is not allowed: 2 numbers between blanks");
  expect(gaps, array, "size=\"0.002 nan\"", "<array> size: \"0.002 nan\" is not allowed: 2 numbers between blanks");
  expect(gaps, array, "size=\"0.002 1e31\"", "is not allowed: 2 numbers between blanks");
  expect(gaps, array, "size=\"0.002 -0.003\"", "<array> size: \"0.002 -0.003\" is not allowed: two lengths > 0 m");
  expect(gaps, array, "size=\"0.002 0.003\" spacing=\"0.001 0.003\"", "<array> spacing: \"0.001 0.003\" is not allowed: at least the size");
  expect(gaps, "<array rows=\"2\" cols=\"3\" order=\"row-major\" size=\"0.002 0.003\" spacing",
         "<array rows=\"0\" cols=\"3\" size=\"1 1\" x", "<array> rows: \"0\" is not allowed: a whole number from 1 to 4096");
  expect(gaps, "<array rows=\"2\" cols=\"3\" order=\"row-major\" size=\"0.002 0.003\" spacing", "<array cols=\"3\" size=\"1 1\" x",
         "<array> rows is missing");
  expect(gaps, "<array rows=\"2\" cols=\"3\" order=\"row-major\" size=\"0.002 0.003\" spacing",
         "<array rows=\"100\" cols=\"100\" size=\"0.002 0.003\" spacing", "100 x 100 taxels are not allowed: at most 4096");
  expect(gaps, "<array rows=\"2\" cols=\"3\" order=\"row-major\" size=\"0.002 0.003\" spacing",
         "<array rows=\"2\" cols=\"3\" order=\"sideways\" size=\"0.002 0.003\" spacing",
         "order: \"sideways\" is not allowed: row-major, column-major or col-major");
  expect(list, "idx=\"1\"", "idx=\"0\"", "idx: an earlier taxel has 0");
  expect(list, "idx=\"1\"", "idx=\"4\"", "no taxel has idx 1, but one has 2");
  expect(list, "idx=\"1\"", "idx=\"-1\"", "idx: \"-1\" is not allowed: a whole number from 0 to 4095");
  expect(list, "idx=\"1\"", "", "<taxel> idx is missing");
  expect(list, "xyz=\"1 0 0\"", "xyz=\"1 0\"", "<taxel> xyz: \"1 0\" is not allowed: 3 numbers between blanks");
  expect(list, "<sphere radius=\"0.001\"/>", "<sphere radius=\"0\"/>", "<sphere> radius: \"0\" is not allowed: a number > 0 m");
  expect(list, "<sphere radius=\"0.001\"/>", "<sphere/>", "<sphere> radius is missing");
  expect(list, "<sphere radius=\"0.001\"/>", "<mesh filename=\"a.stl\"/>", "<mesh> is no geometry that says how large a taxel is");
  expect(list, "<sphere radius=\"0.001\"/>", "", "<taxel> has no geometry");
  expect(list, "<box size=\"0.004 0.005 0.001\"/>", "<box size=\"0 0.005 0.001\"/>",
         "<box> size: \"0 0.005 0.001\" is not allowed: lengths > 0 m");
  expect(list, "<taxel idx=\"0\">", "<array rows=\"1\" cols=\"1\" size=\"1 1\"/><taxel idx=\"0\">", "conflicts with <taxel>");
}

}  // namespace
}  // namespace taxelsim
