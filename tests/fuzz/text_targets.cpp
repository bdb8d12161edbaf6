// Targets of YAML, CSV and XML files.
#include <array>
#include <string>

#include "cli/contacts_file.h"
#include "fuzz/input.h"
#include "fuzz/targets.h"
#include "scene/urdf_taxels.h"
#include "taxelsim/experiment.h"
#include "taxelsim/measurement.h"
#include "taxelsim/robot.h"
#include "taxelsim/scene.h"
#include "taxelsim/sensor.h"

namespace taxelsim::fuzz {
namespace {

constexpr int kMaxUrdfTaxels = 1024;
constexpr std::string_view kEndOfYaml = "\n...\n";

// A scene that names other files cannot be read from its canonical text, which has their hashes only.
void readScene(std::string_view input) {
  std::string resolved;
  const auto file = inputFolder().write("scene.yaml", input);
  if (!accepts([&] { resolved = loadScene(file).resolved; }) || resolved.find("sha256: ") != std::string::npos) return;
  require(loadScene(inputFolder().write("resolved.yaml", resolved)).resolved == resolved, "the canonical text is read differently");
}

void readSensor(std::string_view input) {
  std::string text;
  const auto file = inputFolder().write("sensor.yaml", input);
  if (!accepts([&] { text = sensorText(loadSensor(file)); })) return;
  require(sensorText(loadSensor(inputFolder().write("same.yaml", text))) == text, "the text of the sensor is read differently");
}

// The input is the end of a scene: its block `task`.
void readTask(std::string_view input) {
  static const std::string scene =
      "format_version: 1\nname: task\nkind: servo\nsensor: sensors/wts0614_soft_cover.yaml\n"
      "objects:\n  - {mesh: objects/edge_bar.obj, edge: [0, 1, 0]}\n"
      "episode: {num_steps: 1000, simulation_rate: 100}\nrandomization: {load: 1}\n"
      "controller: {tactile_servo: {total_force: {kp: 2}}}\n";
  const auto file = inputFolder().write("task.yaml", scene + std::string(input));
  accepts([&] { loadScene(file); });
}

void readExperiment(std::string_view input) {
  const auto file = inputFolder().write("experiment.yaml", input);
  accepts([&] { loadExperiment(file); });
}

// The input is a measurement file, the end of a YAML document, and the table that the file names as table.csv.
void readMeasurement(std::string_view input) {
  const std::size_t end = input.find(kEndOfYaml);
  const bool has_table = end != std::string_view::npos;
  inputFolder().write("table.csv", has_table ? input.substr(end + kEndOfYaml.size()) : "");
  const auto file = inputFolder().write("measurement.yaml", input.substr(0, has_table ? end + 1 : end));
  accepts([&] { loadMeasurement(file); });
}

void readUrdf(std::string_view input) {
  const auto file = inputFolder().write("robot.urdf", input);
  accepts([&] { loadUrdf(file, {.base_link = "", .sensors = {{.link = "palm"}}}); });
  accepts([&] { loadUrdfTaxels(file, "pad", kMaxUrdfTaxels); });
}

void readContacts(std::string_view input) {
  const auto file = inputFolder().write("contacts.csv", input);
  accepts([&] { cli::readContacts(file); });
}

// The input is the file of a scene of recorded contact points.
void readRecording(std::string_view input) {
  static const std::string scene =
      "format_version: 1\nname: recording\nkind: contact_points\nsensor: sensors/wts0614_soft_cover.yaml\n"
      "contact_points: {file: recording.csv}\nepisode: {num_steps: 100}\n";
  inputFolder().write("recording.csv", input);
  const auto file = inputFolder().write("recording.yaml", scene);
  accepts([&] { loadScene(file); });
}

void readWaypoints(std::string_view input) {
  const auto file = inputFolder().write("waypoints.csv", input);
  accepts([&] { loadWaypoints(file); });
}

void readContour(std::string_view input) {
  const auto file = inputFolder().write("contour.csv", input);
  accepts([&] { loadContour(file); });
}

}  // namespace

std::span<const Target> textTargets() {
  static constexpr std::array kTargets{
      Target{"scene", readScene},           Target{"sensor", readSensor},           Target{"task", readTask},
      Target{"experiment", readExperiment}, Target{"measurement", readMeasurement}, Target{"urdf", readUrdf},
      Target{"contacts", readContacts},     Target{"recording", readRecording},     Target{"waypoints", readWaypoints},
      Target{"contour", readContour}};
  return kTargets;
}

}  // namespace taxelsim::fuzz
