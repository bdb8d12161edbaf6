#include "figures/episode_view.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <utility>

#include "base/text.h"
#include "figures/recorded_scene.h"
#include "taxelsim/error.h"

namespace taxelsim::figures {
namespace {

// Lengths in points.
constexpr double kViewPage = 450, kViewHeight = 384;
constexpr double kSide = 16, kHeadFoot = 46;  // margins left and right, height of the heading
constexpr double kSceneWidth = 226, kMainHeight = 186;
constexpr double kRightColumn = 256, kRightWidth = kViewPage - kSide - kRightColumn;
constexpr double kImageTop = kHeadFoot + 18, kImageHeight = 78;
constexpr double kStripTop = kHeadFoot + kMainHeight + 36, kStripLeft = 40, kStripGap = 46;
constexpr PlotSize kStrip{.width = (kViewPage - kSide - kStripLeft - kStripGap) / 2, .height = 76};
constexpr double kMinScale = 90;    // width of the colour scale, which has room for both of its numbers
constexpr double kLargeValue = 21;  // size of type

constexpr double kMeshDetail = 2e-4;  // m: largest error of the surface that is drawn
constexpr double kHalfTurn = 180;     // degrees: an edge has no direction
constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

[[noreturn]] void refuse(const FrameFigures& frames, const std::string& why) {
  throw Error(ErrorKind::kInput, oneLine(frames.directory()) + ": " + why);
}

// The values of a column, which must be there; `words` of the scene's `record` have it.
std::vector<double> required(const FrameFigures& frames, std::vector<double> values, const std::string& name, const std::string& words) {
  if (values.empty()) {
    refuse(frames, fmt::format("no column data/{} of one sensor to draw an episode; add {} to record of the scene", name, words));
  }
  return values;
}

std::vector<Pose> asPoses(const std::vector<double>& rows) {
  std::vector<Pose> poses;
  for (std::size_t k = 0; k < rows.size(); k += 7) {
    poses.push_back({{rows[k], rows[k + 1], rows[k + 2]}, {rows[k + 3], rows[k + 4], rows[k + 5], rows[k + 6]}});
  }
  return poses;
}

// X_SO, (num_frames x num_objects).
std::vector<Pose> posesOf(const FrameFigures& frames, std::size_t num_objects) {
  if (frames.sensorName().empty()) return asPoses(required(frames, frames.valuesOf("pose", 7), "pose", "poses"));
  const std::vector<Pose> X_WS = asPoses(frames.valuesOf("sensor_pose", 7));
  std::vector<Pose> poses = asPoses(frames.allOf("data/object_pose"));
  if (X_WS.empty() || poses.size() != X_WS.size() * num_objects) refuse(frames, "no poses of sensor and objects to draw an episode");
  for (std::size_t k = 0; k < poses.size(); ++k) poses[k] = inverse(X_WS[k / num_objects]) * poses[k];
  return poses;
}

Sensor sensorOf(FrameFigures& frames) {
  const std::optional<Sensor> sensor = recordedSensor(frames.manifest(), frames.sensorName());
  if (!sensor) refuse(frames, "its scene does not have the taxels of the sensor, which are in another file or of several sensors");
  if (frames.panelOf(0).values.size() < static_cast<std::size_t>(numTaxels(*sensor)))
    refuse(frames, "its images lack taxels of the sensor");
  return *sensor;
}

// The object of the episode, or all objects of a grasp.
std::vector<Object> objectsOf(const FrameFigures& frames, std::span<const std::filesystem::path> assets) {
  const bool is_grasp = !frames.sensorName().empty();
  const std::optional<std::size_t> index = is_grasp ? 0 : frames.objectIndex();
  if (!index) refuse(frames, "no column meta/object to draw an episode");
  const std::size_t end = is_grasp ? numRecordedObjects(frames.manifest()) : *index + 1;
  std::vector<Object> objects;
  try {
    for (std::size_t k = *index; k < end; ++k) objects.push_back(recordedObject(frames.manifest(), k, assets, kMeshDetail));
  } catch (const Error& error) {
    refuse(frames, error.what());
  }
  return objects;
}

// Degrees. Adds half turns to all angles, so that their mean is within 90 degrees of 45: those along x and along y have small numbers.
std::vector<double> centred(std::vector<double> angles) {
  double sum = 0, count = 0;
  for (const double angle : angles) {
    if (std::isfinite(angle)) sum += angle, ++count;
  }
  const double offset = count > 0 ? kHalfTurn * std::round((kHalfTurn / 4 - sum / count) / kHalfTurn) : 0;
  for (double& angle : angles) angle += offset;
  return angles;
}

PanelSize fitted(const PanelSize& size, double width, double height) {
  const double scale = std::min(width / size.width, height / size.height);
  return {scale * size.cell_width, scale * size.cell_height, scale * size.width, scale * size.height};
}

// A colour scale under the image, with its ends.
void drawScale(const Canvas& canvas, double x, double y, double width, const ColourScale& scale, const std::string& unit) {
  static constexpr double kHeight = 6;
  for (double column = 0; column < width; column += 1 / kPixelsPerPoint) {
    canvas.colour(scale.at(scale.top() * column / width));
    cairo_rectangle(canvas, x + column, y, 1 / kPixelsPerPoint, kHeight);
    cairo_fill(canvas);
  }
  canvas.font(kSmall);
  canvas.colour(kGrey);
  canvas.text(x, y + kHeight + 2 + kSmall, "0");
  canvas.text(x + width, y + kHeight + 2 + kSmall, fmt::format("{:.4g} {}", scale.top(), unit), 1);
}

// The lines of the image in words.
void drawLines(const Canvas& canvas, double x, double y) {
  canvas.font(kSmall);
  for (const auto& [colour, words] : {std::pair{kContour, "contact"}, std::pair{kAxis, "principal axes"}}) {
    cairo_set_line_width(canvas, 2.4);
    canvas.colour(colour);
    cairo_move_to(canvas, x, y - 3);
    cairo_line_to(canvas, x + 14, y - 3);
    cairo_stroke(canvas);
    canvas.colour(kGrey);
    canvas.text(x + 19, y, words);
    x += 19 + canvas.widthOf(words) + 16;
  }
}

void drawTitle(const Canvas& canvas, double x, double y, const std::string& title) {
  canvas.font(kBody, true);
  canvas.colour(kInk);
  canvas.text(x, y, title);
}

}  // namespace

std::vector<double> continuousAngles(std::vector<double> angles) {
  double last = kNone;
  for (double& angle : angles) {
    angle *= kHalfTurn / std::numbers::pi;
    if (std::isfinite(last)) angle += kHalfTurn * std::round((last - angle) / kHalfTurn);
    if (std::isfinite(angle)) last = angle;
  }
  return centred(std::move(angles));
}

EpisodeView::EpisodeView(FrameFigures& frames, std::span<const std::filesystem::path> assets)
    : frames_(frames),
      poses_(frames.sensorName().empty() ? posesOf(frames, 1) : std::vector<Pose>()),
      times_(frames.times()),
      curves_{forceCurve(), angleCurve()} {
  const Sensor sensor = sensorOf(frames);
  objects_ = objectsOf(frames, assets);
  if (poses_.empty()) poses_ = posesOf(frames, objects_.size());
  std::vector<Shape> shapes;
  std::string names;
  for (const Object& object : objects_) {
    shapes.push_back(object.shape);
    names += (names.empty() ? "" : ", ") + object.name;
  }
  subtitle_ = oneLine(names + " on " + (frames.sensorName().empty() ? sensor.name : frames.sensorName()));
  scene_.emplace(sensor, shapes, poses_, kSceneWidth, kMainHeight);
}

EpisodeView::Curve EpisodeView::forceCurve() const {
  return {.name = "force",
          .unit = "N",
          .colour = seriesColour(0),
          .values = required(frames_, frames_.valuesOf("total_force", 1), "total_force", "features")};
}

EpisodeView::Curve EpisodeView::angleCurve() const {
  return {.name = "edge angle",
          .unit = "°",
          .colour = seriesColour(1),
          .values = continuousAngles(required(frames_, frames_.edgeAngles(), "edge_angle", "features"))};
}

void EpisodeView::drawImage(const Canvas& canvas, const TactilePanel& panel, const ColourScale& scale) const {
  const PanelSize size = fitted(sizeOf(panel), kRightWidth, kImageHeight);
  drawTitle(canvas, kRightColumn, kHeadFoot + 8, "tactile image");
  cairo_save(canvas);
  cairo_translate(canvas, kRightColumn, kImageTop);
  drawPanel(canvas, panel, size, scale);
  cairo_restore(canvas);
  drawScale(canvas, kRightColumn, kImageTop + size.height + 8, std::max(size.width, kMinScale), scale, frames_.options().unit);
  if (panel.neighbours) drawLines(canvas, kRightColumn, kImageTop + size.height + 46);
}

void EpisodeView::drawValue(const Canvas& canvas, const Curve& curve, std::uint64_t frame, double left) const {
  const double value = curve.values[frame];
  const std::string space = curve.unit == "°" ? "" : " ";
  canvas.font(kLargeValue, true);
  canvas.colour(curve.colour);
  canvas.text(left, kHeadFoot + kMainHeight - 2,
              std::isfinite(value) ? fmt::format("{:.{}f}{}{}", value, space.size(), space, curve.unit) : "–");
  canvas.font(kBody);
  canvas.colour(kGrey);
  canvas.text(left, kHeadFoot + kMainHeight - 6 - kLargeValue, curve.name);
}

void EpisodeView::drawCurve(const Canvas& canvas, const Curve& curve, std::uint64_t frame, double left) const {
  LinePanel panel{.x_label = "time, s", .marks = {{.x = times_[frame]}}};
  panel.series.push_back({.name = "", .x = times_, .y = curve.values, .colour = curve.colour});
  panel.series.push_back(
      {.name = "", .x = {times_[frame]}, .y = {curve.values[frame]}, .style = LineStyle::kPoints, .colour = curve.colour});
  drawTitle(canvas, left - kStripLeft + kSide, kStripTop - 12, fmt::format("{}, {}", curve.name, curve.unit));
  cairo_save(canvas);
  cairo_translate(canvas, left, kStripTop);
  drawPlot(canvas, panel, kStrip);
  cairo_restore(canvas);
}

void EpisodeView::drawHeading(const Canvas& canvas, std::uint64_t frame) const {
  canvas.font(kHeading, true);
  canvas.colour(kInk);
  canvas.text(kSide, 12 + kHeading, frames_.options().title, 0, kRightColumn - kSide - 10);
  canvas.font(kBody);
  canvas.colour(kGrey);
  canvas.text(kRightColumn, 12 + kHeading, subtitle_, 0, kRightWidth - 56);
  canvas.text(kViewPage - kSide, 12 + kHeading, fmt::format("{:.2f} s", times_[frame]), 1);
}

Canvas EpisodeView::pictureOf(std::uint64_t frame) {
  ColourScale scale = valueScale();
  scale.max = frames_.options().range;
  TactilePanel panel = frames_.panelOf(frame);
  panel.numbers = false;
  Canvas canvas(kViewPage, kViewHeight);
  drawHeading(canvas, frame);
  cairo_save(canvas);
  cairo_translate(canvas, kSide, kHeadFoot);
  scene_->draw(canvas, std::span(poses_).subspan(frame * objects_.size(), objects_.size()), panel.values, scale);
  cairo_restore(canvas);
  drawImage(canvas, panel, scale);
  for (std::size_t c = 0; c < curves_.size(); ++c) {
    const auto column = static_cast<double>(c);
    drawValue(canvas, curves_[c], frame, kRightColumn + column * 0.5 * kRightWidth);
    drawCurve(canvas, curves_[c], frame, kStripLeft + column * (kStrip.width + kStripGap));
  }
  return canvas;
}

}  // namespace taxelsim::figures
