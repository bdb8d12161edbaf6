#include "generation/grasp_columns.h"

#include <array>
#include <cstring>
#include <string>

#include "episodes/draw.h"
#include "generation/recorder.h"

namespace taxelsim {
namespace {

constexpr std::size_t kPoseNumbers = 7;

template <typename T>
void writeAt(std::byte* column, std::uint64_t index, T value) {
  std::memcpy(column + index * sizeof value, &value, sizeof value);
}

void writePoses(std::byte* column, std::uint64_t row, std::span<const Pose> poses) {
  std::uint64_t at = row * poses.size() * kPoseNumbers;
  for (const Pose& pose : poses) {
    for (const double value : pose.position) writeAt(column, at++, value);
    for (const double value : pose.rotation) writeAt(column, at++, value);
  }
}

std::string objectNames(const Scene& scene) {
  std::string names;
  for (const SceneObject& object : scene.objects) names += (names.empty() ? "" : ", ") + object.object.name;
  return names;
}

std::string jointNames(const Manipulator& robot) {
  std::string names;
  for (const Joint& joint : robot.joints) names += (names.empty() ? "" : ", ") + joint.name;
  return names;
}

// Columns of the readout's variation, by sensor.
struct VariationColumn {
  const char *name, *unit, *text;
  float ReadoutVariation::*member;
};
constexpr std::array kVariationColumns{
    VariationColumn{"gain", "1", "Factor on the gain of every taxel", &ReadoutVariation::gain},
    VariationColumn{"gain_spread", "1", "Standard deviation of the logarithm of a further gain per taxel", &ReadoutVariation::gain_spread},
    VariationColumn{"noise", "counts", "Standard deviation of the noise added to the sensor's own", &ReadoutVariation::noise}};

bool variesReadout(const Randomization& random) {
  const auto is = [](const Range& range, double value) { return range.min == value && range.max == value; };
  return !(is(random.gain, 1) && is(random.gain_spread, 0) && is(random.noise, 0));
}

std::string fingerNames(const Grasp& grasp) {
  std::string names;
  for (const GraspFinger& finger : grasp.fingers)
    names += (names.empty() ? "" : ", ") + grasp.sensors[static_cast<std::size_t>(finger.sensor)].name;
  return names;
}

}  // namespace

std::string sensorNames(const Grasp& grasp) {
  std::string names;
  for (const RobotSensor& sensor : grasp.sensors) names += (names.empty() ? "" : ", ") + sensor.name;
  return names;
}

ColumnPlan planSensorColumns(const Scene& scene, const RobotSensor& sensor) {
  Scene alone;
  alone.file = scene.file;
  alone.kind = Scene::Kind::kContacts;
  alone.sensor = sensor.sensor;
  alone.record = scene.record;
  alone.max_regions = numRegions(scene);
  ColumnPlan plan = planColumns(alone);
  std::erase_if(plan.frame, [](const FrameColumn& entry) {
    return entry.source != FrameColumn::Source::kImage && entry.source != FrameColumn::Source::kFeature;
  });
  plan.episode.clear();
  return plan;
}

std::vector<Column> graspColumns(const Scene& scene) {
  const auto& robot = std::get<Manipulator>(scene.robot);
  const std::size_t num_joints = robot.joints.size();
  std::vector<Column> columns;
  const auto add = [&](const std::string& name, std::vector<std::size_t> shape, const char* unit, std::string description) {
    columns.push_back({"data/" + name, ScalarType::kFloat64, std::move(shape), unit, std::move(description), false});
  };
  add("time", {}, "s", "Time since the episode's first frame.");
  add("robot/joint_position", {num_joints}, "rad or m", "Positions of the joints " + jointNames(robot) + ".");
  add("robot/joint_velocity", {num_joints}, "rad/s or m/s", "Velocities of the joints on the way to this frame.");
  add("object_pose", {scene.objects.size(), kPoseNumbers}, "1",
      "Poses of the objects " + objectNames(scene) + " in the world frame: x, y, z in m, then the quaternion w, x, y, z.");
  for (const RobotSensor& sensor : scene.grasp->sensors) {
    add(sensor.name + "/sensor_pose", {kPoseNumbers}, "1",
        "Pose of the sensor in the world frame: x, y, z in m, then the quaternion w, x, y, z.");
    for (FrameColumn& entry : planSensorColumns(scene, sensor).frame) {
      entry.column.name.insert(std::string_view("data/").size(), sensor.name + "/");
      columns.push_back(std::move(entry.column));
    }
  }
  columns.push_back({"meta/episode",
                     ScalarType::kUint64,
                     {},
                     "1",
                     "Number of the episode; with the seed it keys all random numbers of the episode.",
                     true});
  columns.push_back({"meta/target_force",
                     ScalarType::kFloat64,
                     {scene.grasp->fingers.size()},
                     "N",
                     "Force that each finger holds, by its sensor: " + fingerNames(*scene.grasp) + ".",
                     true});
  if (!variesReadout(scene.randomization)) return columns;
  for (const VariationColumn& variation : kVariationColumns) {
    columns.push_back({std::string("meta/") + variation.name,
                       ScalarType::kFloat32,
                       {scene.grasp->sensors.size()},
                       variation.unit,
                       std::string(variation.text) + ", by sensor: " + sensorNames(*scene.grasp) + ".",
                       true});
  }
  return columns;
}

GraspRecorder::GraspRecorder(const Scene& scene) : scene_(scene) {
  for (const RobotSensor& sensor : scene.grasp->sensors) sensors_.push_back(planSensorColumns(scene, sensor));
}

void GraspRecorder::recordFrames(const GraspBatch& batch, int count, std::span<std::byte* const> columns,
                                 std::span<const std::uint64_t> rows) const {
  const SensedRobots& robots = batch.robots();
  const std::size_t num_objects = scene_.objects.size();
  const auto num_joints = static_cast<std::size_t>(robots.robots().numJoints());
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
    writeAt(columns[0], rows[i], batch.time());
    for (std::size_t j = 0; j < num_joints; ++j) {
      writeAt(columns[1], rows[i] * num_joints + j, robots.robots().jointPositions()[i * num_joints + j]);
      writeAt(columns[2], rows[i] * num_joints + j, robots.robots().jointVelocities()[i * num_joints + j]);
    }
    writePoses(columns[3], rows[i], batch.X_WO().subspan(i * num_objects, num_objects));
  }
  std::size_t column = 4;
  for (std::size_t s = 0; s < sensors_.size(); ++s) {
    const int sensor = static_cast<int>(s);
    std::vector<FramePlace> places(robots.numRows(sensor));
    for (int i = 0; i < count; ++i) {
      const auto instance = static_cast<std::size_t>(i);
      writePoses(columns[column], rows[instance], robots.robots().X_WS().subspan(instance * sensors_.size() + s, 1));
      places[robots.row(sensor, i)] = {.columns = columns.data() + column + 1, .row = rows[instance], .object = 0};
    }
    Recorder(sensors_[s], {}).recordFrames(robots.frame(sensor), {}, places);
    column += 1 + sensors_[s].frame.size();
  }
}

void GraspRecorder::recordEpisodes(const GraspBatch& batch, std::span<const std::uint64_t> episodes, std::span<std::byte* const> columns,
                                   std::uint64_t first_row) const {
  const std::size_t num_fingers = scene_.grasp->fingers.size(), num_sensors = scene_.grasp->sensors.size();
  const std::size_t num_variations = variesReadout(scene_.randomization) ? kVariationColumns.size() : 0;
  const std::span<std::byte* const> last = columns.last(2 + num_variations);
  for (std::size_t i = 0; i < episodes.size(); ++i) {
    writeAt(last[0], first_row + i, episodes[i]);
    for (std::size_t f = 0; f < num_fingers; ++f) {
      writeAt(last[1], (first_row + i) * num_fingers + f, batch.targetForces()[i * num_fingers + f]);
    }
    for (std::size_t v = 0; v < num_variations; ++v) {
      for (std::size_t s = 0; s < num_sensors; ++s)
        writeAt(last[2 + v], (first_row + i) * num_sensors + s, batch.variations()[i * num_sensors + s].*kVariationColumns[v].member);
    }
  }
}

}  // namespace taxelsim
