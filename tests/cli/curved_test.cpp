// Curved sensors on the command line: values, figures, and the layout of taxels in them.
#include <cairo.h>

#include <nlohmann/json.hpp>

#include "cli/command_line.h"
#include "figures/taxel_chart.h"
#include "support/curved_sensor.h"
#include "support/test.h"

namespace taxelsim::testing {
namespace {

using figures::TaxelOutline;

const std::string kSensors = std::string(TAXELSIM_SOURCE_DIR) + "/scenes/sensors/";
constexpr double kRounding = 1e-9;  // m: vertices of an icosphere are float32

double along(const TaxelOutline& outline, std::size_t axis) {
  double sum = 0;
  for (const auto& corner : outline) sum += corner[axis];
  return sum / 4;
}

TEST(Unrolled, ACylinderIsARectangle) {
  constexpr double kRadius = 8e-3, kHalfAngle = 1.4, kPitch = 2e-3;
  const Sensor sensor = support::cylinderFingertip(kRadius, kHalfAngle, 9, 4, kPitch);
  const std::vector<TaxelOutline> outlines = figures::unrolled(sensor);
  ASSERT_EQ(outlines.size(), 36u);
  const double step = 2 * kHalfAngle / 8 * kRadius;
  for (int t = 0; t < 36; ++t) {
    EXPECT_NEAR(along(outlines[t], 0), (t / 4 - 4) * step, kRounding);
    EXPECT_NEAR(along(outlines[t], 1), (t % 4 - 1.5) * kPitch, kRounding);
    EXPECT_NEAR(outlines[t][2][0] - outlines[t][0][0], step, kRounding);
    EXPECT_NEAR(outlines[t][2][1] - outlines[t][0][1], kPitch, kRounding);
  }
}

TEST(Unrolled, ASphereKeepsDistancesFromItsCentre) {
  Sensor sensor = support::sphereFingertip(8e-3, 2, 1.2);
  const std::vector<Vector3> normals = taxelNormals(sensor);
  const Pose X_turned{{0.1, -0.2, 0.3}, axisAngle({1, 0, 0}, 2)};
  for (const bool turned : {false, true}) {
    if (turned) {
      for (GridPatch& patch : sensor.patches) patch.X_SP = X_turned * patch.X_SP;
    }
    const std::vector<TaxelOutline> outlines = figures::unrolled(sensor);
    double x = 0, y = 0;
    for (std::size_t t = 0; t < outlines.size(); ++t) {
      if (normals[t][2] > 0.9999) x = along(outlines[t], 0), y = along(outlines[t], 1);
    }
    for (std::size_t t = 0; t < outlines.size(); ++t) {
      const double distance = std::hypot(along(outlines[t], 0) - x, along(outlines[t], 1) - y);
      EXPECT_NEAR(distance, 8e-3 * std::acos(std::min(normals[t][2], 1.0)), 1e-5) << "the cap's mean normal is its axis within 1e-3";
    }
  }
}

TEST(Unrolled, TaxelsFacingAllDirectionsHaveOutlines) {
  const Sensor ball = support::sphereFingertip(8e-3, 1, 3.2);
  for (const TaxelOutline& outline : figures::unrolled(ball)) {
    for (const auto& corner : outline) EXPECT_TRUE(std::isfinite(corner[0]) && std::isfinite(corner[1]));
  }
}

TEST(CurvedFrame, BothFingertipsGiveValuesAndAPicture) {
  const TemporaryDirectory root;
  for (const auto& [name, taxels] : {std::pair{"fingertip_cylinder", 88u}, std::pair{"fingertip_sphere", 65u}}) {
    SCOPED_TRACE(name);
    const std::vector<std::string> command{
        "frame", "--sensor", kSensors + name + ".yaml", "--object", "sphere:0.01", "--pose", "0 0 0.02 1 0 0 0", "--load", "1"};
    std::vector<std::string> json_command = command, png_command = command;
    json_command.push_back("--json");
    const nlohmann::json json = jsonOf(json_command);
    EXPECT_EQ(json["tactile_image"].size(), taxels);
    EXPECT_NEAR(-json["ground_truth"]["contact_wrench"][2].get<double>(), 1, 2e-6) << "the load search stops at 1e-6";
    EXPECT_GT(json["ground_truth"]["total_force"].get<double>(), 1.001) << "on a skin that slopes";
    EXPECT_LT(json["ground_truth"]["total_force"].get<double>(), 1.1) << "a contact in the middle";
    png_command.insert(png_command.end(), {"--png", root / "frame.png"});
    const Outcome drawn = succeed(png_command);
    EXPECT_TRUE(contentOf(root / "frame.png").starts_with("\x89PNG"));
    EXPECT_THAT(drawn.out, ::testing::HasSubstr(std::to_string(taxels) + " taxels"));
    EXPECT_THAT(drawn.out, ::testing::Not(::testing::HasSubstr("taxel_1"))) << "no heading for each taxel";
  }
}

TEST(CurvedFrame, AThousandTaxelsFitIntoAPicture) {
  const TemporaryDirectory root;
  std::ofstream file(root / "many.yaml");
  file << "format_version: 1\nname: many\nskin: {thickness_mm: 2, normal_contact_stiffness: 1.73e8}\n"
          "readout: {curve: {counts_per_newton: 2400}}\ntaxels:\n";
  for (int t = 0; t < 1000; ++t) file << "  - {position_mm: [" << t % 25 << ", " << t / 25 << ", 0], normal: [0, 0, 1], size_mm: 1}\n";
  file.close();
  succeed({"frame", "--sensor", root / "many.yaml", "--object", "sphere:0.01", "--pose", "0.012 0.02 0.009 1 0 0 0", "--png",
           root / "many.png"});
  EXPECT_TRUE(contentOf(root / "many.png").starts_with("\x89PNG"));
}

TEST(CurvedDataSet, IsMadeAndDrawn) {
  const TemporaryDirectory root;
  std::ofstream(root / "scene.yaml") << "format_version: 1\nname: fingertip\nkind: contacts\nsensor: " << kSensors
                                     << "fingertip_sphere.yaml\n"
                                     << "objects: [{sphere: {radius_mm: 6}}]\nrandomization: {load: 1}\nepisode: {}\n"
                                     << "data_set: {episodes: 2}\n";
  succeed({"generate", root / "scene.yaml", "-o", root / "out"});
  succeed({"render", root / "out", "-o", root / "out.png"});
  EXPECT_TRUE(contentOf(root / "out.png").starts_with("\x89PNG"));
}

TEST(CurvedDataSet, TaxelsAreFoundInTheResolvedScene) {
  Manifest manifest;
  manifest.scene =
      "sensor:\n  taxels:\n    - {position: [0, 0, 1], normal: [0, 0, 1], size: [1, 2]}\n"
      "    - {position: [3, 0, 1], normal: [0, 1, 0], size: [1, 2], x_axis: [1, 0, 0]}\n";
  const auto found = figures::listedTaxels(manifest);
  ASSERT_TRUE(found);
  EXPECT_EQ(taxelPositions(*found)[1], (Vector3{3, 0, 1}));
  for (const char* other :
       {"", "sensor: {num_rows: 3}", "sensor: {taxels: [1]}", "sensor: {taxels: [{position: [0, 0, 0]}]}", "{", "taxels"}) {
    manifest.scene = other;
    EXPECT_FALSE(figures::listedTaxels(manifest)) << other;
  }
}

// Two taxels as outlines, one rotated by 45 degrees.
TEST(CurvedFigure, OutlinesLieWhereTheySay) {
  const TemporaryDirectory root;
  figures::TactilePanel panel;
  panel.values = {0, 9};
  panel.outlines = {{{{0, 0}, {0, 1}, {1, 1}, {1, 0}}}, {{{3, 3}, {4, 4}, {5, 3}, {4, 2}}}};
  panel.neighbours = false;
  figures::writeTactileFigure(root / "x.png", {panel}, {.title = "two", .subtitle = "", .unit = "counts"});
  cairo_surface_t* picture = cairo_image_surface_create_from_png((root / "x.png").c_str());
  ASSERT_EQ(cairo_surface_status(picture), CAIRO_STATUS_SUCCESS);
  const auto middle = [&](unsigned code) {
    double count = 0, x = 0, y = 0;
    for (int j = 0; j < cairo_image_surface_get_height(picture); ++j) {
      for (int i = 0; i < cairo_image_surface_get_width(picture) / 2; ++i) {  // left of the colour bar
        const auto* row =
            reinterpret_cast<const std::uint32_t*>(cairo_image_surface_get_data(picture) + j * cairo_image_surface_get_stride(picture));
        if ((row[i] & 0xffffff) != code) continue;
        ++count, x += i, y += j;
      }
    }
    return std::array{x / count, y / count, count};
  };
  const auto dark = middle(0x440154), bright = middle(0xfde725);
  EXPECT_GT(dark[2], 1000);
  EXPECT_GT(bright[0], dark[0]) << "y points right";
  EXPECT_GT(bright[1], dark[1]) << "x points down";
  EXPECT_GT(bright[2], 1.5 * dark[2]) << "a square of side root 2";
  cairo_surface_destroy(picture);
}

}  // namespace
}  // namespace taxelsim::testing
