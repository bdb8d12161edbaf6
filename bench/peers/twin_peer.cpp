#include "peers/twin_peer.h"

#include <algorithm>

#include "peers/threads.h"
#include "reference/frame.h"

namespace taxelsim::bench {
namespace {

constexpr double kDt = 1e-3;  // s; the peers' sensors do not depend on it

PeerFeatures rounded(const reference::Features& features) {
  const auto f = [](double value) { return static_cast<float>(value); };
  return {.total_force = f(features.total_force),
          .peak_force = f(features.peak_force),
          .center_of_pressure = {f(features.center_of_pressure[0]), f(features.center_of_pressure[1])},
          .second_moments = {f(features.second_moments[0]), f(features.second_moments[1]), f(features.second_moments[2])},
          .eigenvalues = {f(features.eigenvalues[0]), f(features.eigenvalues[1])},
          .edge_angle = f(features.edge_angle),
          .edge_confidence = f(features.edge_confidence),
          .contact_area = f(features.contact_area)};
}

}  // namespace

TwinPeer::TwinPeer(const Sensor& sensor, const std::vector<Object>& objects, int num_threads)
    : sensor_(sensor), objects_(objects), num_threads_(threadsOf(num_threads)) {}

void TwinPeer::run(std::span<const int> ids, std::span<const Pose> X_SO, PeerFrame& frame) {
  const auto num_taxels = static_cast<std::size_t>(numTaxels(sensor_));
  frame.resize(X_SO.size(), num_taxels);
  inThreads(num_threads_, static_cast<int>(X_SO.size()), 1, [&](int, int instance) {
    const auto i = static_cast<std::size_t>(instance);
    reference::FrameInput input;
    input.objects = {{&objects_[static_cast<std::size_t>(ids[i])], X_SO[i]}};
    input.dt = kDt;
    const reference::Frame made = reference::simulateFrame(sensor_, input);
    if (frame.with_forces) {
      std::transform(made.spread_force.begin(), made.spread_force.end(),
                     frame.spread_force.begin() + static_cast<std::ptrdiff_t>(i * num_taxels),
                     [](double force) { return static_cast<float>(force); });
    }
    std::copy(made.counts.begin(), made.counts.end(), frame.tactile_image.begin() + static_cast<std::ptrdiff_t>(i * num_taxels));
    frame.clean[i] = rounded(made.clean);
    frame.measured[i] = rounded(made.measured);
  });
}

}  // namespace taxelsim::bench
