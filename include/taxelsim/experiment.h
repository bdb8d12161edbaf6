// The experiments of the paper. Static (section V.A): indenters pressed on a sensor by dead weights, the images of several sensor models
// beside those of one that they are judged by. Dynamic (sections V.B and V.C): a robot turns the sensor until an edge lies as it should.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "taxelsim/control.h"
#include "taxelsim/pose.h"
#include "taxelsim/scene.h"
#include "taxelsim/sensor.h"

namespace taxelsim {

class Device;

struct StaticExperiment {
  struct Entry {
    Sensor sensor;
    bool fitted = false;  // normal_contact_stiffness and the width of a Gaussian PSF are sought so that its images come closest to the
                          // reference's; law winkler on grids only
  };

  std::string name;
  Sensor reference;  // its images are the ground truth
  std::vector<Entry> sensors;
  std::vector<SceneObject> objects;
  std::vector<double> yaw;    // rad, about z of S
  std::vector<double> loads;  // N
};

// Reads an experiment (docs/file_formats.md). Throws Error(kInput) with file, line, column and key.
StaticExperiment loadStaticExperiment(const std::filesystem::path& file);

// How far an image is from the reference's. Of the taxels that carry more than a count's worth of force in either.
struct ImageDistance {
  double median_difference = 0;  // median |I - R| over these taxels, as a fraction of the reference's full scale (M1)
  double relative_l1 = 0;        // sum |I - R| / sum |R| over all taxels (M4)
};

struct StaticImages {
  std::string name;                        // of the sensor; a fitted one's ends in "_fitted"
  Sensor sensor;                           // as used: of a fitted one with what was found
  double fitted_sigma = 0;                 // taxels; of a fitted one
  std::vector<std::vector<float>> images;  // (num_contacts x num_taxels), N: tactile_normal_force
  std::vector<ImageDistance> distances;    // (num_contacts); of the reference all 0
};

// Contacts are numbered (object x yaw + yaw number) x loads + load number.
struct StaticResult {
  StaticImages reference;
  std::vector<StaticImages> sensors;
};

// Each object is turned, laid with its lowest point over the sensor's origin and pressed with the load. A sensor of law proximity, which
// carries none, is pressed as deep as the reference was and its images are scaled to the load. Submits and waits. Throws Error(kInput)
// where a load is out of reach.
StaticResult runStaticExperiment(const Device& device, const StaticExperiment& experiment);

// Medians over all contacts of one load (its number), each measure by itself.
ImageDistance medianDistance(const StaticExperiment& experiment, const StaticImages& images, std::size_t load);

// The distance of one image from another of the same length. `least` (N): a count's worth; `full_scale`, N.
ImageDistance imageDistance(const std::vector<float>& image, const std::vector<float>& reference, double least, double full_scale);

// One episode of a scene, beside what theory says of it.
struct ServoRun {
  // Which theory the angle's error e is held against, of a controller that holds the edge angle alone, by kp alone.
  enum class Theory {
    kNone,
    kClosedForm,      // of the exact angle: e decays by z = 1 - kp T per control period T, one period late by z^2 = z - kp T
    kCharacteristic,  // of a measured angle: e goes on by -kp T f(e), with f as the sensor reads an object that is laid down at angle e
  };

  std::string name;
  std::string group;  // runs of one group share a panel of the figures
  Scene scene;        // of kind servo, with one object and one controller; its episode 0 is played
  Theory theory = Theory::kNone;
};

// Gains around the one from which on the loop diverges. The controller holds the exact edge angle by kp alone.
struct ServoSweep {
  std::string name;
  Scene scene;                // as a run's
  std::vector<double> gains;  // (num_gains): kp times the control period, > 0, ascending
};

struct ServoExperiment {
  std::string name;
  double band = 0.02;  // of the first error: within it for good, a quantity has settled
  double steady = 1;   // s at the end of a run: what errors are left is judged there
  std::vector<ServoRun> runs;
  std::vector<ServoSweep> sweeps;
};

// Reads an experiment and its scene (docs/file_formats.md). Throws Error(kInput) with file, line, column and key.
ServoExperiment loadServoExperiment(const std::filesystem::path& file);

// Either kind, as the key `experiment` of the file says.
using Experiment = std::variant<StaticExperiment, ServoExperiment>;
Experiment loadExperiment(const std::filesystem::path& file);

// Everything about an episode, frame by frame, of the robot's first sensor. N = num_frames.
struct ServoTrace {
  std::vector<double> time;                  // (N), s
  std::vector<double> true_angle;            // (N), rad in (-pi/2, pi/2]: the object's edge seen along z of S; NaN without edge
  std::vector<double> edge_angle;            // (N), rad, as the controller's source has it
  std::vector<double> total_force;           // (N), N, clean
  std::vector<Vector3> center_of_pressure;   // (N), m, clean, in S
  std::vector<std::uint32_t> tactile_image;  // (N x num_taxels), counts
  std::vector<Pose> X_WS, X_WO;              // (N); the world is where the sensor was in the first frame
  std::vector<double> joint_positions;       // (N x num_joints), rad or m
  std::vector<std::uint8_t> robot_status;    // (N): what held the robot back on the way to the frame: 1 joint limit, 2 velocity limit,
                                             // 4 singular, 8 lost
};

// How one of the features that the controller holds came to its reference. Errors are value - reference, in the feature's unit; of the
// edge angle by the true one, else by clean features; NaN of a centre without contact, which the steady ones leave out. What began within
// `band` of its largest error came from nowhere: it has no settling time and no overshoot.
struct ServoConvergence {
  ServoFeature feature{};
  std::vector<double> error{};                             // (N)
  double settling_time = 0;                                // s, between frames too; NaN where there is none
  double overshoot = 0;                                    // farthest past the reference, of the first error; NaN where there is none
  double steady_mean = 0, steady_rms = 0, steady_max = 0;  // of the error over the last `steady` seconds; max of its size
};

// How the robot fared.
struct ServoRobotUse {
  double limit_margin = 0;             // rad or m, least distance of a joint from a limit; infinite without joints that have one
  double smallest_singular_value = 0;  // least of the Jacobian's selected rows, m/s and rad/s as they are; NaN of a flying sensor
  double path_length = 0;              // m, that the sensor's origin went in W
  std::array<int, 4> num_frames{};     // with each bit of robot_status
};

// What a sensor reads of an object that is laid down, turned about its contact as the loop turns it: no loop, no motion.
struct StaticCharacteristic {
  std::vector<double> error;     // rad, true angle - reference, ascending in equal steps
  std::vector<double> measured;  // the same of the angle read

  double at(double true_error) const;  // between its points on straight lines
};

struct ServoRunResult {
  ServoTrace trace;
  std::vector<ServoConvergence> convergence;  // of each feature held but tilts, in the order of ServoFeature
  ServoRobotUse robot;
  // Of runs with a theory.
  std::vector<double> expected_error;     // (N), rad, of the true angle; empty without theory
  double expected_settling_time = 0;      // s; NaN where the theory has none
  double largest_deviation = 0;           // rad, of the true angle from what is expected
  StaticCharacteristic characteristic{};  // of Theory::kCharacteristic
};

struct ServoSweepResult {
  std::vector<double> growth, expected_growth;  // (num_gains), of the error per control period: below 1 the loop is stable
  double limit = 0;                             // the gain at which growth passes 1, between gains on straight lines; NaN where it does not
  double expected_limit = 0;
};

struct ServoResult {
  std::vector<ServoRunResult> runs;      // as in the experiment
  std::vector<ServoSweepResult> sweeps;  // as in the experiment
};

// Plays all runs and sweeps. Submits and waits. Throws Error(kInput) where a scene cannot be played or its load is out of reach.
ServoResult runServoExperiment(const Device& device, const ServoExperiment& experiment);

}  // namespace taxelsim
