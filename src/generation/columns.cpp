#include "generation/columns.h"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <limits>
#include <set>
#include <string>

#include "episodes/draw.h"
#include "generation/grasp_columns.h"
#include "generation/taxel_columns.h"
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
      throw Error(ErrorKind::kInput, scene.file.string() + ": record: \"" + name + "\" is not allowed: one of " + allowed);
    }
    groups.insert(name);
  }
  return groups;
}

constexpr const char* kMeasuredForces = "the measured taxel forces";
constexpr const char* kTrueForces = "the true taxel forces";
constexpr const char* kReadoutForces = "the taxel forces as the readout has them without noise";

// Where the features of one view become columns.
struct FeatureGroup {
  std::string prefix;  // of the column names, below data/
  std::string forces;  // source of the features, for descriptions
  const Sensor& sensor;
  std::vector<std::size_t> rows{};  // (num_rows), or empty for one row
};

// Names of ContactType's values and of the bits of a robot's status.
const std::vector<std::string> kContactTypeNames{"none", "point", "edge", "area"};
const std::vector<std::string> kRobotStatusNames{"joint_limit", "velocity_limit", "singular", "lost"};
const std::vector<std::string> kFlagNames{"false", "true"};

// Smallest type of counts and indices up to `largest`.
ScalarType countType(std::size_t largest) {
  return largest <= std::numeric_limits<std::uint16_t>::max() ? ScalarType::kUint16 : ScalarType::kInt32;
}

// The same with -1.
ScalarType indexType(std::size_t largest) {
  return largest <= static_cast<std::size_t>(std::numeric_limits<std::int16_t>::max()) ? ScalarType::kInt16 : ScalarType::kInt32;
}

// Integer type of a feature: patch is -1 to the number of patches or taxels, counts are at most the number of taxels or iterations.
ScalarType integerType(std::string_view feature, const Sensor& sensor) {
  const auto num_taxels = static_cast<std::size_t>(numTaxels(sensor));
  if (feature == "patch") return indexType(num_taxels);
  return countType(std::max<std::size_t>(num_taxels, kMaxLayerIterations));
}

// Type of a feature's column, and the names of its values.
template <typename Field>
void setType(const Field& field, const Sensor& sensor, Column& column) {
  struct Visitor {
    const Sensor& sensor;
    std::string_view name;
    Column& column;

    void set(std::span<const float>) {}
    void set(std::span<const std::int32_t>) { column.type = integerType(name, sensor); }
    void set(std::span<const bool>) { column.type = ScalarType::kUint8, column.value_names = kFlagNames; }
    void set(std::span<const ContactType>) { column.type = ScalarType::kUint8, column.value_names = kContactTypeNames; }
  };
  Visitor visitor{sensor, field.name, column};
  std::visit([&]<typename T, typename View>(std::span<const T> View::*) { visitor.set(std::span<const T>()); }, field.member);
}

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
    setType(field, group.sensor, columns.back().column);
  }
}

template <typename View>
void addContactFeatures(std::vector<FrameColumn>& columns, const FeatureGroup& group, View view) {
  addFeatures(columns, imageFeatures(), group, view);
  addFeatures(columns, contactFeatures(), group, view);
  addFeatures(columns, regionFeatures(), {group.prefix, group.forces, group.sensor}, view);
}

constexpr std::size_t kTwist = 6;  // coordinates

template <typename View>
void addJacobian(std::vector<FrameColumn>& columns, const FeatureGroup& group, View view) {
  addFeatures(columns, jacobianFeatures(), group, view, kTwist);
}

void addGroundTruth(const Scene& scene, std::vector<FrameColumn>& columns) {
  const FeatureGroup group{"ground_truth/", kTrueForces, scene.sensor};
  const auto truth = [](const FrameView& frame) -> const GroundTruthView& { return frame.ground_truth; };
  addFeatures(columns, imageFeatures(), group, truth);
  const bool has_points = scene.kind == Scene::Kind::kContactPoints;
  const bool is_layer = std::holds_alternative<ElasticLayer>(scene.sensor.skin.law) && !has_points;
  for (const FeatureField<GroundTruthView>& field : truthFeatures()) {
    if (field.recorded == "always" || (field.recorded == "elastic_layer" && is_layer)) {
      addFeatures(columns, std::span(&field, 1), group, truth);
    }
  }
  if (has_points) addOffArrayPoints(columns);
  const bool has_edge = std::any_of(scene.objects.begin(), scene.objects.end(),
                                    [](const SceneObject& object) { return object.edge || !object.contour.empty(); });
  if (!has_edge) return;
  columns.push_back({{"data/ground_truth/exact_edge_angle",
                      ScalarType::kFloat32,
                      {},
                      "rad",
                      "Angle of the object's edge, from its pose, in the xy plane of the sensor frame, in (-pi/2, pi/2]; 0 where "
                      "exact_edge_known is 0.",
                      false},
                     Source::kExactEdge});
  columns.push_back({{"data/ground_truth/exact_edge_known",
                      ScalarType::kUint8,
                      {},
                      "1",
                      "1 if the object has an edge or a contour and its direction has an angle in the xy plane of the sensor frame.",
                      false,
                      0,
                      kFlagNames},
                     Source::kExactEdgeKnown});
}

// Contact features: rows for the sensor, its patches, its regions. Tactile Jacobian: rows for the sensor and its patches.
void addRows(const Scene& scene, const std::set<std::string>& groups, std::vector<FrameColumn>& columns) {
  const auto num_rows = static_cast<std::size_t>(1 + numFeaturePatches(scene.sensor));
  const std::size_t num_contact_rows = num_rows + static_cast<std::size_t>(numRegions(scene));
  if (groups.contains("contact_features")) {
    addContactFeatures(columns, {"contact/", kMeasuredForces, scene.sensor, {num_contact_rows}},
                       [](const FrameView& frame) -> const ContactFeatureView& { return frame.contact; });
  }
  if (groups.contains("clean_contact_features")) {
    addContactFeatures(columns, {"ground_truth/contact/", kTrueForces, scene.sensor, {num_contact_rows}},
                       [](const FrameView& frame) -> const ContactFeatureView& { return frame.ground_truth.contact; });
  }
  if (groups.contains("tactile_jacobian")) {
    addJacobian(columns, {"jacobian/", kReadoutForces, scene.sensor, {num_rows}},
                [](const FrameView& frame) -> const TactileJacobianView& { return frame.jacobian; });
  }
  if (groups.contains("clean_tactile_jacobian")) {
    const auto view = [](const FrameView& frame) -> const CleanTactileJacobianView& { return frame.ground_truth.jacobian; };
    addJacobian(columns, {"ground_truth/jacobian/", kTrueForces, scene.sensor, {num_rows}}, view);
    addFeatures(columns, wrenchJacobian(), {"ground_truth/jacobian/", kTrueForces, scene.sensor}, view, kTwist);
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
  add("status", ScalarType::kUint8, {}, "1",
      "Limits that the robot met before this frame, a sum: 1 a joint at its position limit, 2 too fast a twist or a drive behind its "
      "command, 4 near a singular pose, 8 no finite twist; 0 none.",
      Source::kRobotStatus);
  columns.back().column.bit_names = kRobotStatusNames;
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
  return source == Source::kImage || source == Source::kFeature || source == Source::kExactEdge || source == Source::kExactEdgeKnown ||
         source == Source::kPose || source == Source::kSensorPose;
}

std::vector<FrameColumn> frameColumns(const Scene& scene, const std::set<std::string>& groups) {
  std::vector<FrameColumn> columns;
  columns.push_back({{"data/time", ScalarType::kFloat64, {}, "s", "Time since the episode's first frame.", false}, Source::kTime});
  addMeasuredTaxels(scene.sensor, groups, columns);
  if (groups.contains("features")) {
    const auto frame_itself = [](const FrameView& frame) -> const FrameView& { return frame; };
    addFeatures(columns, imageFeatures(), {"", kMeasuredForces, scene.sensor}, frame_itself);
    addFeatures(columns, readoutFeatures(), {"", kMeasuredForces, scene.sensor}, frame_itself);
  }
  if (groups.contains("ground_truth")) addGroundTruth(scene, columns);
  addTrueTaxels(scene.sensor, groups, columns);
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

template <typename T>
void writeValue(T value, std::byte* row) {
  std::memcpy(row, &value, sizeof value);
}

// Columns of an episode.
class EpisodeColumns {
 public:
  void add(const char* name, const char* unit, const char* description, std::uint64_t EpisodeRecord::*field) {
    add(name, ScalarType::kUint64, unit, description,
        [field](const EpisodeValues& values, std::byte* row) { writeValue(values.record.*field, row); });
  }
  void add(const char* name, const char* unit, const char* description, const std::function<float(const EpisodeRecord&)>& value) {
    add(name, ScalarType::kFloat32, unit, description,
        [value](const EpisodeValues& values, std::byte* row) { writeValue(value(values.record), row); });
  }
  void addFlag(const char* name, const char* description, std::function<bool(const EpisodeValues&)> flag) {
    add(name, ScalarType::kUint8, "1", description, [flag = std::move(flag)](const EpisodeValues& values, std::byte* row) {
      writeValue(static_cast<std::uint8_t>(flag(values)), row);
    });
    columns.back().column.value_names = kFlagNames;
  }
  // Index into `names`, or -1 if `may_be_none`, and the name, which is empty for -1.
  void addChoice(const std::string& name, const char* index_text, const char* name_text, const std::vector<std::string>& names,
                 std::int32_t EpisodeRecord::*field, bool may_be_none) {
    const ScalarType type = may_be_none ? indexType(names.size()) : countType(names.size());
    add(name, type, "1", index_text, [field, type](const EpisodeValues& values, std::byte* row) {
      const std::int32_t index = values.record.*field;
      if (type == ScalarType::kInt32)
        writeValue(index, row);
      else
        writeValue(static_cast<std::int16_t>(index), row);  // the same bytes as uint16
    });
    std::size_t length = 1;
    for (const std::string& choice : names) length = std::max(length, choice.size());
    add(name + "_name", ScalarType::kText, "1", name_text, [field, names, length](const EpisodeValues& values, std::byte* row) {
      const std::int32_t index = values.record.*field;
      std::string text = index < 0 ? "" : names[static_cast<std::size_t>(index)];
      text.resize(length, '\0');
      std::memcpy(row, text.data(), length);
    });
    columns.back().column.text_length = length;
  }

  // The same text in every episode.
  void addText(const char* name, const char* description, const std::string& text) {
    add(name, ScalarType::kText, "1", description,
        [text](const EpisodeValues&, std::byte* row) { std::memcpy(row, text.data(), text.size()); });
    columns.back().column.text_length = text.size();
  }

  std::vector<EpisodeColumn> columns;

 private:
  void add(const std::string& name, ScalarType type, const char* unit, const char* description,
           std::function<void(const EpisodeValues&, std::byte*)> write) {
    columns.push_back({{"meta/" + name, type, {}, unit, description, true}, std::move(write)});
  }
};

// Where the contacts of an episode come from.
void addObjectColumns(const Scene& scene, EpisodeColumns& columns) {
  std::vector<std::string> objects;
  for (const SceneObject& object : scene.objects) objects.push_back(object.object.name);
  columns.addChoice("object", "Index of the object in the scene, from 0.", "Name of the object in the scene.", objects,
                    &EpisodeRecord::object, false);
  columns.add("load", "N", "Normal force prescribed at the start; 0 if load_driven is 0.", &EpisodeRecord::load);
  columns.addFlag("load_driven", "1 if the episode starts at a prescribed load, 0 if at a prescribed depth.",
                  [](const EpisodeValues& values) { return values.record.load_driven != 0; });
  columns.add("depth", "m", "Depth of the object's lowest point below the undeformed skin in the first frame.", &EpisodeRecord::depth);
  columns.addFlag("load_reached", "0 if the skin could not carry the load; the first frame then shows the deepest contact.",
                  [](const EpisodeValues& values) { return values.record.load_reached != 0; });
}

std::vector<EpisodeColumn> episodeColumns(const Scene& scene) {
  EpisodeColumns columns;
  std::vector<std::string> controllers;
  for (const SceneController& controller : scene.controllers) controllers.push_back(controller.name);
  columns.add("episode", "1", "Number of the episode; with the seed it keys all random numbers of the episode.", &EpisodeRecord::episode);
  if (scene.contact_points) {
    columns.addText("contact_points", "Name of the file of contact points.", scene.contact_points->file_name);
    columns.addText("contact_points_sha256", "SHA-256 of the file of contact points.", scene.contact_points->sha256);
  } else {
    addObjectColumns(scene, columns);
  }
  columns.add("gain", "1", "Factor on the gain of every taxel.", &EpisodeRecord::gain);
  columns.add("gain_spread", "1", "Standard deviation of the logarithm of a further gain per taxel.", &EpisodeRecord::gain_spread);
  columns.add("noise", "counts", "Standard deviation of the noise added to the sensor's own.", &EpisodeRecord::noise);
  const auto add_drawn = [&](const auto& table, auto part) {
    for (const auto& entry : table) {
      if (scene.randomization.*entry.range)
        columns.add(entry.name, entry.unit, entry.text,
                    [part, value = entry.value](const EpisodeRecord& record) { return record.*part.*value; });
    }
  };
  add_drawn(kSkinRanges, &EpisodeRecord::skin);
  add_drawn(kMountingRanges, &EpisodeRecord::mounting);
  if (scene.kind != Scene::Kind::kServo) return std::move(columns.columns);
  columns.addChoice("controller", "Index of the controller in the scene, from 0; -1 for a policy.",
                    "Name of the controller in the scene; empty for a policy.", controllers, &EpisodeRecord::controller, true);
  columns.add("exploration_velocity", "m/s", "Exploration velocity, in the controller's exploration direction.",
              &EpisodeRecord::exploration_velocity);
  columns.add("linear_action_noise", "m/s", "Standard deviation of the noise on each linear velocity.",
              &EpisodeRecord::linear_action_noise);
  columns.add("angular_action_noise", "rad/s", "Standard deviation of the noise on each angular velocity.",
              &EpisodeRecord::angular_action_noise);
  if (scene.task)
    columns.addFlag("success", "1 if the episode met the task of the scene.", [](const EpisodeValues& values) { return values.success; });
  return std::move(columns.columns);
}

}  // namespace

std::vector<Column> ColumnPlan::columns() const {
  std::vector<Column> all;
  for (const FrameColumn& entry : frame) all.push_back(entry.column);
  for (const EpisodeColumn& entry : episode) all.push_back(entry.column);
  return all;
}

ColumnPlan planColumns(const Scene& scene) {
  return {frameColumns(scene, groupsOf(scene)), episodeColumns(scene)};
}

OutputOptions outputsOf(const Scene& scene) {
  const std::set<std::string> groups = groupsOf(scene);
  OutputOptions outputs;
  for (const OutputEntry& output : kOutputs) outputs.*output.member = groups.contains(output.name);
  return outputs;
}

std::size_t rowBytes(const Column& column) {
  std::size_t bytes = scalarSize(column);
  for (const std::size_t extent : column.shape) bytes *= extent;
  return bytes;
}

std::vector<Column> columnsOf(const Scene& scene) {
  if (scene.kind == Scene::Kind::kGrasp) return graspColumns(scene);
  return planColumns(scene).columns();
}

}  // namespace taxelsim
