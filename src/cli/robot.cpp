// `taxelsim robot FILE`: prints the joints of a robot file and the places and directions of its sensors, and draws the robot.
#include <spdlog/fmt/fmt.h>
#include <spdlog/fmt/ranges.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <memory>
#include <nlohmann/json.hpp>
#include <numbers>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "base/log.h"
#include "cli/commands.h"
#include "cli/print.h"
#include "cli/robot_closing.h"
#include "figures/robot_view.h"
#include "figures/text.h"
#include "scene/robot_file.h"
#include "taxelsim/error.h"
#include "taxelsim/scene.h"

namespace taxelsim::cli {

using namespace figures;

namespace {

struct RobotArguments {
  std::string file, png{};
  std::vector<std::string> joints{};  // NAME=POSITION
  bool closed = false, json = false;
};

// Degrees of a radian, millimetres of a metre.
double factorOf(const Joint& joint) {
  return joint.type == JointType::kRevolute ? 180 / std::numbers::pi : 1000;
}

const char* unitOf(const Joint& joint) {
  return joint.type == JointType::kRevolute ? "deg" : "mm";
}

// Joint positions (num_joints), rad or m: the initial ones, changed by `texts`.
std::vector<double> positionsOf(const Manipulator& robot, const std::vector<std::string>& texts) {
  std::vector<double> positions;
  std::vector<std::string> names;
  for (const Joint& joint : robot.joints) {
    positions.push_back(joint.initial_position);
    names.push_back(joint.name);
  }
  for (const std::string& text : texts) {
    const auto refuse = [&](const std::string& allowed) {
      throw Error(ErrorKind::kInput, "--joint: " + text + " is not allowed: " + allowed);
    };
    const std::size_t equals = text.find('=');
    const auto found = std::find(names.begin(), names.end(), text.substr(0, equals));
    if (equals == std::string::npos || found == names.end()) refuse(fmt::format("NAME=POSITION of one of {}", fmt::join(names, ", ")));
    const auto j = static_cast<std::size_t>(found - names.begin());
    const Joint& joint = robot.joints[j];
    double value = 0;
    if (!CLI::detail::lexical_cast(text.substr(equals + 1), value) || !(value / factorOf(joint) >= joint.lower) ||
        !(value / factorOf(joint) <= joint.upper))
      refuse(fmt::format("{:.4g} to {:.4g} {}", joint.lower * factorOf(joint), joint.upper * factorOf(joint), unitOf(joint)));
    positions[j] = value / factorOf(joint);
  }
  return positions;
}

std::vector<std::vector<std::string>> jointRows(const Manipulator& robot, const std::vector<double>& positions) {
  std::vector<std::vector<std::string>> rows{{"joint", "type", "unit", "lower", "upper", "position", "largest velocity, 1/s"}};
  for (std::size_t j = 0; j < robot.joints.size(); ++j) {
    const Joint& joint = robot.joints[j];
    const auto shown = [&](double value) { return fmt::format("{:.4g}", value * factorOf(joint)); };
    rows.push_back({joint.name, joint.type == JointType::kRevolute ? "revolute" : "prismatic", unitOf(joint), shown(joint.lower),
                    shown(joint.upper), shown(positions[j]), shown(joint.max_velocity)});
  }
  return rows;
}

std::string vectorText(const Vector3& values, double factor, int digits) {
  return fmt::format("({:.{}f}, {:.{}f}, {:.{}f})", values[0] * factor + 0.0, digits, values[1] * factor + 0.0, digits,
                     values[2] * factor + 0.0, digits);
}

std::vector<std::vector<std::string>> sensorRows(const Manipulator& robot, const std::vector<PosedSensor>& sensors) {
  std::vector<std::vector<std::string>> rows{{"sensor", "link", "file", "taxels", "place in the world, mm", "faces", "x of its frame"}};
  for (std::size_t s = 0; s < sensors.size(); ++s) {
    const Sensor* sensor = sensors[s].sensor;
    const Quaternion& rotation = sensors[s].X_WS.rotation;
    rows.push_back({sensors[s].name, robot.sensors[s].link, sensor == nullptr ? "-" : sensor->name,
                    sensor == nullptr ? "-" : std::to_string(numTaxels(*sensor)), vectorText(sensors[s].X_WS.position, 1000, 1),
                    vectorText(rotate(rotation, {0, 0, 1}), 1, 2), vectorText(rotate(rotation, {1, 0, 0}), 1, 2)});
  }
  return rows;
}

std::vector<std::vector<std::string>> fingerRows(const std::vector<ClosingFinger>& fingers) {
  std::vector<std::vector<std::string>> rows{
      {"finger", "open at, mm", "closed at, mm", "faces, open", "faces, closed", "nearest object", "distance, mm"}};
  for (const ClosingFinger& finger : fingers) {
    rows.push_back({finger.name, vectorText(finger.open.position, 1000, 1), vectorText(finger.closed.position, 1000, 1),
                    vectorText(rotate(finger.open.rotation, {0, 0, 1}), 1, 2), vectorText(rotate(finger.closed.rotation, {0, 0, 1}), 1, 2),
                    finger.object, fmt::format("{:.1f}", finger.distance * 1000)});
  }
  return rows;
}

std::vector<std::vector<std::string>> pairRows(const std::vector<SensorPair>& pairs) {
  std::vector<std::vector<std::string>> rows{{"sensors", "least distance of taxels, mm", "can touch"}};
  for (const SensorPair& pair : pairs) {
    rows.push_back({pair.first + ", " + pair.second, fmt::format("{:.1f}", pair.distance * 1000), pair.can_touch ? "yes" : "no"});
  }
  return rows;
}

nlohmann::ordered_json asJson(const Pose& pose) {
  return {{"position", pose.position}, {"rotation", pose.rotation}};
}

// Adds fingers and pairs of sensors.
void addClosing(nlohmann::ordered_json& json, const std::vector<ClosingFinger>& fingers, const std::vector<SensorPair>& pairs) {
  for (const ClosingFinger& finger : fingers) {
    json["fingers"].push_back({{"name", finger.name},
                               {"X_WS_open", asJson(finger.open)},
                               {"X_WS_closed", asJson(finger.closed)},
                               {"nearest_object", finger.object},
                               {"distance", finger.distance}});
  }
  json["pairs"] = nlohmann::ordered_json::array();
  for (const SensorPair& pair : pairs)
    json["pairs"].push_back({{"sensors", {pair.first, pair.second}}, {"distance", pair.distance}, {"can_touch", pair.can_touch}});
}

nlohmann::ordered_json asJson(const Manipulator& robot, const std::vector<double>& positions, const std::vector<PosedSensor>& sensors) {
  nlohmann::ordered_json joints = nlohmann::ordered_json::array(), mounts = nlohmann::ordered_json::array();
  for (std::size_t j = 0; j < robot.joints.size(); ++j) {
    const Joint& joint = robot.joints[j];
    joints.push_back({{"name", joint.name},
                      {"type", joint.type == JointType::kRevolute ? "revolute" : "prismatic"},
                      {"lower", joint.lower},
                      {"upper", joint.upper},
                      {"position", positions[j]},
                      {"max_velocity", joint.max_velocity}});
  }
  for (std::size_t s = 0; s < sensors.size(); ++s) {
    mounts.push_back({{"name", sensors[s].name}, {"link", robot.sensors[s].link}, {"X_WS", asJson(sensors[s].X_WS)}});
  }
  return {{"joints", joints}, {"sensors", mounts}};
}

int runRobot(const RobotArguments& arguments) {
  const std::optional<Scene> scene = isSceneFile(arguments.file) ? std::optional(loadScene(arguments.file)) : std::nullopt;
  const auto [any, named, names, urdf, base_link] = loadRobotFile(arguments.file);
  const bool closes = scene && scene->grasp;
  const Manipulator* const robot = std::get_if<Manipulator>(&any);
  if (robot == nullptr) throw Error(ErrorKind::kInput, arguments.file + ": a free-flying sensor has no joints to show");
  const std::vector<double> start = positionsOf(*robot, arguments.joints);
  if (arguments.closed && !closes) throw Error(ErrorKind::kInput, "--closed: " + arguments.file + " is not a scene of kind grasp");
  const std::vector<double> positions = arguments.closed ? closingPositions(*scene, start, closingTime(*scene, start)) : start;
  std::vector<PosedSensor> sensors = posedSensors(*robot, positions, names);
  for (std::size_t s = 0; s < named.size(); ++s) sensors[s].sensor = &named[s].sensor;
  if (!arguments.png.empty()) {
    const std::string text =
        fmt::format("{} joints, {} sensors; green: taxels that face you; red: the way a skin faces", robot->joints.size(), sensors.size());
    drawRobot(sensors, robot->name, text).save(arguments.png);
    logInfo("wrote " + arguments.png);
  }
  const std::vector<ClosingFinger> fingers = closes ? closingFingers(*scene, start) : std::vector<ClosingFinger>();
  const std::vector<SensorPair> pairs = closes ? closingPairs(*scene, start) : std::vector<SensorPair>();
  if (arguments.json) {
    nlohmann::ordered_json json = asJson(*robot, positions, sensors);
    if (closes) addClosing(json, fingers, pairs);
    printJsonText(json);
    return kExitOk;
  }
  printOut("{}\n{}", tableText(jointRows(*robot, positions)), tableText(sensorRows(*robot, sensors)));
  if (closes) printOut("\n{}\n{}", tableText(fingerRows(fingers)), tableText(pairRows(pairs)));
  return kExitOk;
}

}  // namespace

void addRobot(CLI::App& app, Action& action) {
  CLI::App* command = app.add_subcommand("robot", "Show the joints of a robot file, and the places and directions of its sensors");
  command->footer(
      "Example:\n  taxelsim robot scenes/robots/shadow_hand.yaml --joint FFJ3=20 --png hand.png\n"
      "Poses are in the world, at the initial joint positions unless --joint changes them.\n"
      "  taxelsim robot scenes/shadow_grasp.yaml --closed --png closed.png\n"
      "A scene of kind grasp also shows where its fingers are when open and closed, objects near their way, and sensors that can touch.\n"
      "--view serves a page that draws links and taxels in 3-D, with a slider for each joint; it needs `pip install 'taxelsim[play]'`.");
  const auto arguments = std::make_shared<RobotArguments>();
  command->add_option("file", arguments->file, "Robot file, or scene, whose fingers are shown as they close (YAML)")
      ->required()
      ->type_name("FILE");
  command->add_option("--joint", arguments->joints, "Position of a joint, degrees or mm; may be repeated")->type_name("NAME=POSITION");
  command->add_flag("--closed", arguments->closed, "Of a scene of kind grasp: shows the posture with closed fingers");
  command->add_option("--png", arguments->png, "Picture to write (PNG)")->check(requirePngName)->type_name("FILE");
  command->add_flag("--json", arguments->json, "Print JSON, rad and m");
  command->callback([arguments, &action] { action = [arguments] { return runRobot(*arguments); }; });
}

}  // namespace taxelsim::cli
