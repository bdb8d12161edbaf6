/// @file
/// A scene: everything that determines a data set, read from YAML and checked. Not a running simulation.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "taxelsim/contact_recording.h"
#include "taxelsim/control.h"
#include "taxelsim/dataset.h"
#include "taxelsim/grasp.h"
#include "taxelsim/object.h"
#include "taxelsim/robot.h"
#include "taxelsim/sensor.h"
#include "taxelsim/task.h"
#include "taxelsim/trajectory.h"

namespace taxelsim {

/// Uniform distribution on [min, max]; a constant if min == max.
struct Range {
  double min = 0;  ///< Lowest value.
  double max = 0;  ///< Highest value.
};

/// An object of a scene.
struct SceneObject {
  Object object;                       ///< Geometry.
  double weight = 1;                   ///< Relative frequency, >= 0; not all zero. Default 1.
  Quaternion orientation{1, 0, 0, 0};  ///< R_WO before the random yaw and tilt: selects the side that faces the sensor.
  std::optional<Motion> motion = {};   ///< Motion from the initial pose. Default: at rest.
  std::optional<Vector3> edge = {};    ///< Unit direction in O of the edge, the reference of the true edge angle. Default: none.
  /// Closed polyline in O, m, at least 3 points: an edge around the object. The true edge angle is that of the part next to the sensor.
  /// Excludes `edge`. Default: none.
  std::vector<Vector3> contour = {};
  /// m, in O: the point that is placed on the skin. Default: the lowest point. With a contour it is a random point of the contour, and the
  /// yaw is relative to the contour there.
  std::optional<Vector3> anchor = {};
  Pose pose = {};  ///< X_WO at the start; scenes of kind grasp only. Default: the identity.
};

/// A controller of a scene.
struct SceneController {
  std::string name = "tactile_servo";  ///< Name in data sets and on the command line.
  double weight = 1;                   ///< Relative frequency, >= 0; not all zero. Default 1.
  TactileServo servo = edgeServo();    ///< Parameters.
};

/// Random variables of an episode, functions of (seed, episode) alone.
struct Randomization {
  Range x;                     ///< m, in S: where the object first touches the skin, or where its anchor lies.
  Range y;                     ///< m, the same along y.
  Range yaw;                   ///< rad, about z of S.
  Range tilt;                  ///< rad, >= 0, about a random axis in the xy plane of S.
  std::optional<Range> load;   ///< N, >= 0. Exactly one of `load` and `depth` is set.
  std::optional<Range> depth;  ///< m, >= 0, of the object's lowest point, or its anchor, below the skin.
  Range gain{1, 1};            ///< Factor on every taxel's gain, > 0.
  Range gain_spread{0, 0};     ///< Standard deviation of log gain per taxel, >= 0.
  Range noise{0, 0};           ///< Counts, >= 0, in addition to the sensor's own noise.

  /// @name Skin
  /// Factors of SkinVariation, the same for all sensors of a robot; checkVariation() must accept both limits. Default: as the sensor.
  /// @{
  std::optional<Range> stiffness{};       ///< SkinVariation::stiffness.
  std::optional<Range> friction{};        ///< SkinVariation::friction.
  std::optional<Range> trigger{};         ///< SkinVariation::trigger.
  std::optional<Range> hysteresis{};      ///< SkinVariation::hysteresis.
  std::optional<Range> delay{};           ///< SkinVariation::delay.
  std::optional<Range> psf_width{};       ///< SkinVariation::psf_width.
  std::optional<Range> trigger_spread{};  ///< SkinVariation::trigger_spread.
  /// @}

  /// @name Mounting
  /// Pose X_NS of the sensors in the frame N where the robot believes them: R = Rz(yaw) Ry(pitch) Rx(roll). Default: no error.
  /// @{
  std::optional<Range> mounting_x{};      ///< m, along x of N.
  std::optional<Range> mounting_y{};      ///< m, along y of N.
  std::optional<Range> mounting_yaw{};    ///< rad, about z.
  std::optional<Range> mounting_pitch{};  ///< rad, about y.
  std::optional<Range> mounting_roll{};   ///< rad, about x.
  /// @}

  /// m/s, replaces the controller's exploration velocity; servo scenes only. Default: the controller's.
  std::optional<Range> exploration_velocity{};
  Range linear_action_noise{0, 0};   ///< m/s, >= 0, standard deviation of white noise on commanded linear velocities; servo scenes only.
  Range angular_action_noise{0, 0};  ///< rad/s, >= 0, the same for angular velocities.
};

/// Allowed values of Scene::record, in file order. The last two need a controller.
inline constexpr std::array<std::string_view, 14> kRecordWords = {"tactile_image",
                                                                  "taxel_counts",
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

/// Name of the condition of every scene in which nothing is overridden.
inline constexpr std::string_view kNominalCondition = "nominal";

/// A scene.
struct Scene {
  /// Kind of scene.
  enum class Kind {
    kServo,          ///< Episodes of num_steps frames under a controller.
    kContacts,       ///< Episodes of one frame each: labelled contact images.
    kGrasp,          ///< Episodes of num_steps frames: the fingers of a hand close on all objects of the scene at once.
    kContactPoints,  ///< Episodes of num_steps frames from recorded contact points: no objects, no robot.
  };

  std::filesystem::path file;                      ///< File that it was read from.
  std::string name;                                ///< Name in data sets.
  Kind kind = Kind::kServo;                        ///< Kind of scene.
  Sensor sensor;                                   ///< The sensor; of a kGrasp scene the first of the robot.
  Robot robot;                                     ///< The robot that carries the sensor.
  std::vector<SceneObject> objects;                ///< Objects, at least one; of a kGrasp scene at most kMaxSlots; none of kContactPoints.
  int num_steps = 1;                               ///< Frames per episode; 1 for kContacts.
  double simulation_rate = 100;                    ///< Hz. Default 100.
  double control_rate = 100;                       ///< Hz, an integer fraction of simulation_rate; of kGrasp: of policies. Default 100.
  Randomization randomization;                     ///< Random variables of an episode.
  std::vector<SceneController> controllers{1};     ///< Controllers of a kServo scene, at least one.
  std::optional<Task> task;                        ///< Task of a kServo scene, required by evaluate().
  std::optional<Grasp> grasp;                      ///< Sensors and fingers of a kGrasp scene; none in others.
  std::optional<ContactRecording> contact_points;  ///< Source of a kContactPoints scene; none in others.
  std::vector<std::string> record;                 ///< Recorded outputs: a subset of kRecordWords in the same order.
  int max_regions = 0;                             ///< Regions in recorded contact features, 0 to kMaxRegions; 0 if none are recorded.
  std::uint64_t num_episodes = 1000;               ///< Episodes of the data set. Default 1000.
  std::uint64_t seed = 0;                          ///< Seed of all random numbers. Default 0.
  std::uint64_t episodes_per_shard = 256;          ///< Episodes per file. Default 256.
  int compression = 0;                             ///< gzip level of the data set, 0 (none) to 9. Default 0.
  /// Bytes, kMinChunkBytes to kMaxChunkBytes: largest chunk of a compressed column before compression. Default 256 KiB.
  std::uint64_t chunk_bytes = kDefaultChunkBytes;

  /// Names of the conditions of the file, in its order, without kNominalCondition. Default: none.
  std::vector<std::string> conditions = {};
  std::string condition{kNominalCondition};  ///< The condition that was loaded. Default kNominalCondition.

  /// The scene as canonical YAML with every default, the sensor inlined, and file contents replaced by their SHA-256. The same scene gives
  /// the same text on every machine. Contains everything that determines the bytes of an episode and its shard, so neither batch size nor
  /// threads, nor the number of episodes: a data set can grow.
  std::string resolved;
};

/// Values that override those of the scene file.
struct SceneOverrides {
  std::optional<std::uint64_t> num_episodes{};  ///< Replaces Scene::num_episodes.
  std::optional<std::uint64_t> seed{};          ///< Replaces Scene::seed.
  /// A condition of the scene: its overrides of sensor and randomization. Default: kNominalCondition, or empty: nothing is overridden.
  std::string condition{kNominalCondition};
  /// Refuses a file that is named with a folder: for the scene of a data set, which must not name files elsewhere. Default false.
  bool refuse_folders = false;
};

/// Reads waypoints from a CSV file (docs/reference/scene_file.md). Throws Error(kInput) with file, line, column, the value found and what
/// is allowed.
std::vector<Waypoint> loadWaypoints(const std::filesystem::path& file);

/// Reads a closed polyline (m) from a CSV file (docs/reference/scene_file.md). Throws what loadWaypoints() throws.
std::vector<Vector3> loadContour(const std::filesystem::path& file);

/// Reads and checks a scene and all files that it names. Throws Error(kInput) with file, line, column, key, the value found and what is
/// allowed, or the names of the conditions if there is none of that name. The overrides of all conditions are checked; their sensors must
/// have the taxels of the scene's own.
Scene loadScene(const std::filesystem::path& file, const SceneOverrides& overrides = {});

/// The scene of a data set, Manifest::scene, as text that loadScene() reads. A data set of an earlier version may have the contact law
/// `pasternak`, which was removed: the result has its springs, `winkler`. For reading what was recorded; a simulation would differ.
std::string readableScene(const std::string& recorded);

}  // namespace taxelsim
