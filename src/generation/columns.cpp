#include "generation/columns.h"

#include <algorithm>
#include <cstddef>
#include <set>
#include <string>

#include "episodes/draw.h"
#include "sensor/regions.h"
#include "taxelsim/error.h"
#include "taxelsim/generate.h"

namespace taxelsim {
namespace {

using Source = FrameColumn::Source;

std::set<std::string> groupsOf(const Scene& scene) {
  std::set<std::string> groups;
  for (const std::string& name : scene.record) {
    if (std::find(kRecordWords.begin(), kRecordWords.end(), name) == kRecordWords.end()) {
      std::string allowed;
      for (const std::string_view group : kRecordWords) allowed += (allowed.empty() ? "" : ", ") + std::string(group);
      throw Error(ErrorKind::kInput, scene.file.string() + ": record: \"" + name + "\" found, one of " + allowed + " allowed");
    }
    groups.insert(name);
  }
  return groups;
}

// (num_rows, num_cols) of one grid patch, else (num_taxels).
std::vector<std::size_t> taxelShape(const Sensor& sensor) {
  if (sensor.patches.size() != 1) return {static_cast<std::size_t>(numTaxels(sensor))};
  return {static_cast<std::size_t>(sensor.patches[0].num_rows), static_cast<std::size_t>(sensor.patches[0].num_cols)};
}

constexpr const char* kMeasuredForces = "the measured taxel forces";
constexpr const char* kTrueForces = "the true taxel forces";
constexpr const char* kReadoutForces = "the taxel forces as the readout has them without noise";

// Where the features of one view become columns.
struct FeatureGroup {
  std::string prefix;               // of the column names, below data/
  std::string forces;               // source of the features, for descriptions
  std::vector<std::size_t> rows{};  // (num_rows), or empty for one row
};

// A column of float32 values.
FrameColumn floatColumn(const std::string& name, std::vector<std::size_t> shape, std::string_view unit, std::string description,
                        std::function<FeatureValues(const FrameView&)> values) {
  return {{"data/" + name, ScalarType::kFloat32, std::move(shape), std::string(unit), std::move(description), false},
          Source::kFeature,
          std::move(values)};
}

// Columns of the features in `table`. `view` returns the view that has them; `parts`: the last dimension of a row is cut into this many.
template <typename Field, typename View>
void addFeatures(std::vector<FrameColumn>& columns, std::span<const Field> table, const FeatureGroup& group, View view,
                 std::size_t parts = 1) {
  for (const Field& field : table) {
    std::vector<std::size_t> shape = group.rows;
    if (field.width > parts) shape.push_back(field.width / parts);
    if (parts > 1) shape.push_back(parts);
    columns.push_back(floatColumn(group.prefix + std::string(field.name), std::move(shape), field.unit, field.description(group.forces),
                                  [&field, view](const FrameView& frame) { return field.values(view(frame)); }));
  }
}

template <typename View>
void addContactFeatures(std::vector<FrameColumn>& columns, const FeatureGroup& group, View view) {
  addFeatures(columns, imageFeatures(), group, view);
  addFeatures(columns, contactFeatures(), group, view);
  addFeatures(columns, regionFeatures(), {group.prefix, group.forces}, view);
}

constexpr std::size_t kTwist = 6;  // coordinates

template <typename View>
void addJacobian(std::vector<FrameColumn>& columns, const FeatureGroup& group, View view) {
  addFeatures(columns, jacobianFeatures(), group, view, kTwist);
}

void addGroundTruth(const Scene& scene, std::vector<FrameColumn>& columns) {
  const FeatureGroup group{"ground_truth/", kTrueForces};
  const auto truth = [](const FrameView& frame) -> const GroundTruthView& { return frame.ground_truth; };
  addFeatures(columns, imageFeatures(), group, truth);
  const bool is_layer = std::holds_alternative<ElasticLayer>(scene.sensor.skin.law);
  for (const FeatureField<GroundTruthView>& field : truthFeatures()) {
    if (field.recorded == "always" || (field.recorded == "elastic_layer" && is_layer)) {
      addFeatures(columns, std::span(&field, 1), group, truth);
    }
  }
}

// Arrays over the taxels.
void addTaxels(const Scene& scene, const std::set<std::string>& groups, std::vector<FrameColumn>& columns) {
  const auto add = [&](const std::string& name, std::vector<std::size_t> shape, const char* unit, const char* description,
                       std::span<const float> GroundTruthView::*member) {
    if (!groups.contains(name)) return;
    columns.push_back(floatColumn("ground_truth/" + name, std::move(shape), unit, description,
                                  [member](const FrameView& frame) { return FeatureValues(frame.ground_truth.*member); }));
  };
  const std::vector<std::size_t> taxels = taxelShape(scene.sensor);
  std::vector<std::size_t> taxel_vectors = taxels;
  taxel_vectors.push_back(2);
  add("tactile_normal_force", taxels, "N", "Normal force of each taxel after the point spread function, before the readout.",
      &GroundTruthView::tactile_normal_force);
  add("tactile_shear_force", taxel_vectors, "N",
      "Shear force of each taxel along its x and y after the point spread function, before the readout.",
      &GroundTruthView::tactile_shear_force);
  add("penetration_depth", taxels, "m", "Depth of the object in the skin, mean over each taxel.", &GroundTruthView::penetration_depth);
}

// Contact features: rows for the sensor, its patches, its regions. Tactile Jacobian: rows for the sensor and its patches.
void addRows(const Scene& scene, const std::set<std::string>& groups, std::vector<FrameColumn>& columns) {
  const auto num_rows = static_cast<std::size_t>(1 + numFeaturePatches(scene.sensor));
  const std::size_t num_contact_rows = num_rows + static_cast<std::size_t>(numRegions(scene));
  if (groups.contains("contact_features")) {
    addContactFeatures(columns, {"contact/", kMeasuredForces, {num_contact_rows}},
                       [](const FrameView& frame) -> const ContactFeatureView& { return frame.contact; });
  }
  if (groups.contains("clean_contact_features")) {
    addContactFeatures(columns, {"ground_truth/contact/", kTrueForces, {num_contact_rows}},
                       [](const FrameView& frame) -> const ContactFeatureView& { return frame.ground_truth.contact; });
  }
  if (groups.contains("tactile_jacobian")) {
    addJacobian(columns, {"jacobian/", kReadoutForces, {num_rows}},
                [](const FrameView& frame) -> const TactileJacobianView& { return frame.jacobian; });
  }
  if (groups.contains("clean_tactile_jacobian")) {
    const auto view = [](const FrameView& frame) -> const CleanTactileJacobianView& { return frame.ground_truth.jacobian; };
    addJacobian(columns, {"ground_truth/jacobian/", kTrueForces, {num_rows}}, view);
    addFeatures(columns, wrenchJacobian(), {"ground_truth/jacobian/", kTrueForces}, view, kTwist);
  }
}

void addPoses(std::vector<FrameColumn>& columns) {
  const auto add = [&](const char* name, const char* description, Source source) {
    columns.push_back({{name, ScalarType::kFloat64, {7}, "m, 1", description, false}, source});
  };
  add("data/pose", "Pose of the object in the sensor frame: x, y, z, then the quaternion w, x, y, z.", Source::kPose);
  add("data/sensor_pose", "Pose of the sensor in the world frame: x, y, z, then the quaternion w, x, y, z.", Source::kSensorPose);
}

bool hasActionNoise(const Scene& scene) {
  return scene.randomization.linear_action_noise.max > 0 || scene.randomization.angular_action_noise.max > 0;
}

void addActions(const Scene& scene, std::vector<FrameColumn>& columns) {
  const auto add = [&](const char* name, const char* description, Source source) {
    columns.push_back({{name, ScalarType::kFloat32, {kTwist}, "m/s, rad/s", description, false}, source});
  };
  add("data/action", "Twist of the sensor frame, in that frame, commanded after this frame: linear, then angular velocity.",
      Source::kAction);
  if (hasActionNoise(scene)) add("data/controller_action", "The same before noise was added.", Source::kControllerAction);
}

void addRobot(const Robot& robot, std::vector<FrameColumn>& columns) {
  const auto add = [&](const char* name, ScalarType type, std::vector<std::size_t> shape, const char* unit, const std::string& description,
                       Source source) {
    columns.push_back({{std::string("data/robot/") + name, type, std::move(shape), unit, description, false}, source});
  };
  add("status", ScalarType::kInt32, {}, "1",
      "Limits that the robot met before this frame, a sum: 1 a joint at its position limit, 2 too fast a twist or a drive behind its "
      "command, 4 near a singular pose, 8 no finite twist; 0 none.",
      Source::kRobotStatus);
  const auto* manipulator = std::get_if<Manipulator>(&robot);
  if (manipulator == nullptr) return;
  std::string names;
  for (const Joint& joint : manipulator->joints) names += (names.empty() ? "" : ", ") + joint.name;
  const std::size_t num_joints = manipulator->joints.size();
  add("joint_position", ScalarType::kFloat64, {num_joints}, "rad or m", "Positions of the joints " + names + ".", Source::kJointPosition);
  add("joint_velocity", ScalarType::kFloat64, {num_joints}, "rad/s or m/s",
      "Velocities of the joints, not of their commands, on the way to this frame.", Source::kJointVelocity);
}

// Whether every sensor of a robot has values of this source, as opposed to the robot.
bool isOfSensor(Source source) {
  return source == Source::kImage || source == Source::kFeature || source == Source::kPose || source == Source::kSensorPose;
}

std::vector<FrameColumn> frameColumns(const Scene& scene, const std::set<std::string>& groups) {
  std::vector<FrameColumn> columns;
  columns.push_back({{"data/time", ScalarType::kFloat64, {}, "s", "Time since the episode's first frame.", false}, Source::kTime});
  if (groups.contains("tactile_image")) {
    columns.push_back(
        {{"data/tactile_image", ScalarType::kUint16, taxelShape(scene.sensor), "counts", "Output of the sensor.", false}, Source::kImage});
  }
  if (groups.contains("features")) {
    const auto frame_itself = [](const FrameView& frame) -> const FrameView& { return frame; };
    addFeatures(columns, imageFeatures(), {"", kMeasuredForces}, frame_itself);
    addFeatures(columns, readoutFeatures(), {"", kMeasuredForces}, frame_itself);
  }
  if (groups.contains("ground_truth")) addGroundTruth(scene, columns);
  addTaxels(scene, groups, columns);
  addRows(scene, groups, columns);
  if (groups.contains("poses")) addPoses(columns);
  if (groups.contains("actions")) addActions(scene, columns);
  if (const auto num_sensors = static_cast<std::size_t>(numSensors(scene)); num_sensors > 1) {
    for (FrameColumn& entry : columns) {
      if (isOfSensor(entry.source)) entry.column.shape.insert(entry.column.shape.begin(), num_sensors);
    }
  }
  if (groups.contains("robot")) addRobot(scene.robot, columns);
  return columns;
}

std::vector<EpisodeColumn> episodeColumns(const Scene& scene) {
  std::vector<EpisodeColumn> columns;
  const auto add = [&](const char* name, ScalarType type, const char* unit, const char* description, std::size_t offset) {
    columns.push_back({{std::string("meta/") + name, type, {}, unit, description, true}, offset});
  };
  add("episode", ScalarType::kUint64, "1", "Number of the episode; with the seed it keys all random numbers of the episode.",
      offsetof(EpisodeRecord, episode));
  add("object", ScalarType::kInt32, "1", "Index of the object in the scene, from 0.", offsetof(EpisodeRecord, object));
  add("load", ScalarType::kFloat32, "N", "Normal force prescribed at the start; 0 if load_driven is 0.", offsetof(EpisodeRecord, load));
  add("load_driven", ScalarType::kInt32, "1", "1 if the episode starts at a prescribed load, 0 if at a prescribed depth.",
      offsetof(EpisodeRecord, load_driven));
  add("depth", ScalarType::kFloat32, "m", "Depth of the object's lowest point below the undeformed skin in the first frame.",
      offsetof(EpisodeRecord, depth));
  add("load_reached", ScalarType::kInt32, "1", "0 if the skin could not carry the load; the first frame then shows the deepest contact.",
      offsetof(EpisodeRecord, load_reached));
  add("gain", ScalarType::kFloat32, "1", "Factor on the gain of every taxel.", offsetof(EpisodeRecord, gain));
  add("gain_spread", ScalarType::kFloat32, "1", "Standard deviation of the logarithm of a further gain per taxel.",
      offsetof(EpisodeRecord, gain_spread));
  add("noise", ScalarType::kFloat32, "counts", "Standard deviation of the noise added to the sensor's own.",
      offsetof(EpisodeRecord, noise));
  if (scene.kind != Scene::Kind::kServo) return columns;
  add("controller", ScalarType::kInt32, "1", "Index of the controller in the scene, from 0.", offsetof(EpisodeRecord, controller));
  add("exploration_velocity", ScalarType::kFloat32, "m/s", "Exploration velocity, in the controller's exploration direction.",
      offsetof(EpisodeRecord, exploration_velocity));
  add("linear_action_noise", ScalarType::kFloat32, "m/s", "Standard deviation of the noise on each linear velocity.",
      offsetof(EpisodeRecord, linear_action_noise));
  add("angular_action_noise", ScalarType::kFloat32, "rad/s", "Standard deviation of the noise on each angular velocity.",
      offsetof(EpisodeRecord, angular_action_noise));
  return columns;
}

}  // namespace

ColumnPlan planColumns(const Scene& scene) {
  return {frameColumns(scene, groupsOf(scene)), episodeColumns(scene)};
}

OutputOptions outputsOf(const Scene& scene) {
  const std::set<std::string> groups = groupsOf(scene);
  return {.tactile_normal_force = groups.contains("tactile_normal_force"),
          .tactile_shear_force = groups.contains("tactile_shear_force"),
          .penetration_depth = groups.contains("penetration_depth"),
          .contact_features = groups.contains("contact_features"),
          .clean_contact_features = groups.contains("clean_contact_features"),
          .tactile_jacobian = groups.contains("tactile_jacobian"),
          .clean_tactile_jacobian = groups.contains("clean_tactile_jacobian")};
}

std::size_t rowBytes(const Column& column) {
  std::size_t bytes = scalarSize(column.type);
  for (const std::size_t extent : column.shape) bytes *= extent;
  return bytes;
}

std::vector<Column> columnsOf(const Scene& scene) {
  ColumnPlan plan = planColumns(scene);
  std::vector<Column> columns;
  for (FrameColumn& entry : plan.frame) columns.push_back(std::move(entry.column));
  for (EpisodeColumn& entry : plan.episode) columns.push_back(std::move(entry.column));
  return columns;
}

}  // namespace taxelsim
