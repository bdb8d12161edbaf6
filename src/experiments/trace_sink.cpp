#include "experiments/trace_sink.h"

#include "episodes/draw.h"
#include "experiments/felt_angle.h"

namespace taxelsim {

TraceSink::TraceSink(const Scene& scene) : scene_(scene), edge_(scene.objects.front()) {
  const auto num_frames = static_cast<std::size_t>(numFrames(scene));
  for (std::vector<double>* column : {&trace_.time, &trace_.true_angle, &trace_.edge_angle, &trace_.total_force}) {
    column->reserve(num_frames);
  }
  trace_.tactile_image.reserve(num_frames * static_cast<std::size_t>(numTaxels(scene.sensor)));
}

std::optional<std::uint64_t> TraceSink::next(int) {
  if (played_) return {};
  played_ = true;
  return 0;
}

void TraceSink::begin(int, const EpisodeRecord& record) {
  record_ = record;
}

void TraceSink::frame(const FrameView& view, const FrameContext& context) {
  if (!context.active[0]) return;
  const double angle = edge_.project(context.X_SO[0]).angle;
  trace_.time.push_back(context.times[0]);
  trace_.true_angle.push_back(angle);
  trace_.edge_angle.push_back(feltAngle(scene_.controllers.front().servo, view, 0).value_or(angle));
  trace_.total_force.push_back(view.ground_truth.total_force[0]);
  const std::span<const float> center = view.ground_truth.center_of_pressure;
  trace_.center_of_pressure.push_back({center[0], center[1], center[2]});
  const std::span<const std::uint32_t> image = view.tactile_image.first(static_cast<std::size_t>(numTaxels(scene_.sensor)));
  trace_.tactile_image.insert(trace_.tactile_image.end(), image.begin(), image.end());
  trace_.X_WS.push_back(context.X_WS[0]);
  trace_.X_WO.push_back(context.X_WO[0]);
  const std::span<const double> joints = context.joint_positions;
  trace_.joint_positions.insert(trace_.joint_positions.end(), joints.begin(), joints.end());
  trace_.robot_status.push_back(context.robot_status[0]);
}

}  // namespace taxelsim
