// A scene: everything a data set is made from, read from YAML and checked. Not a running simulation.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "taxelsim/control.h"
#include "taxelsim/object.h"
#include "taxelsim/robot.h"
#include "taxelsim/sensor.h"
#include "taxelsim/task.h"
#include "taxelsim/trajectory.h"

namespace taxelsim {

// Uniform on [min, max]; min == max is that value.
struct Range {
  double min = 0;
  double max = 0;
};

struct SceneObject {
  Object object;
  double weight = 1;                   // of being chosen, >= 0; not all zero
  Quaternion orientation{1, 0, 0, 0};  // R_WO before the random yaw and tilt: which side looks at the sensor
  std::optional<Motion> motion = {};   // from where it was set down; at rest without
  std::optional<Vector3> edge = {};    // direction in O, of length 1, of what the true edge angle is of
  // A closed line of points in O, m, at least 3: the edge that runs around the object; the true edge angle is of the part next to the
  // sensor. Instead of `edge`.
  std::vector<Vector3> contour = {};
  // The point in O that is set down, m; without one the lowest point. With a contour it is a random point of that, and the yaw is that of
  // the contour there.
  std::optional<Vector3> anchor = {};
};

struct SceneController {
  std::string name = "tactile_servo";
  double weight = 1;  // of being chosen for an episode, >= 0; not all zero
  TactileServo servo = edgeServo();
};

// What is drawn anew for each episode, from (seed, episode) alone.
struct Randomisation {
  Range x, y;                  // m, in S: where the object first touches the skin, or its anchor lies
  Range yaw;                   // rad, about z of S
  Range tilt;                  // rad, >= 0, about a random axis in the xy plane of S
  std::optional<Range> load;   // N, >= 0; or
  std::optional<Range> depth;  // m, >= 0, of the object's lowest point, or its anchor, below the skin. Exactly one of the two.
  Range gain{1, 1};            // factor, > 0, on every taxel
  Range gain_spread{0, 0};     // standard deviation of log gain per taxel, >= 0
  Range noise{0, 0};           // counts, >= 0, beside the sensor's own
  // Of a servo scene.
  std::optional<Range> exploration_velocity{};  // m/s, instead of the controller's
  // Standard deviations, >= 0, of white noise on every component of the twists that the robot is commanded: m/s, rad/s.
  Range linear_action_noise{0, 0}, angular_action_noise{0, 0};
};

// The words of Scene::record, in their order. The last two need a controller.
inline constexpr std::array<std::string_view, 13> kRecordWords = {"tactile_image",
                                                                  "features",
                                                                  "ground_truth",
                                                                  "tactile_normal_force",
                                                                  "tactile_shear_force",
                                                                  "penetration_depth",
                                                                  "contact_features",
                                                                  "clean_contact_features",
                                                                  "tactile_jacobian",
                                                                  "clean_tactile_jacobian",
                                                                  "poses",
                                                                  "actions",
                                                                  "robot"};

struct Scene {
  enum class Kind {
    kServo,     // episodes of num_steps frames under a controller
    kContacts,  // episodes of one frame each: labelled contact images
  };

  std::filesystem::path file;
  std::string name;
  Kind kind = Kind::kServo;
  Sensor sensor;
  Robot robot;  // what moves the sensor
  std::vector<SceneObject> objects;
  int num_steps = 1;             // frames per episode, 1 for kContacts
  double simulation_rate = 100;  // Hz
  double control_rate = 100;     // Hz, simulation_rate divided by a whole number
  Randomisation randomisation;
  std::vector<SceneController> controllers{1};  // of kServo; at least one
  std::optional<Task> task;                     // of kServo: what `evaluate` judges by
  std::vector<std::string> record;              // what is written: some of kRecordWords, in their order
  int max_regions = 0;                          // rows for connected taxels in recorded contact features, 0 to 8; 0 where none are recorded
  std::uint64_t num_episodes = 1000;
  std::uint64_t seed = 0;
  std::uint64_t episodes_per_shard = 256;
  int compression = 0;  // gzip level of the data set, 0 (none) to 9

  // The scene as YAML with every default written out, the sensor in place and file contents replaced by their SHA-256; the same scene gives
  // the same text on every machine. Episodes, seed, and everything else that decides the data set's bytes is in it; batch size is not.
  std::string resolved;
};

// Values on the command line that stand above the file's.
struct SceneOverrides {
  std::optional<std::uint64_t> num_episodes;
  std::optional<std::uint64_t> seed;
};

// Waypoints from a CSV file (docs/file_formats.md). Throws Error(kInput): file, line, column, the value found and what is allowed.
std::vector<Waypoint> loadWaypoints(const std::filesystem::path& file);

// A closed line from a CSV file (docs/file_formats.md). Throws as loadWaypoints() does.
std::vector<Vector3> loadContour(const std::filesystem::path& file);

// Reads and checks a scene and all files it names. Throws Error(kInput): file, line, column, key, value found, what is allowed.
Scene loadScene(const std::filesystem::path& file, const SceneOverrides& overrides = {});

}  // namespace taxelsim
