// Tables of fields (base/field.h) of the settings of scenes and experiments.
#pragma once

#include <array>
#include <numbers>
#include <optional>
#include <span>
#include <string_view>
#include <variant>

#include "base/field.h"
#include "taxelsim/experiment.h"
#include "taxelsim/scene.h"
#include "taxelsim/skin_variation.h"

namespace taxelsim {

inline constexpr std::array kNumStepsFields{
    Field<Scene>{"num_steps", &Scene::num_steps, Allowed::within(1, 1'000'000, ""), kRequired, "Frames of an episode; 1 of kind contacts"},
};
inline constexpr Allowed kRate = Allowed::aboveUpTo(0, 1e6, "Hz");
inline constexpr std::array kSimulationRateFields{
    Field<Scene>{"simulation_rate", &Scene::simulation_rate, kRate, kOptional, "Frames per second"}};
inline constexpr std::array kControlRateFields{
    Field<Scene>{"control_rate", &Scene::control_rate, kRate, kOptional,
                 "Commands per second: simulation_rate, its default, divided by a whole number"}};

inline constexpr std::array kMaxRegionsFields{
    Field<Scene>{"max_regions", &Scene::max_regions, Allowed::within(0, 8, ""), kOptional,
                 "Rows for regions of connected taxels, where contact features are recorded"},  // kMaxRegions of taxelsim/simulator.h
};
inline constexpr std::array kNumEpisodesFields{
    Field<Scene>{"episodes", &Scene::num_episodes, Allowed::within(1, 0x1p40, ""), kOptional,
                 "Episodes of the data set; --episodes overrides it"},
};
inline constexpr std::array kSeedFields{
    Field<Scene>{"seed", &Scene::seed, Allowed::atLeast(0, ""), kOptional, "Seed of all random numbers; --seed overrides it"}};
inline constexpr std::array kDataSetFields{
    Field<Scene>{"episodes_per_shard", &Scene::episodes_per_shard, Allowed::within(1, 1'000'000, ""), kOptional,
                 "Episodes per file"},  // a shard is held in memory
    Field<Scene>{"compression", &Scene::compression, Allowed::within(0, 9, ""), kOptional, "Level of gzip, 0 for none"},
    Field<Scene>{"chunk_bytes", &Scene::chunk_bytes, Allowed::within(kMinChunkBytes, kMaxChunkBytes, ""), kOptional,
                 "Largest chunk of a compressed column before compression, in bytes; a chunk has at least one row"},
};

inline constexpr Allowed kContactBand = Allowed::within(0, 1, "m");  // SimulatorOptions::contact_band
inline constexpr std::array kContactBandFields{
    Field<ContactRecording>{"contact_band[_mm]", &ContactRecording::contact_band, kContactBand, kOptional,
                            "Height over the undeformed skin up to which points count"},
};

inline constexpr std::array kObjectFields{Field<SceneObject>{"weight", &SceneObject::weight, Allowed::atLeast(0, ""), kOptional,
                                                             "Relative probability; that of at least one object is above 0"}};
inline constexpr std::array kControllerFields{Field<SceneController>{"weight", &SceneController::weight, Allowed::atLeast(0, ""), kOptional,
                                                                     "Relative probability; that of at least one controller is above 0"}};

inline constexpr std::array kTaskFields{
    Field<Task>{"hold", &Task::hold, Allowed::above(0, "s"), kOptional, "Time at the end of an episode in which every criterion must hold"},
    Field<Task>{"laps", &Task::laps, Allowed::within(0, 1000, ""), kOptional, "Laps of the contour, in either direction"},
    Field<Task>{"travel[_mm]", &Task::travel, Allowed::within(0, 1000, "m"), kOptional, "Path length of the origin of S over the object"},
};
inline constexpr std::array kGraspTaskFields{
    Field<GraspTask>{"tolerance", &GraspTask::tolerance, Allowed::aboveUpTo(0, 1, ""), kOptional,
                     "A finger holds while its clean total force is within this fraction of its target"},
    Field<GraspTask>{"hold", &GraspTask::hold, Allowed::above(0, "s"), kOptional,
                     "Time at the end of an episode in which every finger must hold"},
    Field<GraspTask>{
        "drift[_mm]", &GraspTask::drift, Allowed::aboveUpTo(0, 1, "m"), kOptional,
        "Largest distance of the clean centre of pressure from where it was when that time began; by default it is not judged"},
};
inline constexpr std::array kGraspGainFields{
    Field<Grasp>{"gain", &Grasp::gain, Allowed::above(0, "1/s"), kOptional,
                 "The force error of a finger decays by the factor 1 - gain / simulation_rate per frame; at most simulation_rate"},
};
inline constexpr std::array kFingerForceFields{
    Field<GraspFinger>{"force", &GraspFinger::force, Allowed::aboveUpTo(0, 1e6, "N"), kRequired, "Target of the measured total force"},
};
inline constexpr std::array kGraspRandomFields{
    Field<Grasp>{"offset[_mm]", &Grasp::offset, Allowed::within(0, 1, "m"), kOptional,
                 "Each object starts displaced uniformly by up to this along x, y and z of the world"},
    Field<Grasp>{"yaw[_deg]", &Grasp::yaw, Allowed::within(0, std::numbers::pi, "rad"), kOptional,
                 "Largest rotation of each object about the vertical through its origin"},
    Field<Grasp>{"force_spread", &Grasp::force_spread, Allowed::within(0, 1, ""), kOptional,
                 "Targets of an episode are multiplied by a factor within 1 +- this"},
};
std::span<const Field<TaskCriterion>> criterionFields(TaskMeasure measure);

// A field of Randomization: a number, or [min, max].
struct RangeField {
  std::string_view key;  // as in Field
  std::variant<Range Randomization::*, std::optional<Range> Randomization::*> member;
  Allowed allowed;             // of both limits
  std::string_view otherwise;  // default, in words
  std::string_view text;       // meaning, for documentation

  constexpr std::string_view name() const { return key.substr(0, key.find('[')); }

  // Nothing if it is not given.
  std::optional<Range> in(const Randomization& random) const {
    return std::visit([&](auto pointer) { return std::optional<Range>(random.*pointer); }, member);
  }
};
inline constexpr double kMaxOffset = 1;  // m; no sensor is larger
inline constexpr Allowed kSkinFactor = Allowed::within(0, kMaxSkinFactor, "");
inline constexpr Allowed kMountingShift = Allowed::within(-0.02, 0.02, "m");  // more is another sensor
inline constexpr Allowed kMountingAngle = Allowed::within(-std::numbers::pi / 6, std::numbers::pi / 6, "rad");
inline constexpr std::array kRandomizationFields{
    RangeField{"x[_mm]", &Randomization::x, Allowed::within(-kMaxOffset, kMaxOffset, "m"), "0",
               "Position along x of S of the first touch, or of the anchor or contour of the object"},
    RangeField{"y[_mm]", &Randomization::y, Allowed::within(-kMaxOffset, kMaxOffset, "m"), "0", "Position along y of S, the same"},
    RangeField{"yaw[_deg]", &Randomization::yaw, Allowed::within(-2 * std::numbers::pi, 2 * std::numbers::pi, "rad"), "0",
               "Rotation about z of S"},
    RangeField{"tilt[_deg]", &Randomization::tilt, Allowed::within(0, std::numbers::pi / 2, "rad"), "0",
               "Rotation about a random axis in the plane of the skin"},
    RangeField{"depth[_mm]", &Randomization::depth, Allowed::within(0, kMaxOffset, "m"), "",
               "Depth of the lowest point, anchor or contour of the object below the skin, instead of a load"},
    RangeField{"load", &Randomization::load, Allowed::within(0, 1e6, "N"), "",
               "Normal force on the object, whose depth the device finds; or depth"},
    RangeField{"gain", &Randomization::gain, Allowed::aboveUpTo(0, 1e3, ""), "1", "Factor on the gain of every taxel"},
    RangeField{"gain_spread", &Randomization::gain_spread, Allowed::within(0, 2, ""), "0",
               "Standard deviation of the logarithm of a further gain per taxel"},
    RangeField{"noise", &Randomization::noise, Allowed::within(0, 65535, "counts"), "0",
               "Standard deviation of noise in addition to the sensor's"},
    RangeField{"stiffness", &Randomization::stiffness, Allowed::within(kMinStiffnessFactor, kMaxSkinFactor, ""), "1",
               "Factor on all moduli of the skin: springs, dampers, tangential springs; laws winkler, mass_spring_damper and lugre"},
    RangeField{"friction", &Randomization::friction, kSkinFactor, "1",
               "Factor on friction_coefficient, or on the shear of lugre; laws winkler with friction and lugre"},
    RangeField{"trigger", &Randomization::trigger, kSkinFactor, "1",
               "Factor on trigger and taxel_trigger, of which the readout must have one"},
    RangeField{"hysteresis", &Randomization::hysteresis, kSkinFactor, "1",
               "Factor on hysteresis_strength, which the readout must have; the sum stays below 1"},
    RangeField{"delay", &Randomization::delay, kSkinFactor, "1", "Factor on delay, which the readout must have"},
    RangeField{"psf_width", &Randomization::psf_width, kSkinFactor, "1",
               "Factor w on the RMS width of the PSF: a share w^2 of each force is spread, the rest stays on its taxel. At most 1 / sqrt(1 "
               "- g) for a kernel with the share g in its middle, 1 for skin_gaussian"},
    RangeField{"trigger_spread", &Randomization::trigger_spread, Allowed::within(0, kMaxGainSpread, ""), "0",
               "Standard deviation of the logarithm of a further factor on the trigger of each taxel, which the readout must have"},
    RangeField{"mounting_x[_mm]", &Randomization::mounting_x, kMountingShift, "0",
               "Position along x of the sensors in the frame N in which the robot believes them"},
    RangeField{"mounting_y[_mm]", &Randomization::mounting_y, kMountingShift, "0", "Position along y of N"},
    RangeField{"mounting_yaw[_deg]", &Randomization::mounting_yaw, kMountingAngle, "0", "Rotation about z of N; R_NS = Rz Ry Rx"},
    RangeField{"mounting_pitch[_deg]", &Randomization::mounting_pitch, kMountingAngle, "0", "Rotation about y of N"},
    RangeField{"mounting_roll[_deg]", &Randomization::mounting_roll, kMountingAngle, "0", "Rotation about x of N"},
};
// Servo scenes only.
inline constexpr std::array kServoRandomizationFields{
    RangeField{"exploration_velocity[_mm]", &Randomization::exploration_velocity, Allowed::any("m/s"), "the controller's",
               "Exploration velocity"},
    RangeField{"linear_action_noise[_mm]", &Randomization::linear_action_noise, Allowed::atLeast(0, "m/s"), "0",
               "Standard deviation of white noise on each linear velocity of the commanded twist, new in every control period"},
    RangeField{"angular_action_noise[_deg]", &Randomization::angular_action_noise, Allowed::atLeast(0, "rad/s"), "0",
               "Standard deviation of white noise on each angular velocity of the commanded twist, new in every control period"},
};
// The field of kRandomizationFields with that name, which must exist.
const RangeField& randomizationField(std::string_view name);

inline constexpr std::array kServoExperimentFields{
    Field<ServoExperiment>{"band", &ServoExperiment::band, Allowed::aboveUpTo(0, 1, ""), kOptional,
                           "Fraction of the initial error within which a feature has settled"},
    Field<ServoExperiment>{"steady", &ServoExperiment::steady, Allowed::above(0, "s"), kOptional,
                           "End of a run over which the steady-state error is computed"},
};

}  // namespace taxelsim
