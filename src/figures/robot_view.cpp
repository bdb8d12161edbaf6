#include "figures/robot_view.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "base/vector3.h"
#include "figures/scene_view.h"
#include "figures/taxel_chart.h"

namespace taxelsim::figures {
namespace {

constexpr double kRobotSide = 300;  // points, side of a view
constexpr double kTilt = 0.45;
constexpr std::array<double, 2> kAzimuths{-0.5, 2.2};  // rad, of the two views
constexpr double kNormalShare = 0.08;                  // length of the arrow out of a skin, of the extent of the robot

using Point = std::array<double, 2>;

// Places points of W in the box of a view.
class Placement {
 public:
  Placement(const std::vector<PosedSensor>& sensors, double azimuth, double x) : camera_(azimuth, kTilt), x_(x) {
    const double inf = std::numeric_limits<double>::infinity();
    Point low{inf, inf}, high{-inf, -inf};
    const auto include = [&](const Vector3& point) {
      const Camera::Point seen = camera_(point);
      low = {std::min(low[0], seen.right), std::min(low[1], seen.down)};
      high = {std::max(high[0], seen.right), std::max(high[1], seen.down)};
    };
    for (const PosedSensor& sensor : sensors) {
      for (const Vector3& joint : sensor.joints) include(joint);
      include(sensor.X_WS.position);
    }
    extent_ = std::max({high[0] - low[0], high[1] - low[1], 0.02});
    middle_ = {(low[0] + high[0]) / 2, (low[1] + high[1]) / 2};
  }

  double extent() const { return extent_; }
  double near(const Vector3& point) const { return camera_(point).near; }
  bool faces(const Vector3& normal) const { return dot(normal, camera_.towardsViewer()) > 0; }
  Point operator()(const Vector3& point) const {
    const Camera::Point seen = camera_(point);
    const double scale = 0.8 * kRobotSide / extent_;
    return {x_ + kRobotSide / 2 + scale * (seen.right - middle_[0]), kRobotSide / 2 + scale * (seen.down - middle_[1])};
  }

 private:
  Camera camera_;
  double x_, extent_ = 1;
  Point middle_{0, 0};
};

void line(const Canvas& canvas, const Point& from, const Point& to) {
  cairo_move_to(canvas, from[0], from[1]);
  cairo_line_to(canvas, to[0], to[1]);
  cairo_stroke(canvas);
}

void drawChain(const Canvas& canvas, const PosedSensor& sensor, const Placement& place) {
  canvas.colour(kGrey);
  cairo_set_line_width(canvas, 2);
  for (std::size_t j = 1; j < sensor.joints.size(); ++j) line(canvas, place(sensor.joints[j - 1]), place(sensor.joints[j]));
  line(canvas, place(sensor.joints.back()), place(sensor.X_WS.position));
  for (const Vector3& joint : sensor.joints) {
    const Point at = place(joint);
    cairo_arc(canvas, at[0], at[1], 2.2, 0, 2 * std::numbers::pi);
    cairo_fill(canvas);
  }
}

void drawTaxels(const Canvas& canvas, const PosedSensor& sensor, const Placement& place) {
  if (sensor.sensor != nullptr) {
    const std::vector<Vector3> normals = taxelNormals(*sensor.sensor);
    const std::vector<std::array<Vector3, 4>> tiles = tilesOf(*sensor.sensor);
    for (std::size_t t = 0; t < tiles.size(); ++t) {
      for (const Vector3& corner : tiles[t]) {
        const Point at = place(sensor.X_WS * corner);
        cairo_line_to(canvas, at[0], at[1]);
      }
      cairo_close_path(canvas);
      canvas.colour(place.faces(rotate(sensor.X_WS.rotation, normals[t])) ? kGreen : kGap);
      cairo_fill_preserve(canvas);
      canvas.colour(kPaper);
      cairo_set_line_width(canvas, 0.4);
      cairo_stroke(canvas);
    }
  }
  const Vector3 out = rotate(sensor.X_WS.rotation, {0, 0, kNormalShare * place.extent()});
  const Point from = place(sensor.X_WS.position), to = place(add(sensor.X_WS.position, out));
  canvas.colour(kRed);
  cairo_set_line_width(canvas, 1.4);
  line(canvas, from, to);
  canvas.colour(kInk);
  canvas.font(kSmall);
  canvas.text(to[0] + 2, to[1], sensor.name);
}

}  // namespace

std::vector<PosedSensor> posedSensors(const Manipulator& robot, std::span<const double> q, std::span<const std::string> names) {
  std::vector<PosedSensor> sensors;
  for (std::size_t s = 0; s < robot.sensors.size(); ++s) {
    PosedSensor posed{.name = names[s]};
    Pose X = robot.X_WB;
    posed.joints.push_back(X.position);
    for (const ChainJoint& joint : robot.sensors[s].chain) {
      X = X * joint.X_PJ;
      posed.joints.push_back(X.position);
      const double position = joint.multiplier * q[static_cast<std::size_t>(joint.joint)] + joint.offset;
      X = X * (joint.type == JointType::kRevolute ? Pose{{0, 0, 0}, axisAngle({0, 0, 1}, position)} : Pose{{0, 0, position}, {1, 0, 0, 0}});
    }
    posed.X_WS = X * robot.sensors[s].X_JS;
    sensors.push_back(std::move(posed));
  }
  return sensors;
}

Canvas drawRobot(const std::vector<PosedSensor>& sensors, const std::string& title, const std::string& subtitle) {
  const double room = headingRoom(subtitle), width = 2 * kMargin + 2 * kRobotSide + kGutter;
  Canvas canvas(width, room + kRobotSide + kMargin);
  canvas.heading(title, subtitle, width);
  cairo_translate(canvas, 0, room);
  for (std::size_t view = 0; view < kAzimuths.size(); ++view) {
    const Placement place(sensors, kAzimuths[view], kMargin + static_cast<double>(view) * (kRobotSide + kGutter));
    std::vector<const PosedSensor*> order;
    for (const PosedSensor& sensor : sensors) order.push_back(&sensor);
    std::stable_sort(order.begin(), order.end(), [&](const PosedSensor* a, const PosedSensor* b) {
      return place.near(a->X_WS.position) < place.near(b->X_WS.position);
    });
    for (const PosedSensor* sensor : order) {
      drawChain(canvas, *sensor, place);
      drawTaxels(canvas, *sensor, place);
    }
  }
  return canvas;
}

}  // namespace taxelsim::figures
