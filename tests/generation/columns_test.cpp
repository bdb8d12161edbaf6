#include "generation/columns.h"

#include "episodes/draw.h"
#include "episodes/example_scene.h"
#include "support/test.h"
#include "taxelsim/error.h"
#include "taxelsim/generate.h"

namespace taxelsim {
namespace {

std::set<std::string> namesOf(const Scene& scene) {
  std::set<std::string> names;
  for (const Column& column : columnsOf(scene)) names.insert(column.name);
  return names;
}

const Column& columnNamed(const std::vector<Column>& columns, const std::string& name) {
  const auto found = std::find_if(columns.begin(), columns.end(), [&](const Column& c) { return c.name == name; });
  if (found == columns.end()) throw Error(ErrorKind::kInput, "no column " + name);
  return *found;
}

const std::set<std::string> kAlways = {"data/time",
                                       "meta/episode",
                                       "meta/object",
                                       "meta/object_name",
                                       "meta/load",
                                       "meta/load_driven",
                                       "meta/depth",
                                       "meta/load_reached",
                                       "meta/gain",
                                       "meta/gain_spread",
                                       "meta/noise",
                                       "meta/controller",
                                       "meta/controller_name",
                                       "meta/exploration_velocity",
                                       "meta/linear_action_noise",
                                       "meta/angular_action_noise"};
const std::set<std::string> kFeatures = {"total_force", "peak_force", "center_of_pressure", "second_moments",
                                         "eigenvalues", "edge_angle", "edge_confidence",    "contact_area"};

TEST(Columns, EveryGroupHasItsColumns) {
  Scene scene = exampleScene();
  scene.record.clear();
  EXPECT_EQ(namesOf(scene), kAlways);

  std::set<std::string> measured = kAlways;
  for (const std::string& name : kFeatures) measured.insert("data/" + name);
  measured.insert("data/saturated");
  scene.record = {"features"};
  EXPECT_EQ(namesOf(scene), measured);

  std::set<std::string> clean = kAlways;
  for (const std::string& name : kFeatures) clean.insert("data/ground_truth/" + name);
  clean.insert({"data/ground_truth/contact_wrench", "data/ground_truth/over_penetration"});
  scene.record = {"ground_truth"};
  EXPECT_EQ(namesOf(scene), clean);
  Scene elastic = scene;
  elastic.sensor.skin.law = ElasticLayer{.elastic_modulus = 1e6};
  clean.insert({"data/ground_truth/off_array_load", "data/ground_truth/contact_residual", "data/ground_truth/contact_iterations"});
  EXPECT_EQ(namesOf(elastic), clean);

  const std::set<std::string> contact = {"windowed_edge_angle",
                                         "windowed_edge_confidence",
                                         "ridge_edge_angle",
                                         "ridge_edge_confidence",
                                         "tilt",
                                         "tilt_confidence",
                                         "contact_type",
                                         "patch",
                                         "num_regions"};
  for (const auto& [group, prefix] :
       {std::pair{"contact_features", "data/contact/"}, {"clean_contact_features", "data/ground_truth/contact/"}}) {
    std::set<std::string> expected = kAlways;
    for (const std::string& name : kFeatures) expected.insert(prefix + name);
    for (const std::string& name : contact) expected.insert(prefix + name);
    scene.record = {group};
    EXPECT_EQ(namesOf(scene), expected) << group;
  }

  for (const auto& [group, names] :
       std::vector<std::pair<std::string, std::vector<std::string>>>{{"tactile_image", {"data/tactile_image"}},
                                                                     {"tactile_normal_force", {"data/ground_truth/tactile_normal_force"}},
                                                                     {"tactile_shear_force", {"data/ground_truth/tactile_shear_force"}},
                                                                     {"penetration_depth", {"data/ground_truth/penetration_depth"}},
                                                                     {"taxel_counts", {"data/taxel_counts"}},
                                                                     {"poses", {"data/pose", "data/sensor_pose"}},
                                                                     {"actions", {"data/action"}}}) {
    std::set<std::string> expected = kAlways;
    expected.insert(names.begin(), names.end());
    scene.record = {group};
    EXPECT_EQ(namesOf(scene), expected) << group;
  }
}

TEST(Columns, NamesAreUniqueWithUnitAndDescription) {
  const std::vector<Column> columns = columnsOf(exampleScene());
  EXPECT_EQ(namesOf(exampleScene()).size(), columns.size());
  for (const Column& column : columns) {
    EXPECT_FALSE(column.unit.empty()) << column.name;
    EXPECT_TRUE(column.description.ends_with('.')) << column.name;
    EXPECT_EQ(column.per_episode, column.name.starts_with("meta/")) << column.name;
  }
}

TEST(Columns, IntegersHaveTheSmallestTypeAndNames) {
  Scene scene = exampleScene();
  scene.record.emplace_back("robot");
  scene.sensor.skin.law = ElasticLayer{.elastic_modulus = 1e6};
  const std::vector<std::string> flag{"false", "true"};
  std::vector<Column> columns = columnsOf(scene);
  const auto expectColumn = [&](const std::string& name, ScalarType type, const std::vector<std::string>& value_names) {
    EXPECT_EQ(nameOf(columnNamed(columns, name).type), std::string(nameOf(type))) << name;
    EXPECT_EQ(columnNamed(columns, name).value_names, value_names) << name;
  };
  expectColumn("data/contact/contact_type", ScalarType::kUint8, {"none", "point", "edge", "area"});
  expectColumn("data/ground_truth/contact/contact_type", ScalarType::kUint8, {"none", "point", "edge", "area"});
  expectColumn("data/contact/patch", ScalarType::kInt16, {});
  expectColumn("data/contact/num_regions", ScalarType::kUint16, {});
  expectColumn("data/ground_truth/contact_iterations", ScalarType::kUint16, {});
  expectColumn("data/robot/status", ScalarType::kUint8, {});
  EXPECT_EQ(columnNamed(columns, "data/robot/status").bit_names,
            (std::vector<std::string>{"joint_limit", "velocity_limit", "singular", "lost"}));
  expectColumn("meta/episode", ScalarType::kUint64, {});
  expectColumn("meta/object", ScalarType::kUint16, {});
  expectColumn("meta/controller", ScalarType::kInt16, {});
  expectColumn("meta/load_driven", ScalarType::kUint8, flag);
  expectColumn("meta/load_reached", ScalarType::kUint8, flag);
  expectColumn("meta/object_name", ScalarType::kText, {});
  EXPECT_EQ(columnNamed(columns, "meta/object_name").text_length, 4u) << "ball";

  constexpr std::size_t kManyPatches = 3;  // of 16,384 taxels each
  scene.sensor.patches.assign(kManyPatches, {.name = "grid", .num_rows = 128, .num_cols = 128, .pitch = {1e-3, 1e-3}, .X_SP = {}});
  columns = columnsOf(scene);
  expectColumn("data/contact/patch", ScalarType::kInt32, {});
  expectColumn("data/contact/num_regions", ScalarType::kUint16, {});
}

TEST(Columns, SuccessNeedsATaskAndTheExactEdgeAnObjectWithOne) {
  Scene scene = exampleScene();
  EXPECT_FALSE(namesOf(scene).contains("meta/success"));
  EXPECT_FALSE(namesOf(scene).contains("data/ground_truth/exact_edge_angle"));
  scene.task = Task{};
  EXPECT_TRUE(namesOf(scene).contains("meta/success"));
  scene.objects[1].edge = Vector3{1, 0, 0};
  EXPECT_TRUE(namesOf(scene).contains("data/ground_truth/exact_edge_angle"));
  EXPECT_TRUE(namesOf(scene).contains("data/ground_truth/exact_edge_known"));
  scene.objects[1].edge.reset();
  scene.objects[1].contour = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  EXPECT_TRUE(namesOf(scene).contains("data/ground_truth/exact_edge_angle"));
  scene.record = {"features"};
  EXPECT_FALSE(namesOf(scene).contains("data/ground_truth/exact_edge_angle"));
}

TEST(Columns, ImageShapeIsTheGridOrAListForSeveralPatches) {
  Scene scene = exampleScene();
  std::vector<Column> columns = columnsOf(scene);
  EXPECT_EQ(columnNamed(columns, "data/tactile_image").shape, (std::vector<std::size_t>{6, 14}));
  EXPECT_EQ(columnNamed(columns, "data/tactile_image").type, ScalarType::kUint16);
  EXPECT_EQ(columnNamed(columns, "data/ground_truth/tactile_shear_force").shape, (std::vector<std::size_t>{6, 14, 2}));
  scene.record.emplace_back("taxel_counts");
  columns = columnsOf(scene);
  EXPECT_EQ(columnNamed(columns, "data/taxel_counts").shape, (std::vector<std::size_t>{6, 14, 3}));
  EXPECT_EQ(columnNamed(columns, "data/taxel_counts").type, ScalarType::kInt32);
  EXPECT_TRUE(outputsOf(scene).taxel_counts);
  scene.sensor.patches.push_back(scene.sensor.patches[0]);
  columns = columnsOf(scene);
  EXPECT_EQ(columnNamed(columns, "data/taxel_counts").shape, (std::vector<std::size_t>{168, 3}));
  EXPECT_EQ(columnNamed(columns, "data/tactile_image").shape, (std::vector<std::size_t>{168}));
  EXPECT_EQ(columnNamed(columns, "data/ground_truth/tactile_shear_force").shape, (std::vector<std::size_t>{168, 2}));
}

TEST(Columns, ContactFeatureRowsAreSensorPatchesAndRegions) {
  Scene scene = exampleScene();
  const auto shape = [&](const char* name) { return columnNamed(columnsOf(scene), std::string("data/contact/") + name).shape; };
  EXPECT_EQ(shape("total_force"), (std::vector<std::size_t>{4}));
  EXPECT_EQ(shape("center_of_pressure"), (std::vector<std::size_t>{4, 3}));
  EXPECT_EQ(shape("tilt"), (std::vector<std::size_t>{4, 2}));
  EXPECT_TRUE(shape("num_regions").empty());
  scene.sensor.patches.push_back(scene.sensor.patches[0]);
  scene.max_regions = 0;
  EXPECT_EQ(shape("total_force"), (std::vector<std::size_t>{3}));
  for (GridPatch& patch : scene.sensor.patches) patch.num_rows = patch.num_cols = 1;  // a list of taxels
  EXPECT_EQ(shape("total_force"), (std::vector<std::size_t>{1}));
}

TEST(Columns, TactileJacobianRowsAreSensorAndPatches) {
  Scene scene = exampleScene();
  scene.record = {"tactile_jacobian", "clean_tactile_jacobian"};
  std::set<std::string> expected = kAlways;
  for (const char* name : {"center_of_pressure", "total_force", "edge_angle"}) {
    expected.insert(std::string("data/jacobian/") + name);
    expected.insert(std::string("data/ground_truth/jacobian/") + name);
  }
  expected.insert("data/ground_truth/jacobian/contact_wrench");
  EXPECT_EQ(namesOf(scene), expected);
  const auto shape = [&](const char* name) { return columnNamed(columnsOf(scene), name).shape; };
  EXPECT_EQ(shape("data/jacobian/center_of_pressure"), (std::vector<std::size_t>{2, 3, 6}));
  EXPECT_EQ(shape("data/ground_truth/jacobian/contact_wrench"), (std::vector<std::size_t>{6, 6}));
  scene.sensor.patches.push_back(scene.sensor.patches[0]);
  EXPECT_EQ(shape("data/jacobian/total_force"), (std::vector<std::size_t>{3, 6}));
  for (const Column& column : columnsOf(scene)) EXPECT_TRUE(column.description.ends_with('.')) << column.name;
  EXPECT_TRUE(outputsOf(scene).tactile_jacobian);
  EXPECT_TRUE(outputsOf(scene).clean_tactile_jacobian);
}

TEST(Columns, RequestOnlyRecordedOutputs) {
  Scene scene = exampleScene();
  EXPECT_TRUE(outputsOf(scene).tactile_shear_force);
  scene.record = {"penetration_depth"};
  const OutputOptions outputs = outputsOf(scene);
  EXPECT_FALSE(outputs.tactile_normal_force);
  EXPECT_FALSE(outputs.tactile_shear_force);
  EXPECT_TRUE(outputs.penetration_depth);
  EXPECT_FALSE(outputs.contact_features);
  EXPECT_FALSE(outputs.clean_contact_features);
  EXPECT_FALSE(outputs.tactile_jacobian);
  EXPECT_FALSE(outputs.clean_tactile_jacobian);
  EXPECT_TRUE(outputsOf(exampleScene()).contact_features);
  EXPECT_EQ(numRegions(exampleScene()), 2);
}

TEST(Columns, RejectsUnknownGroups) {
  Scene scene = exampleScene();
  scene.record = {"tactile_images"};
  EXPECT_THROW(columnsOf(scene), Error);
}

}  // namespace
}  // namespace taxelsim
