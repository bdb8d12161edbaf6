#include "peers/taxelsim_peer.h"

#include <algorithm>

#include "report.h"

namespace taxelsim::bench {
namespace {

constexpr double kDt = 1e-3;  // s

SimulatorOptions optionsOf(int num_instances, const TaxelsimPeer::Options& options) {
  return {.num_instances = num_instances,
          .outputs = {.tactile_normal_force = options.with_forces, .tactile_shear_force = false, .penetration_depth = false},
          .device_clock = options.device_clock};
}

PeerFeatures featuresOf(const FeatureView& view, std::size_t i) {
  return {.total_force = view.total_force[i],
          .peak_force = view.peak_force[i],
          .center_of_pressure = {view.center_of_pressure[3 * i], view.center_of_pressure[3 * i + 1]},
          .second_moments = {view.second_moments[3 * i], view.second_moments[3 * i + 1], view.second_moments[3 * i + 2]},
          .eigenvalues = {view.eigenvalues[2 * i], view.eigenvalues[2 * i + 1]},
          .edge_angle = view.edge_angle[i],
          .edge_confidence = view.edge_confidence[i],
          .contact_area = view.contact_area[i]};
}

}  // namespace

TaxelsimPeer::TaxelsimPeer(const Model& model, int num_instances, const Options& options)
    : with_forces_(options.with_forces), simulator_(model, optionsOf(num_instances, options)) {}

std::string TaxelsimPeer::what() const {
  return "taxelsim on " + simulator_.model().device().info().name;
}

void TaxelsimPeer::run(std::span<const int> ids, std::span<const Pose> X_SO, PeerFrame& frame) {
  simulator_.setObjects(ids, X_SO);
  const Stopwatch watch;
  simulator_.step(kDt);
  const FrameView view = simulator_.read();
  submit_to_read_ = watch.seconds();
  if (with_forces_) copy(view, frame);
}

void TaxelsimPeer::copy(const FrameView& view, PeerFrame& frame) const {
  frame.spread_force.assign(view.ground_truth.tactile_normal_force.begin(), view.ground_truth.tactile_normal_force.end());
  frame.tactile_image.assign(view.tactile_image.begin(), view.tactile_image.end());
  const std::size_t num_instances = view.total_force.size();
  frame.clean.resize(num_instances);
  frame.measured.resize(num_instances);
  for (std::size_t i = 0; i < num_instances; ++i) {
    frame.clean[i] = featuresOf(view.ground_truth, i);
    frame.measured[i] = featuresOf(view, i);
  }
}

}  // namespace taxelsim::bench
