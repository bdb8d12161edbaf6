/// @file
/// The paper's experiments. Static (section V.A): indenters on a sensor under dead weights; images of several sensor models are compared
/// with those of a reference model. Dynamic (sections V.B and V.C): a robot servos the sensor until the edge reaches a reference angle.
/// Calibration (section III): a pin presses single taxels.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <variant>
#include <vector>

#include "taxelsim/control.h"
#include "taxelsim/measurement.h"
#include "taxelsim/pose.h"
#include "taxelsim/scene.h"
#include "taxelsim/sensor.h"

namespace taxelsim {

class Device;

/// A static experiment.
struct StaticExperiment {
  /// A sensor model that is compared with the reference.
  struct Entry {
    Sensor sensor;  ///< The model.
    /// Whether to fit normal_contact_stiffness and the width of a Gaussian PSF to the images of the reference, of every second indenter
    /// from the first on; grids with law winkler only.
    bool fitted = false;
  };

  std::string name;                  ///< Name in reports.
  Sensor reference;                  ///< Model whose images are the ground truth.
  std::vector<Entry> sensors;        ///< Models to compare.
  std::vector<SceneObject> objects;  ///< Indenters.
  std::vector<double> yaw;           ///< rad, rotations of each indenter about z of S.
  std::vector<double> loads;         ///< N, dead weights.
};

/// Reads a static experiment (docs/reference/experiment_file.md). Throws Error(kInput) with file, line, column and key.
StaticExperiment loadStaticExperiment(const std::filesystem::path& file);

/// Distance of an image I from the reference's R. Active taxels are those with a force above one count in either image.
struct ImageDistance {
  double median_difference = 0;  ///< M1: median of `|I - R|` over the active taxels, as a fraction of the reference's full scale.
  double relative_l1 = 0;        ///< M4: sum of `|I - R|` / sum of `|R|`, over all taxels.
};

/// Images of one sensor model.
struct StaticImages {
  std::string name;                        ///< Name of the sensor; that of a fitted one ends in "_fitted".
  Sensor sensor;                           ///< The sensor that was simulated, with fitted parameters.
  double fitted_sigma = 0;                 ///< Taxels, width of the fitted PSF; 0 if not fitted.
  std::vector<std::vector<float>> images;  ///< (num_contacts x num_taxels), N: tactile_normal_force.
  std::vector<ImageDistance> distances;    ///< (num_contacts), to the reference; 0 for the reference itself.
};

/// Result of a static experiment. Number of a contact: (object number x number of yaws + yaw number) x number of loads + load number.
struct StaticResult {
  StaticImages reference;               ///< Images of the reference.
  std::vector<StaticImages> sensors;    ///< Images of the other models.
  std::vector<StaticImages> baselines;  ///< What a model must beat: an image without any force, and the load in equal parts on all taxels.
};

/// Whether an indenter counts in medianDistance(): each without a fitted sensor; with one, those that no fit has seen.
bool isScored(const StaticExperiment& experiment, std::size_t object);

/// Runs a static experiment. Submits and waits.
///
/// Each object is rotated, placed with its lowest point over the sensor's origin, and pressed with the load. A sensor with law proximity
/// cannot carry a load: it is pressed as deep as the reference, and its images are scaled to the load. Throws Error(kInput) if a load is
/// out of reach.
StaticResult runStaticExperiment(const Device& device, const StaticExperiment& experiment);

/// Medians over the contacts of scored indenters under one load, separately for each metric. `load`: index into StaticExperiment::loads.
ImageDistance medianDistance(const StaticExperiment& experiment, const StaticImages& images, std::size_t load);

/// Distance between two images of the same length. `least` (N): force of one count. `full_scale`: N.
ImageDistance imageDistance(const std::vector<float>& image, const std::vector<float>& reference, double least, double full_scale);

/// One episode of a scene, compared with theory.
struct ServoRun {
  /// Theory of the error e of the edge angle, for a controller that regulates the edge angle alone, by kp alone. T is the control period.
  enum class Theory {
    kNone,        ///< No theory.
    kClosedForm,  ///< For the exact angle: e decays by z = 1 - kp T per period; with a delay of one period, z^2 = z - kp T.
    /// For a measured angle: e changes by -kp T f(e) per period. f is the angle that the sensor reads of an object at rest at angle e.
    kCharacteristic,
  };

  std::string name;               ///< Name in reports.
  std::string group;              ///< Runs of one group share a panel of the figures.
  Scene scene;                    ///< Servo scene with one object and one controller; its episode 0 is run.
  Theory theory = Theory::kNone;  ///< Theory to compare with. Default kNone.
};

/// Gains around the stability limit. The controller regulates the exact edge angle by kp alone.
struct ServoSweep {
  std::string name;           ///< Name in reports.
  Scene scene;                ///< As ServoRun::scene.
  std::vector<double> gains;  ///< (num_gains), kp times the control period, > 0, ascending.
};

/// A dynamic experiment.
struct ServoExperiment {
  std::string name;                ///< Name in reports.
  double band = 0.02;              ///< Settling band, as a fraction of the first error. Default 0.02.
  double steady = 1;               ///< s, window at the end of a run for the steady errors. Default 1.
  std::vector<ServoRun> runs;      ///< Episodes.
  std::vector<ServoSweep> sweeps;  ///< Gain sweeps.
};

/// Reads a dynamic experiment and its scene (docs/reference/experiment_file.md). Throws Error(kInput) with file, line, column and key.
ServoExperiment loadServoExperiment(const std::filesystem::path& file);

/// A calibration with a flat pin, normal to the skin: counts against force in the middles of taxels (figure 5b), force against depth at
/// several places of one taxel (figure 6b).
struct CalibrationExperiment {
  /// A measured force at a depth.
  struct DepthForce {
    double depth = 0;  ///< m, one of `depths`.
    double force = 0;  ///< N, > 0.
  };
  /// A measured output of a taxel.
  struct ForceCounts {
    double force = 0;   ///< N, one of `loads`.
    double counts = 0;  ///< Counts, >= 0.
  };

  std::string name;                          ///< Name in reports.
  std::vector<Sensor> sensors;               ///< Models to compare: one level grid each, with a law that carries loads.
  double pin_radius = 0;                     ///< m, > 0.
  std::vector<int> taxels;                   ///< Indices of taxels that are pressed in their middles; the first also at all places.
  int places = 7;                            ///< Places along each side of the first taxel, odd: middles of equal cells. Default 7.
  std::vector<double> depths;                ///< m, > 0, ascending, at most the thickness of each sensor's skin.
  std::vector<double> loads;                 ///< N, > 0, ascending.
  std::vector<DepthForce> measured_forces;   ///< What a real sensor carried. May be empty.
  std::vector<ForceCounts> measured_counts;  ///< What a real sensor read. May be empty.

  /// Number of places on the first taxel.
  std::size_t numPlaces() const { return static_cast<std::size_t>(places) * static_cast<std::size_t>(places); }
};

/// Reads a calibration (docs/reference/experiment_file.md). Throws Error(kInput) with file, line, column and key.
CalibrationExperiment loadCalibrationExperiment(const std::filesystem::path& file);

/// Recordings of a real sensor, which crossValidate() predicts from each other.
struct CharacterizationExperiment {
  std::string name;                       ///< Name in reports.
  std::string missing;                    ///< One line that says where the recordings were looked for; empty if they are there.
  std::string skipped;                    ///< One line that names recordings whose tables are not there; empty if all are.
  double light_below = 0;                 ///< N, loads below are scored apart; 0: all together.
  bool separate = false;                  ///< Whether each recording is of a sensor of its own.
  std::vector<Measurement> measurements;  ///< The recordings that are there.
};

/// Fingers that close with several gains, in the same episode.
struct GraspExperiment {
  std::string name;           ///< Name in reports.
  Scene scene;                ///< Of kind grasp; its episode 0 is run.
  std::vector<double> gains;  ///< 1/s, each > 0 to the simulation rate.
};

/// Reads an experiment with a grasp and its scene (docs/reference/experiment_file.md). Throws Error(kInput) with file, line, column and
/// key.
GraspExperiment loadGraspExperiment(const std::filesystem::path& file);

/// An experiment of any kind.
using Experiment = std::variant<StaticExperiment, ServoExperiment, CalibrationExperiment, CharacterizationExperiment, GraspExperiment>;

/// Reads an experiment of the kind that the file's key `experiment` names. Throws Error(kInput) with file, line, column and key.
Experiment loadExperiment(const std::filesystem::path& file);

/// Curves of one sensor in a calibration. The middle of the first taxel is place num_places / 2. A load that the skin carries at no depth
/// gives NaN.
struct CalibrationCurves {
  std::string name;            ///< Name of the sensor.
  std::vector<double> forces;  ///< (num_depths x num_places), N.
  std::vector<double> counts;  ///< (num_loads x num_taxels), of the pressed taxel.
  std::vector<double> shares;  ///< (num_loads x num_taxels), part of the load that the pressed taxel reads, before readout; 0 to 1.
};

/// Runs a calibration: one entry per sensor. Each press is the first step of an unloaded sensor at rest. Submits and waits.
std::vector<CalibrationCurves> runCalibrationExperiment(const Device& device, const CalibrationExperiment& experiment);

/// Time series of one episode, of the robot's first sensor. N = num_frames.
struct ServoTrace {
  std::vector<double> time;                  ///< (N), s.
  std::vector<double> true_angle;            ///< (N), rad in (-pi/2, pi/2], the object's edge seen along z of S; NaN without an edge.
  std::vector<double> edge_angle;            ///< (N), rad, as the controller's source reports it.
  std::vector<double> total_force;           ///< (N), N, clean.
  std::vector<Vector3> center_of_pressure;   ///< (N), m, clean, in S.
  std::vector<std::uint32_t> tactile_image;  ///< (N x num_taxels), counts.
  std::vector<Pose> X_WS;                    ///< (N), pose of the sensor; W is S in the first frame.
  std::vector<Pose> X_WO;                    ///< (N), pose of the object.
  std::vector<double> joint_positions;       ///< (N x num_joints), rad or m.
  /// (N), limits that the robot met on its way to the frame, as bits: 1 joint limit, 2 velocity limit, 4 singular, 8 lost.
  std::vector<std::uint8_t> robot_status;
};

/// Convergence of one regulated feature. Errors are value - reference in the feature's unit.
///
/// The error of the edge angle is that of the true angle; all others are of clean features. The error of a centre is NaN without contact;
/// the steady errors skip such frames. A feature whose first error is within `band` of its largest error has no settling time and no
/// overshoot.
struct ServoConvergence {
  ServoFeature feature{};       ///< The feature.
  std::vector<double> error{};  ///< (N).
  double settling_time = 0;     ///< s, interpolated between frames; NaN if undefined.
  double overshoot = 0;         ///< Largest error past the reference, as a fraction of the first error; NaN if undefined.
  double steady_mean = 0;       ///< Mean error over the last ServoExperiment::steady seconds.
  double steady_rms = 0;        ///< Root mean square error over that window.
  double steady_max = 0;        ///< Largest absolute error over that window.
};

/// How close the robot came to its limits.
struct ServoRobotUse {
  double limit_margin = 0;             ///< rad or m, smallest distance of a joint from a limit; infinite without limits.
  double smallest_singular_value = 0;  ///< Smallest over the run, of the selected Jacobian rows in m/s and rad/s; NaN if free-flying.
  double path_length = 0;              ///< m, path of the sensor's origin in W.
  std::array<int, 4> num_frames{};     ///< Frames with each bit of ServoTrace::robot_status.
};

/// Static characteristic of the measured angle: an object at rest, rotated about its contact as the loop would rotate it.
struct StaticCharacteristic {
  std::vector<double> error;     ///< rad, true angle - reference, ascending in equal steps.
  std::vector<double> measured;  ///< rad, measured angle - reference.

  /// Measured error at a true error (rad), interpolated linearly.
  double at(double true_error) const;
};

/// Result of one ServoRun.
struct ServoRunResult {
  ServoTrace trace;                           ///< Time series.
  std::vector<ServoConvergence> convergence;  ///< One entry per regulated feature except tilts, in the order of ServoFeature.
  ServoRobotUse robot;                        ///< Use of the robot's limits.
  std::vector<double> expected_error;         ///< (N), rad, error of the true angle in theory; empty without theory.
  double expected_settling_time = 0;          ///< s, in theory; NaN if undefined.
  double largest_deviation = 0;               ///< rad, largest difference of the true angle from theory.
  StaticCharacteristic characteristic{};      ///< Filled for Theory::kCharacteristic.
};

/// Result of one ServoSweep.
struct ServoSweepResult {
  std::vector<double> growth;           ///< (num_gains), factor of the error per control period; stable below 1.
  std::vector<double> expected_growth;  ///< (num_gains), the same in theory.
  double limit = 0;                     ///< Gain at which growth passes 1, interpolated linearly; NaN if it does not.
  double expected_limit = 0;            ///< The same in theory.
};

/// Result of a dynamic experiment.
struct ServoResult {
  std::vector<ServoRunResult> runs;      ///< In the order of ServoExperiment::runs.
  std::vector<ServoSweepResult> sweeps;  ///< In the order of ServoExperiment::sweeps.
};

/// A finger in one run. Errors are clean total force - target.
struct GraspFingerTrace {
  std::string name;           ///< Name of the finger's sensor.
  double target = 0;          ///< N.
  std::vector<double> force;  ///< (num_frames), N, clean.
  double first_contact = 0;   ///< s, first frame in contact; NaN without contact.
  double settling_time = 0;   ///< s until the error stays within GraspTask::tolerance to the end; NaN if it does not.
  double overshoot = 0;       ///< Largest force over the target, as a fraction of the target; 0 if it is not exceeded.
  double steady_rms = 0;      ///< N, root mean square error over the last GraspTask::hold seconds.
  /// Factor of the error per frame while it falls from a half to a tenth of the target, mean of its logarithm; NaN if that takes less than
  /// two frames or a frame is not in contact.
  double decay = 0;
};

/// A run with one gain.
struct GraspRun {
  double gain = 0;            ///< 1/s.
  double expected_decay = 0;  ///< In theory, for a contact of constant stiffness: 1 - gain / simulation_rate (taxelsim/grasp.h).
  std::vector<double> time;   ///< (num_frames), s.
  std::vector<GraspFingerTrace> fingers;  ///< In the order of Grasp::fingers.
};

/// Runs episode 0 with each gain. Submits and waits. Throws Error(kInput) if the scene cannot be run or is not of kind grasp, and for a
/// gain out of range.
std::vector<GraspRun> runGraspExperiment(const Device& device, const GraspExperiment& experiment);

/// Runs all episodes and sweeps. Submits and waits. Throws Error(kInput) if a scene cannot be run or its load is out of reach.
ServoResult runServoExperiment(const Device& device, const ServoExperiment& experiment);

}  // namespace taxelsim
