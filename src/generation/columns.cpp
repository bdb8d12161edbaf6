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
using Floats = std::span<const float> (*)(const FrameView&);

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

FrameColumn floats(std::string name, std::vector<std::size_t> shape, std::string unit, std::string description, Floats values) {
  return {{"data/" + std::move(name), ScalarType::kFloat32, std::move(shape), std::move(unit), std::move(description), false},
          Source::kFloats,
          values};
}

// Of features: where they go, what they are from, and how many rows a frame has of them; none where it has but one.
struct FeatureGroup {
  std::string prefix, of;
  std::vector<std::size_t> rows{};

  void add(std::vector<FrameColumn>& columns, const char* name, std::vector<std::size_t> shape, const char* unit,
           const std::string& description, Floats values) const {
    shape.insert(shape.begin(), rows.begin(), rows.end());
    columns.push_back(floats(prefix + name, std::move(shape), unit, description, values));
  }
};

// The features that `view` gives of a frame.
template <auto view>
void addFeatures(std::vector<FrameColumn>& columns, const FeatureGroup& group) {
  const std::string& of = group.of;
  const auto add = [&](const char* name, std::vector<std::size_t> shape, const char* unit, const std::string& description, Floats values) {
    group.add(columns, name, std::move(shape), unit, description, values);
  };
  add("total_force", {}, "N", "Sum of " + of + ".", [](const FrameView& f) { return view(f).total_force; });
  add("peak_force", {}, "N", "Largest of " + of + ".", [](const FrameView& f) { return view(f).peak_force; });
  add("center_of_pressure", {3}, "m", "Mean position in the sensor frame, weighted by " + of + "; 0 without contact.",
      [](const FrameView& f) { return view(f).center_of_pressure; });
  add("second_moments", {3}, "m^2", "Second moments xx, xy, yy of " + of + " about the centre of pressure.",
      [](const FrameView& f) { return view(f).second_moments; });
  add("eigenvalues", {2}, "m^2", "Eigenvalues of the second moments of " + of + ", larger first.",
      [](const FrameView& f) { return view(f).eigenvalues; });
  add("edge_angle", {}, "rad", "Angle of the major axis of " + of + ", in (-pi/2, pi/2]; 0 where undefined.",
      [](const FrameView& f) { return view(f).edge_angle; });
  add("edge_confidence", {}, "1", "Difference of the eigenvalues of " + of + " over their sum, 0 to 1.",
      [](const FrameView& f) { return view(f).edge_confidence; });
  add("contact_area", {}, "m^2", "Area of the taxels above the trigger, from " + of + ".",
      [](const FrameView& f) { return view(f).contact_area; });
}

// Those of the rows of contact features, and what they have beside.
template <auto view>
void addContactFeatures(std::vector<FrameColumn>& columns, const FeatureGroup& group) {
  addFeatures<view>(columns, group);
  const std::string& of = group.of;
  const auto add = [&](const char* name, std::vector<std::size_t> shape, const char* unit, const std::string& description, Floats values) {
    group.add(columns, name, std::move(shape), unit, description, values);
  };
  add("windowed_edge_angle", {}, "rad",
      "Angle of the major axis of " + of + " under a Gaussian window, in (-pi/2, pi/2]; 0 where undefined.",
      [](const FrameView& f) { return view(f).windowed_edge_angle; });
  add("windowed_edge_confidence", {}, "1", "Difference of the eigenvalues under that window over their sum, 0 to 1.",
      [](const FrameView& f) { return view(f).windowed_edge_confidence; });
  add("tilt", {2}, "rad", "How a flat face is turned about x and y of its patch, from " + of + "; 0 where undefined.",
      [](const FrameView& f) { return view(f).tilt; });
  add("tilt_confidence", {}, "1", "How well a flat face explains " + of + " inside the contact, 0 to 1.",
      [](const FrameView& f) { return view(f).tilt_confidence; });
  add("contact_type", {}, "1", "0 none, 1 point, 2 edge, 3 area.", [](const FrameView& f) { return view(f).contact_type; });
  add("patch", {}, "1",
      "Number of the patch, of a list the taxel, in whose plane moments and angles are; -1 the xy plane of the sensor frame.",
      [](const FrameView& f) { return view(f).patch; });
  columns.push_back(floats(group.prefix + "num_regions", {}, "1", "Regions of connected taxels; the largest have rows.",
                           [](const FrameView& f) { return view(f).num_regions; }));
}

// How the features of its rows change with the sensor's twist.
template <auto view>
void addJacobian(std::vector<FrameColumn>& columns, const FeatureGroup& group) {
  const std::string by = " by the sensor's twist, v then w in the sensor frame, from " + group.of;
  const auto add = [&](const char* name, std::vector<std::size_t> shape, const char* unit, const std::string& description, Floats values) {
    group.add(columns, name, std::move(shape), unit, description, values);
  };
  add("center_of_pressure", {3, 6}, "1, m/rad", "Derivative of the centre of pressure" + by + "; 0 without contact.",
      [](const FrameView& f) { return view(f).center_of_pressure; });
  add("total_force", {6}, "N/m, N/rad", "Derivative of the total force" + by + ".", [](const FrameView& f) { return view(f).total_force; });
  add("edge_angle", {6}, "rad/m, 1", "Derivative of the edge angle" + by + "; 0 where undefined.",
      [](const FrameView& f) { return view(f).edge_angle; });
}

const FeatureView& measured(const FrameView& frame) {
  return frame;
}
const FeatureView& clean(const FrameView& frame) {
  return frame.ground_truth;
}
const ContactFeatureView& measuredContact(const FrameView& frame) {
  return frame.contact;
}
const ContactFeatureView& cleanContact(const FrameView& frame) {
  return frame.ground_truth.contact;
}
const TactileJacobianView& measuredJacobian(const FrameView& frame) {
  return frame.jacobian;
}
const TactileJacobianView& cleanJacobian(const FrameView& frame) {
  return frame.ground_truth.jacobian;
}

void addRobot(const Robot& robot, std::vector<FrameColumn>& columns) {
  const auto add = [&](const char* name, ScalarType type, std::vector<std::size_t> shape, const char* unit, const std::string& description,
                       Source source) {
    columns.push_back({{std::string("data/robot/") + name, type, std::move(shape), unit, description, false}, source, nullptr});
  };
  add("status", ScalarType::kInt32, {}, "1",
      "What held the robot back on its way to this frame, a sum: 1 a joint at its position limit, 2 too fast a twist or a drive behind its "
      "command, 4 near a singular pose, 8 no finite twist; 0 nothing.",
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

// Whether every sensor of a robot has such a column's values, and not the robot.
bool isOfSensor(Source source) {
  return source == Source::kImage || source == Source::kFloats || source == Source::kPose || source == Source::kSensorPose;
}

bool hasActionNoise(const Scene& scene) {
  return scene.randomisation.linear_action_noise.max > 0 || scene.randomisation.angular_action_noise.max > 0;
}

std::vector<FrameColumn> frameColumns(const Scene& scene, const std::set<std::string>& groups) {
  std::vector<std::size_t> taxels;
  if (scene.sensor.patches.size() == 1) {
    taxels = {static_cast<std::size_t>(scene.sensor.patches[0].num_rows), static_cast<std::size_t>(scene.sensor.patches[0].num_cols)};
  } else {
    taxels = {static_cast<std::size_t>(numTaxels(scene.sensor))};
  }
  std::vector<std::size_t> taxel_vectors = taxels;
  taxel_vectors.push_back(2);

  std::vector<FrameColumn> columns;
  columns.push_back({{"data/time", ScalarType::kFloat64, {}, "s", "Time since the episode's first frame.", false}, Source::kTime, nullptr});
  if (groups.contains("tactile_image")) {
    columns.push_back(
        {{"data/tactile_image", ScalarType::kUint16, taxels, "counts", "What the sensor reports.", false}, Source::kImage, nullptr});
  }
  if (groups.contains("features")) {
    addFeatures<measured>(columns, {"", "the measured taxel forces"});
    columns.push_back(floats("saturated", {}, "1", "Fraction of the taxels at the upper end of their range.",
                             [](const FrameView& f) { return f.saturated; }));
  }
  if (groups.contains("ground_truth")) {
    addFeatures<clean>(columns, {"ground_truth/", "the true taxel forces"});
    columns.push_back(floats("ground_truth/contact_wrench", {6}, "N, N m",
                             "Force and torque on the sensor at the origin of its frame, in that frame, before the point spread function.",
                             [](const FrameView& f) { return f.ground_truth.contact_wrench; }));
    columns.push_back(floats("ground_truth/over_penetration", {}, "1", "Fraction of the samples at least as deep as the skin is thick.",
                             [](const FrameView& f) { return f.ground_truth.over_penetration; }));
    if (std::holds_alternative<ElasticLayer>(scene.sensor.skin.law)) {
      columns.push_back(floats("ground_truth/off_array_load", {}, "N", "Normal force that the skin's margin carries, beside the taxels.",
                               [](const FrameView& f) { return f.ground_truth.off_array_load; }));
      columns.push_back(floats("ground_truth/contact_residual", {}, "1",
                               "Root mean square of what the displacements of the skin miss, relative to the deepest one.",
                               [](const FrameView& f) { return f.ground_truth.contact_residual; }));
      columns.push_back(floats("ground_truth/contact_iterations", {}, "1", "Iterations of the contact solver.",
                               [](const FrameView& f) { return f.ground_truth.contact_iterations; }));
    }
  }
  if (groups.contains("tactile_normal_force")) {
    columns.push_back(floats("ground_truth/tactile_normal_force", taxels, "N",
                             "Normal force of each taxel after the point spread function, before the readout.",
                             [](const FrameView& f) { return f.ground_truth.tactile_normal_force; }));
  }
  if (groups.contains("tactile_shear_force")) {
    columns.push_back(floats("ground_truth/tactile_shear_force", taxel_vectors, "N",
                             "Shear force of each taxel along its x and y after the point spread function, before the readout.",
                             [](const FrameView& f) { return f.ground_truth.tactile_shear_force; }));
  }
  if (groups.contains("penetration_depth")) {
    columns.push_back(floats("ground_truth/penetration_depth", taxels, "m", "Depth of the object in the skin, mean over each taxel.",
                             [](const FrameView& f) { return f.ground_truth.penetration_depth; }));
  }
  // The sensor, its patches, its regions.
  const std::size_t rows = static_cast<std::size_t>(1 + numFeaturePatches(scene.sensor) + numRegions(scene));
  if (groups.contains("contact_features")) {
    addContactFeatures<measuredContact>(columns, {"contact/", "the measured taxel forces", {rows}});
  }
  if (groups.contains("clean_contact_features")) {
    addContactFeatures<cleanContact>(columns, {"ground_truth/contact/", "the true taxel forces", {rows}});
  }
  const std::size_t jacobian_rows = static_cast<std::size_t>(1 + numFeaturePatches(scene.sensor));
  if (groups.contains("tactile_jacobian")) {
    addJacobian<measuredJacobian>(columns, {"jacobian/", "the taxel forces as the readout has them without noise", {jacobian_rows}});
  }
  if (groups.contains("clean_tactile_jacobian")) {
    addJacobian<cleanJacobian>(columns, {"ground_truth/jacobian/", "the true taxel forces", {jacobian_rows}});
    columns.push_back(floats("ground_truth/jacobian/contact_wrench", {6, 6}, "N/m, N/rad, N, N m/rad",
                             "Derivative of the contact wrench by the sensor's twist, v then w in the sensor frame, of the normal forces.",
                             [](const FrameView& f) { return f.ground_truth.jacobian.contact_wrench; }));
  }
  if (groups.contains("poses")) {
    columns.push_back({{"data/pose",
                        ScalarType::kFloat64,
                        {7},
                        "m, 1",
                        "Pose of the object in the sensor frame: x, y, z, then the quaternion w, x, y, z.",
                        false},
                       Source::kPose,
                       nullptr});
    columns.push_back({{"data/sensor_pose",
                        ScalarType::kFloat64,
                        {7},
                        "m, 1",
                        "Pose of the sensor in the world, where the object rests or goes its way: x, y, z, then the quaternion w, x, y, z.",
                        false},
                       Source::kSensorPose,
                       nullptr});
  }
  if (groups.contains("actions")) {
    const auto add = [&](const char* name, const char* description, Source source) {
      columns.push_back({{name, ScalarType::kFloat32, {6}, "m/s, rad/s", description, false}, source, nullptr});
    };
    add("data/action", "Twist of the sensor frame, in that frame, commanded after this frame: linear, then angular velocity.",
        Source::kAction);
    if (hasActionNoise(scene)) add("data/controller_action", "The same before noise was added.", Source::kControllerAction);
  }
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
  add("episode", ScalarType::kUint64, "1", "Number of the episode, which with the seed decides all that is random in it.",
      offsetof(EpisodeRecord, episode));
  add("object", ScalarType::kInt32, "1", "Which object of the scene, counted from 0.", offsetof(EpisodeRecord, object));
  add("load", ScalarType::kFloat32, "N", "Normal force asked for at the start; 0 where load_driven is 0.", offsetof(EpisodeRecord, load));
  add("load_driven", ScalarType::kInt32, "1", "1 when the episode began with a given load, 0 when with a given depth.",
      offsetof(EpisodeRecord, load_driven));
  add("depth", ScalarType::kFloat32, "m", "Depth of the object's lowest point below the undeformed skin in the first frame.",
      offsetof(EpisodeRecord, depth));
  add("load_reached", ScalarType::kInt32, "1", "0 when the skin could not carry the load, and the first frame shows the deepest contact.",
      offsetof(EpisodeRecord, load_reached));
  add("gain", ScalarType::kFloat32, "1", "Factor on the gain of every taxel.", offsetof(EpisodeRecord, gain));
  add("gain_spread", ScalarType::kFloat32, "1", "Standard deviation of the logarithm of a further gain per taxel.",
      offsetof(EpisodeRecord, gain_spread));
  add("noise", ScalarType::kFloat32, "counts", "Standard deviation of the noise beside the sensor's own.", offsetof(EpisodeRecord, noise));
  if (scene.kind != Scene::Kind::kServo) return columns;
  add("controller", ScalarType::kInt32, "1", "Which controller of the scene, counted from 0.", offsetof(EpisodeRecord, controller));
  add("exploration_velocity", ScalarType::kFloat32, "m/s", "Velocity of the exploration, in the direction that the controller has for it.",
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
