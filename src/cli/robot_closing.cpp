#include "cli/robot_closing.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/vector3.h"
#include "episodes/clearance.h"
#include "figures/robot_view.h"

namespace taxelsim::cli {
namespace {

constexpr int kNumTimes = 33;  // postures on the way, with the open and the closed one

const Manipulator& robotOf(const Scene& scene) {
  return std::get<Manipulator>(scene.robot);
}

// s, until a joint has reached its limit, or has turned once.
double timeOf(const FingerJoint& moved, const Joint& joint, double start) {
  const double limit = moved.velocity > 0 ? joint.upper : joint.lower;
  const double way = std::isfinite(limit) ? std::abs(limit - start) : 2 * std::numbers::pi;
  return way / std::abs(moved.velocity);
}

// Poses X_WS (kNumTimes x num_sensors) on the way.
std::vector<std::vector<Pose>> posesOf(const Scene& scene, std::span<const double> start) {
  std::vector<std::string> names;
  for (const RobotSensor& sensor : scene.grasp->sensors) names.push_back(sensor.name);
  const double end = closingTime(scene, start);
  std::vector<std::vector<Pose>> poses;
  for (int k = 0; k < kNumTimes; ++k) {
    std::vector<Pose>& row = poses.emplace_back();
    const std::vector<double> positions = closingPositions(scene, start, end * k / (kNumTimes - 1));
    for (const figures::PosedSensor& sensor : figures::posedSensors(robotOf(scene), positions, names)) row.push_back(sensor.X_WS);
  }
  return poses;
}

// Indices of the fingers that move a sensor.
std::vector<std::size_t> moversOf(const Scene& scene, std::size_t sensor) {
  std::vector<std::size_t> movers;
  const std::vector<ChainJoint>& chain = robotOf(scene).sensors[sensor].chain;
  for (std::size_t f = 0; f < scene.grasp->fingers.size(); ++f) {
    const auto moves = [&](const FingerJoint& moved) {
      return std::ranges::any_of(chain, [&](const ChainJoint& joint) { return joint.joint == moved.joint; });
    };
    if (std::ranges::any_of(scene.grasp->fingers[f].joints, moves)) movers.push_back(f);
  }
  return movers;
}

double halfDiagonal(const Sensor& sensor) {
  double most = 0;
  for (const GridPatch& patch : sensor.patches) most = std::max(most, std::hypot(patch.pitch[0], patch.pitch[1]) / 2);
  return most;
}

// m, of the nearest two taxel centres.
double leastDistance(const std::vector<Vector3>& a, const Pose& X_WA, const std::vector<Vector3>& b, const Pose& X_WB) {
  const Pose X_AB = inverse(X_WA) * X_WB;
  double least = std::numeric_limits<double>::infinity();
  for (const Vector3& point : b) {
    const Vector3 p_A = X_AB * point;
    for (const Vector3& other : a) least = std::min(least, length(subtract(p_A, other)));
  }
  return least;
}

}  // namespace

double closingTime(const Scene& scene, std::span<const double> start) {
  double time = 0;
  for (const GraspFinger& finger : scene.grasp->fingers) {
    for (const FingerJoint& moved : finger.joints) {
      const auto j = static_cast<std::size_t>(moved.joint);
      time = std::max(time, timeOf(moved, robotOf(scene).joints[j], start[j]));
    }
  }
  return time;
}

std::vector<double> closingPositions(const Scene& scene, std::span<const double> start, double time) {
  std::vector<double> positions(start.begin(), start.end());
  for (const GraspFinger& finger : scene.grasp->fingers) {
    for (const FingerJoint& moved : finger.joints) {
      const auto j = static_cast<std::size_t>(moved.joint);
      positions[j] += moved.velocity * std::min(time, timeOf(moved, robotOf(scene).joints[j], start[j]));
    }
  }
  return positions;
}

std::vector<ClosingFinger> closingFingers(const Scene& scene, std::span<const double> start) {
  const std::vector<std::vector<Pose>> poses = posesOf(scene, start);
  std::vector<ClosingFinger> fingers;
  for (const GraspFinger& finger : scene.grasp->fingers) {
    const auto s = static_cast<std::size_t>(finger.sensor);
    const RobotSensor& sensor = scene.grasp->sensors[s];
    const Clearance clearance(sensor.sensor, scene.objects);
    ClosingFinger closing{.name = sensor.name, .open = poses.front()[s], .closed = poses.back()[s], .object = {}};
    closing.distance = std::numeric_limits<double>::infinity();
    for (const std::vector<Pose>& row : poses) {
      for (std::size_t k = 0; k < scene.objects.size(); ++k) {
        const double distance = clearance.of(k, inverse(row[s]) * scene.objects[k].pose);
        if (distance >= closing.distance) continue;
        closing.distance = distance;
        closing.object = scene.objects[k].object.name;
      }
    }
    fingers.push_back(std::move(closing));
  }
  return fingers;
}

std::vector<SensorPair> closingPairs(const Scene& scene, std::span<const double> start) {
  const std::vector<RobotSensor>& sensors = scene.grasp->sensors;
  const std::vector<std::vector<Pose>> poses = posesOf(scene, start);
  std::vector<SensorPair> pairs;
  for (std::size_t a = 0; a < sensors.size(); ++a) {
    for (std::size_t b = a + 1; b < sensors.size(); ++b) {
      const std::vector<std::size_t> of_a = moversOf(scene, a), of_b = moversOf(scene, b);
      if (of_a.empty() && of_b.empty()) continue;
      const std::vector<Vector3> taxels_a = taxelPositions(sensors[a].sensor), taxels_b = taxelPositions(sensors[b].sensor);
      SensorPair pair{.first = sensors[a].name, .second = sensors[b].name, .distance = std::numeric_limits<double>::infinity()};
      for (std::size_t i = 0; i < poses.size(); ++i) {
        for (std::size_t k = 0; k < poses.size(); ++k) {
          if (of_a == of_b && i != k) continue;  // one finger moves both
          if ((of_a.empty() && i > 0) || (of_b.empty() && k > 0)) continue;
          pair.distance = std::min(pair.distance, leastDistance(taxels_a, poses[i][a], taxels_b, poses[k][b]));
        }
      }
      pair.can_touch = pair.distance < halfDiagonal(sensors[a].sensor) + halfDiagonal(sensors[b].sensor);
      pairs.push_back(std::move(pair));
    }
  }
  return pairs;
}

}  // namespace taxelsim::cli
