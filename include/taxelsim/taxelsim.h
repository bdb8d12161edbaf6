/// @file
/// All of libtaxelsim in one include: batched simulation of tactile sensing arrays on Vulkan devices.
///
/// Units are SI throughout: m, N, Pa, s, rad. Electrical output is in counts. `X_AB` is the pose of frame B in frame A; S is the frame of a
/// sensor, P of a patch, O of an object, W the world (docs/reference/conventions.md). A shape such as `(N x 3)` behind an array is
/// row-major.
///
/// Errors: bad input, device failures and file system failures throw taxelsim::Error. Wrong use of an object throws std::logic_error.
///
/// Threads:
/// - Device, Model: immutable handles. Several threads may use the same one at once.
/// - Simulator, Environment, DatasetWriter, DatasetReader: one thread at a time. Different objects may be used in different threads at
///   once, also those of one Model. The spans of a FrameView may be read from any thread until the next step() of their simulator.
/// - Trajectory, and all plain structs (Sensor, Scene, Object, ...): several threads may read the same one at once.
/// - Free functions: several threads may call them at once, unless they write the same files. generate(), evaluate() and the experiments
///   block their caller and start threads of their own.
/// - fork(): not while a Device is open.
#pragma once

/// The library libtaxelsim.
namespace taxelsim {}

#include "taxelsim/characterize.h"
#include "taxelsim/compare.h"
#include "taxelsim/contact_misses.h"
#include "taxelsim/contact_point.h"
#include "taxelsim/contact_recording.h"
#include "taxelsim/contact_type.h"
#include "taxelsim/control.h"
#include "taxelsim/cross_validate.h"
#include "taxelsim/dataset.h"
#include "taxelsim/device.h"
#include "taxelsim/environment.h"
#include "taxelsim/error.h"
#include "taxelsim/evaluate.h"
#include "taxelsim/evaluation_part.h"
#include "taxelsim/experiment.h"
#include "taxelsim/generate.h"
#include "taxelsim/grasp_environment.h"
#include "taxelsim/grasp_evaluation.h"
#include "taxelsim/log.h"
#include "taxelsim/measurement.h"
#include "taxelsim/model.h"
#include "taxelsim/object.h"
#include "taxelsim/policy.h"
#include "taxelsim/pose.h"
#include "taxelsim/progress.h"
#include "taxelsim/readings.h"
#include "taxelsim/robot.h"
#include "taxelsim/scene.h"
#include "taxelsim/sensor.h"
#include "taxelsim/sensor_hints.h"
#include "taxelsim/simplification_stop.h"
#include "taxelsim/simulator.h"
#include "taxelsim/skin_variation.h"
#include "taxelsim/stiffness.h"
#include "taxelsim/task.h"
#include "taxelsim/trajectory.h"
#include "taxelsim/verdict.h"
#include "taxelsim/version.h"
