#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>

#include "base/constants.h"
#include "base/field_checks.h"
#include "base/vector3.h"
#include "control/singularity.h"
#include "episodes/batch.h"
#include "experiments/felt_angle.h"
#include "experiments/servo_theory.h"
#include "experiments/trace_sink.h"
#include "scene/scene_checks.h"
#include "scene/scene_fields.h"
#include "taxelsim/error.h"
#include "taxelsim/experiment.h"

namespace taxelsim {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr int kCharacteristicSteps = 360;  // steps per right angle: a quarter of a degree each

double lineError(double angle, double reference) {
  return std::remainder(angle - reference, kPi);
}

double angleReference(const TactileServo& servo) {
  return servo[ServoFeature::kEdgeAngle].reference.value_or(0);
}

struct Episode {
  ServoTrace trace;
  double start_force = 0;  // N: default reference of a force loop
};

Episode simulate(const Model& model, const Scene& scene) {
  const SlicePlan plan(scene, kNoOutputs);
  TraceSink sink(scene);
  std::vector<std::unique_ptr<Slice>> slices;
  slices.push_back(std::make_unique<Slice>(model, plan, 1, sink));
  runEpisodes(model.device(), slices, nullptr, [](const Slice::Stats&) {});
  if (sink.record().load_reached == 0) {
    throw Error(ErrorKind::kInput, scene.file.generic_string() + ": " + std::to_string(sink.record().load) + " N on " +
                                       scene.objects.front().object.name + " is out of reach");
  }
  return {std::move(sink.trace()), sink.record().start_force};
}

std::vector<double> angleErrors(const Scene& scene, const ServoTrace& trace) {
  const double reference = angleReference(scene.controllers.front().servo);
  std::vector<double> errors;
  for (std::size_t n = 0; n < trace.time.size(); ++n) {
    errors.push_back(lineError(std::isnan(trace.true_angle[n]) ? trace.edge_angle[n] : trace.true_angle[n], reference));
  }
  return errors;
}

// Value - reference of one feature in every frame.
std::vector<double> errorsOf(const Scene& scene, const Episode& episode, ServoFeature feature) {
  if (feature == ServoFeature::kEdgeAngle) return angleErrors(scene, episode.trace);
  const TactileServo& servo = scene.controllers.front().servo;
  const Vector3 middle = arrayMiddle(scene.sensor);
  const auto otherwise = feature == ServoFeature::kTotalForce ? episode.start_force
                         : feature == ServoFeature::kCenterX  ? middle[0]
                         : feature == ServoFeature::kCenterY  ? middle[1]
                                                              : 0;
  const double reference = servo[feature].reference.value_or(otherwise);
  const std::vector<double> angles = angleErrors(scene, episode.trace);
  std::vector<double> errors;
  for (std::size_t n = 0; n < episode.trace.time.size(); ++n) {
    const Vector3& center = episode.trace.center_of_pressure[n];
    const double along = angleReference(servo) + angles[n];
    const double across = (center[1] - middle[1]) * std::cos(along) - (center[0] - middle[0]) * std::sin(along);
    const double value = feature == ServoFeature::kTotalForce ? episode.trace.total_force[n]
                         : feature == ServoFeature::kCenterX  ? center[0]
                         : feature == ServoFeature::kCenterY  ? center[1]
                                                              : across;
    const bool known = feature == ServoFeature::kTotalForce || episode.trace.total_force[n] > 0;
    errors.push_back(known ? value - reference : kNaN);
  }
  return errors;
}

ServoConvergence convergenceOf(ServoFeature feature, std::vector<double> errors, double dt, double band, double steady) {
  ServoConvergence result{.feature = feature};
  const double start = errors.front();
  double largest = 0;
  for (const double error : errors) {
    largest = std::max(largest, std::abs(error));
    result.overshoot = std::max(result.overshoot, -error / start);
  }
  // Settling and overshoot are undefined for an error that starts near 0.
  const bool began_away = std::abs(start) > band * largest;
  result.settling_time = began_away ? settlingTime(errors, dt, band) : kNaN;
  if (!began_away) result.overshoot = kNaN;
  const auto num_steady = std::clamp<std::size_t>(static_cast<std::size_t>(std::lround(steady / dt)), 1, errors.size());
  double sum = 0, squares = 0, count = 0;
  for (std::size_t n = errors.size() - num_steady; n < errors.size(); ++n) {
    if (std::isnan(errors[n])) continue;
    ++count;
    sum += errors[n];
    squares += errors[n] * errors[n];
    result.steady_max = std::max(result.steady_max, std::abs(errors[n]));
  }
  result.steady_mean = sum / count;
  result.steady_rms = std::sqrt(squares / count);
  if (count == 0) result.steady_max = kNaN;
  result.error = std::move(errors);
  return result;
}

ServoRobotUse robotUse(const Scene& scene, const ServoTrace& trace) {
  ServoRobotUse use{.limit_margin = kInfinity, .smallest_singular_value = kNaN};
  for (std::size_t n = 0; n < trace.time.size(); ++n) {
    if (n > 0) use.path_length += length(subtract(trace.X_WS[n].position, trace.X_WS[n - 1].position));
    for (std::size_t bit = 0; bit < use.num_frames.size(); ++bit) use.num_frames[bit] += trace.robot_status[n] >> bit & 1;
  }
  const auto* manipulator = std::get_if<Manipulator>(&scene.robot);
  if (manipulator == nullptr) return use;
  const std::size_t num_joints = manipulator->joints.size();
  use.smallest_singular_value = kInfinity;
  for (std::size_t n = 0; n < trace.time.size(); ++n) {
    const std::span<const double> q = std::span(trace.joint_positions).subspan(n * num_joints, num_joints);
    use.smallest_singular_value = std::min(use.smallest_singular_value, smallestSingularValue(*manipulator, q));
    for (std::size_t j = 0; j < num_joints; ++j) {
      const Joint& joint = manipulator->joints[j];
      use.limit_margin = std::min({use.limit_margin, q[j] - joint.lower, joint.upper - q[j]});
    }
  }
  return use;
}

// Static characteristic: the edge angle read with the object of the first frame at rest, rotated about its contact.
StaticCharacteristic characteristicOf(const Model& model, const Scene& scene, const ServoTrace& trace) {
  const TactileServo& servo = scene.controllers.front().servo;
  const double reference = angleReference(servo), start = lineError(trace.true_angle.front(), reference);
  const Pose X_SO = inverse(trace.X_WS.front()) * trace.X_WO.front();
  const Vector3 center = trace.center_of_pressure.front();
  const Pose about{center, {1, 0, 0, 0}}, back{scale(-1, center), {1, 0, 0, 0}};

  StaticCharacteristic result;
  std::vector<Pose> poses;
  for (int k = -kCharacteristicSteps; k <= kCharacteristicSteps; ++k) {
    result.error.push_back(k * (kPi / 2) / kCharacteristicSteps);
    poses.push_back(about * Pose{{0, 0, 0}, axisAngle({0, 0, 1}, result.error.back() - start)} * back * X_SO);
  }
  const std::vector<int> ids(poses.size(), 0);
  const SlicePlan plan(scene, kNoOutputs);
  SimulatorOptions options = plan.simulatorOptions(1);
  options.num_instances = static_cast<int>(poses.size());
  Simulator simulator(model, options);
  simulator.setObjects(ids, poses);
  simulator.step(plan.dt);
  const FrameView view = simulator.read();
  for (std::size_t i = 0; i < poses.size(); ++i) result.measured.push_back(lineError(feltAngle(servo, view, i).value_or(0), reference));
  return result;
}

AngleLoop angleLoop(const Scene& scene, double start_error) {
  const auto* manipulator = std::get_if<Manipulator>(&scene.robot);
  return {.gain = scene.controllers.front().servo[ServoFeature::kEdgeAngle].kp,
          .dt = 1 / scene.simulation_rate,
          .period = static_cast<int>(std::lround(scene.simulation_rate / scene.control_rate)),
          .delay = manipulator == nullptr ? 0 : manipulator->drive.delay,
          .start_error = start_error};
}

ServoRunResult runOne(const Model& model, const ServoExperiment& experiment, const ServoRun& run) {
  const Scene& scene = run.scene;
  Episode episode = simulate(model, scene);
  ServoRunResult result;
  const double dt = 1 / scene.simulation_rate;
  for (int f = 0; f <= static_cast<int>(ServoFeature::kEdgeAngle); ++f) {
    const auto feature = static_cast<ServoFeature>(f);
    if (!scene.controllers.front().servo[feature].selected) continue;
    result.convergence.push_back(convergenceOf(feature, errorsOf(scene, episode, feature), dt, experiment.band, experiment.steady));
  }
  result.robot = robotUse(scene, episode.trace);
  if (run.theory != ServoRun::Theory::kNone) {
    const AngleLoop loop = angleLoop(scene, result.convergence.back().error.front());
    const int num_frames = static_cast<int>(episode.trace.time.size());
    if (run.theory == ServoRun::Theory::kCharacteristic) {
      result.characteristic = characteristicOf(model, scene, episode.trace);
      result.expected_error = expectedErrors(loop, num_frames, [&](double error) { return result.characteristic.at(error); });
      result.expected_settling_time = settlingTime(result.expected_error, dt, experiment.band);
    } else {
      result.expected_error = expectedErrors(loop, num_frames, [](double error) { return error; });
      result.expected_settling_time = closedFormSettlingTime(loop, experiment.band);
    }
    const std::vector<double>& errors = result.convergence.back().error;
    for (std::size_t n = 0; n < errors.size(); ++n) {
      result.largest_deviation = std::max(result.largest_deviation, std::abs(errors[n] - result.expected_error[n]));
    }
  }
  result.trace = std::move(episode.trace);
  return result;
}

// Gain at which the growth crosses 1 for the last time.
double limitOf(const std::vector<double>& gains, const std::vector<double>& growth) {
  for (std::size_t k = gains.size(); k > 1; --k) {
    const double below = growth[k - 2], above = growth[k - 1];
    if (below < 1 && above >= 1) return gains[k - 2] + (1 - below) / (above - below) * (gains[k - 1] - gains[k - 2]);
  }
  return kNaN;
}

ServoSweepResult sweepOne(const Model& model, const ServoSweep& sweep) {
  ServoSweepResult result;
  Scene scene = sweep.scene;
  const AngleLoop loop = angleLoop(scene, 0);
  const bool late = loop.delay > 0;
  for (const double gain : sweep.gains) {
    scene.controllers.front().servo[ServoFeature::kEdgeAngle].kp = gain / (loop.dt * loop.period);
    const std::vector<double> errors = angleErrors(scene, simulate(model, scene).trace);
    std::vector<double> by_period;
    for (std::size_t n = 0; n < errors.size(); n += static_cast<std::size_t>(loop.period)) by_period.push_back(errors[n]);
    result.growth.push_back(measuredGrowth(by_period));
    result.expected_growth.push_back(closedFormGrowth(gain, late));
  }
  result.limit = limitOf(sweep.gains, result.growth);
  result.expected_limit = late ? 1 : 2;
  return result;
}

// For experiments that were not read by loadServoExperiment().
void checkRun(const std::string& name, const Scene& scene, bool has_theory) {
  checkScene(scene);
  if (scene.kind != Scene::Kind::kServo || scene.objects.size() != 1 || scene.controllers.size() != 1) {
    throw Error(ErrorKind::kInput, name + ": a scene of kind servo with " + std::to_string(scene.objects.size()) + " objects and " +
                                       std::to_string(scene.controllers.size()) + " controllers is not allowed: 1 of each");
  }
  if (has_theory && !(scene.objects[0].edge && scene.controllers[0].servo[ServoFeature::kEdgeAngle].selected)) {
    throw Error(ErrorKind::kInput, name + ": theory needs an object with an edge and a controller of edge_angle");
  }
}

}  // namespace

double StaticCharacteristic::at(double true_error) const {
  const double step = error[1] - error[0];
  const double place = std::clamp((true_error - error.front()) / step, 0.0, static_cast<double>(error.size() - 1));
  const std::size_t k = std::min(static_cast<std::size_t>(place), error.size() - 2);
  const double part = place - static_cast<double>(k);
  return measured[k] + part * (measured[k + 1] - measured[k]);
}

ServoResult runServoExperiment(const Device& device, const ServoExperiment& experiment) {
  checkFields("", kServoExperimentFields, experiment);
  for (const ServoRun& run : experiment.runs) checkRun(run.name, run.scene, run.theory != ServoRun::Theory::kNone);
  for (const ServoSweep& sweep : experiment.sweeps) checkRun(sweep.name, sweep.scene, true);
  ServoResult result;
  for (const ServoRun& run : experiment.runs) result.runs.push_back(runOne(Model(device, modelOptionsOf(run.scene)), experiment, run));
  for (const ServoSweep& sweep : experiment.sweeps) {
    result.sweeps.push_back(sweepOne(Model(device, modelOptionsOf(sweep.scene)), sweep));
  }
  return result;
}

}  // namespace taxelsim
