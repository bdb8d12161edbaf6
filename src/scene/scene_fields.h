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
    Field<Scene>{"num_steps", &Scene::num_steps, Allowed::within(1, 1'000'000, ""), kRequired},
};
inline constexpr Allowed kRate = Allowed::aboveUpTo(0, 1e6, "Hz");
inline constexpr std::array kSimulationRateFields{Field<Scene>{"simulation_rate", &Scene::simulation_rate, kRate}};
inline constexpr std::array kControlRateFields{Field<Scene>{"control_rate", &Scene::control_rate, kRate}};

inline constexpr std::array kMaxRegionsFields{
    Field<Scene>{"max_regions", &Scene::max_regions, Allowed::within(0, 8, "")},  // kMaxRegions of taxelsim/simulator.h
};
inline constexpr std::array kNumEpisodesFields{
    Field<Scene>{"episodes", &Scene::num_episodes, Allowed::within(1, 0x1p40, "")},
};
inline constexpr std::array kSeedFields{Field<Scene>{"seed", &Scene::seed, Allowed::atLeast(0, "")}};
inline constexpr std::array kDataSetFields{
    Field<Scene>{"episodes_per_shard", &Scene::episodes_per_shard, Allowed::within(1, 1'000'000, "")},  // a shard is held in memory
    Field<Scene>{"compression", &Scene::compression, Allowed::within(0, 9, "")},
    Field<Scene>{"chunk_bytes", &Scene::chunk_bytes, Allowed::within(kMinChunkBytes, kMaxChunkBytes, "")},
};

inline constexpr Allowed kContactBand = Allowed::within(0, 1, "m");  // SimulatorOptions::contact_band

inline constexpr std::array kObjectFields{Field<SceneObject>{"weight", &SceneObject::weight, Allowed::atLeast(0, "")}};
inline constexpr std::array kControllerFields{Field<SceneController>{"weight", &SceneController::weight, Allowed::atLeast(0, "")}};

inline constexpr std::array kTaskFields{
    Field<Task>{"hold", &Task::hold, Allowed::above(0, "s")},
    Field<Task>{"laps", &Task::laps, Allowed::within(0, 1000, "")},
    Field<Task>{"travel[_mm]", &Task::travel, Allowed::within(0, 1000, "m")},
};
inline constexpr std::array kGraspTaskFields{
    Field<GraspTask>{"tolerance", &GraspTask::tolerance, Allowed::aboveUpTo(0, 1, "")},
    Field<GraspTask>{"hold", &GraspTask::hold, Allowed::above(0, "s")},
    Field<GraspTask>{"drift[_mm]", &GraspTask::drift, Allowed::aboveUpTo(0, 1, "m")},
};
std::span<const Field<TaskCriterion>> criterionFields(TaskMeasure measure);

// A field of Randomization: a number, or [min, max].
struct RangeField {
  std::string_view key;  // as in Field
  std::variant<Range Randomization::*, std::optional<Range> Randomization::*> member;
  Allowed allowed;  // of both limits

  constexpr std::string_view name() const { return key.substr(0, key.find('[')); }
};
inline constexpr double kMaxOffset = 1;  // m; no sensor is larger
inline constexpr Allowed kSkinFactor = Allowed::within(0, kMaxSkinFactor, "");
inline constexpr Allowed kMountingShift = Allowed::within(-0.02, 0.02, "m");  // more is another sensor
inline constexpr Allowed kMountingAngle = Allowed::within(-std::numbers::pi / 6, std::numbers::pi / 6, "rad");
inline constexpr std::array kRandomizationFields{
    RangeField{"x[_mm]", &Randomization::x, Allowed::within(-kMaxOffset, kMaxOffset, "m")},
    RangeField{"y[_mm]", &Randomization::y, Allowed::within(-kMaxOffset, kMaxOffset, "m")},
    RangeField{"yaw[_deg]", &Randomization::yaw, Allowed::within(-2 * std::numbers::pi, 2 * std::numbers::pi, "rad")},
    RangeField{"tilt[_deg]", &Randomization::tilt, Allowed::within(0, std::numbers::pi / 2, "rad")},
    RangeField{"depth[_mm]", &Randomization::depth, Allowed::within(0, kMaxOffset, "m")},
    RangeField{"load", &Randomization::load, Allowed::within(0, 1e6, "N")},
    RangeField{"gain", &Randomization::gain, Allowed::aboveUpTo(0, 1e3, "")},
    RangeField{"gain_spread", &Randomization::gain_spread, Allowed::within(0, 2, "")},
    RangeField{"noise", &Randomization::noise, Allowed::within(0, 65535, "counts")},
    RangeField{"stiffness", &Randomization::stiffness, Allowed::within(kMinStiffnessFactor, kMaxSkinFactor, "")},
    RangeField{"friction", &Randomization::friction, kSkinFactor},
    RangeField{"trigger", &Randomization::trigger, kSkinFactor},
    RangeField{"hysteresis", &Randomization::hysteresis, kSkinFactor},
    RangeField{"delay", &Randomization::delay, kSkinFactor},
    RangeField{"psf_width", &Randomization::psf_width, kSkinFactor},
    RangeField{"trigger_spread", &Randomization::trigger_spread, Allowed::within(0, kMaxGainSpread, "")},
    RangeField{"mounting_x[_mm]", &Randomization::mounting_x, kMountingShift},
    RangeField{"mounting_y[_mm]", &Randomization::mounting_y, kMountingShift},
    RangeField{"mounting_yaw[_deg]", &Randomization::mounting_yaw, kMountingAngle},
    RangeField{"mounting_pitch[_deg]", &Randomization::mounting_pitch, kMountingAngle},
    RangeField{"mounting_roll[_deg]", &Randomization::mounting_roll, kMountingAngle},
};
// Servo scenes only.
inline constexpr std::array kServoRandomizationFields{
    RangeField{"exploration_velocity[_mm]", &Randomization::exploration_velocity, Allowed::any("m/s")},
    RangeField{"linear_action_noise[_mm]", &Randomization::linear_action_noise, Allowed::atLeast(0, "m/s")},
    RangeField{"angular_action_noise[_deg]", &Randomization::angular_action_noise, Allowed::atLeast(0, "rad/s")},
};
// The field of kRandomizationFields with that name, which must exist.
const RangeField& randomizationField(std::string_view name);

inline constexpr std::array kServoExperimentFields{
    Field<ServoExperiment>{"band", &ServoExperiment::band, Allowed::aboveUpTo(0, 1, "")},
    Field<ServoExperiment>{"steady", &ServoExperiment::steady, Allowed::above(0, "s")},
};

}  // namespace taxelsim
