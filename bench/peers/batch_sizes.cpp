#include "peers/batch_sizes.h"

#include <algorithm>
#include <cstdio>
#include <memory>
#include <span>

#include "peers/taxelsim_peer.h"
#include "taxelsim/error.h"

namespace taxelsim::bench {
namespace {

// Computes all frames of the case, batch by batch.
double secondsOfAll(TaxelsimPeer& simulator, const Poses& poses, std::size_t num_instances) {
  PeerFrame none;
  const Stopwatch watch;
  for (std::size_t first = 0; first < poses.ids.size(); first += num_instances)
    simulator.run(std::span(poses.ids).subspan(first, num_instances), std::span(poses.X_SO).subspan(first, num_instances), none);
  return watch.seconds();
}

}  // namespace

BatchSizes timeBatchSizes(const Device& device, const Sensor& sensor, const Case& work, std::vector<int> sizes, int repetitions) {
  if (work.slides)
    throw Error(ErrorKind::kInput, "--batches --case " + work.name + ": frames of batches of several sizes cannot follow each other");
  std::sort(sizes.begin(), sizes.end());
  const GridPatch& patch = sensor.patches[0];
  BatchSizes result{.name = work.name,
                    .array = std::to_string(patch.num_rows) + "x" + std::to_string(patch.num_cols),
                    .num_frames = work.numInstances(),
                    .sizes = {}};
  const Model model(device, {.sensor = sensor, .objects = work.objects});
  std::vector<std::unique_ptr<TaxelsimPeer>> simulators;
  for (const int size : sizes) {
    if (work.numInstances() % static_cast<std::size_t>(size) != 0)
      throw Error(ErrorKind::kInput,
                  "--instances " + std::to_string(size) + ": does not divide the largest, " + std::to_string(sizes.back()));
    simulators.push_back(std::make_unique<TaxelsimPeer>(model, size));
    result.sizes.push_back({.num_instances = size});
    secondsOfAll(*simulators.back(), work.poses, static_cast<std::size_t>(size));  // warm-up
  }
  warmUp(device.info(), [&] { secondsOfAll(*simulators.back(), work.poses, static_cast<std::size_t>(sizes.back())); });
  for (int r = 0; r < repetitions; ++r) {
    const Poses poses = framesOf(work, r + 1)[0];
    for (std::size_t k = 0; k < sizes.size(); ++k)
      result.sizes[k].seconds.push_back(secondsOfAll(*simulators[k], poses, static_cast<std::size_t>(sizes[k])));
    for (BatchSizes::Size& size : result.sizes) size.ratios.push_back(result.sizes.back().seconds.back() / size.seconds.back());
  }
  return result;
}

void print(const BatchSizes& result) {
  std::printf("%s, %s taxels, %zu frames a turn\n", result.name.c_str(), result.array.c_str(), result.num_frames);
  std::printf("  %10s %14s  %s\n", "instances", "frames/s", "over the largest batch");
  for (const BatchSizes::Size& size : result.sizes) {
    const Summary ratio = summarise(size.ratios);
    std::printf("  %10d %14.0f  %.3f (%.3f to %.3f)\n", size.num_instances, result.framesPerSecond(size), ratio.median, ratio.min,
                ratio.max);
  }
  std::printf("\n");
  std::fflush(stdout);
}

nlohmann::ordered_json toJson(const BatchSizes& result) {
  nlohmann::ordered_json sizes = nlohmann::ordered_json::array();
  for (const BatchSizes::Size& size : result.sizes)
    sizes.push_back({{"num_instances", size.num_instances},
                     {"frames_per_second", result.framesPerSecond(size)},
                     {"seconds", toJson(size.seconds)},
                     {"ratio", toJson(size.ratios)}});
  return {{"case", result.name}, {"array", result.array}, {"num_frames", result.num_frames}, {"batch_sizes", sizes}};
}

}  // namespace taxelsim::bench
