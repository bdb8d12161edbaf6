#include "evaluation/probe.h"

#include <algorithm>

#include "base/sha256.h"
#include "episodes/grasp_batch.h"
#include "episodes/probe.h"
#include "episodes/task_judge.h"
#include "evaluation/play.h"
#include "simulation/feature_table.h"

namespace taxelsim {
namespace {

void add(Sha256& digest, const FeatureView& features) {
  for (const FeatureField<FeatureView>& field : imageFeatures()) {
    std::visit([&](auto values) { digest.add(std::as_bytes(values)); }, field.values(features));
  }
}

class ProbeSink : public EpisodeSink {
 public:
  bool isComplete() const { return num_frames_ == kNumProbeFrames; }
  std::string hash() { return digest_.finish(); }

  std::optional<std::uint64_t> next(int) override {
    if (next_ == kNumProbeEpisodes) return {};
    return next_++;
  }
  void begin(int, const EpisodeRecord&) override {}
  void frame(const FrameView& view, const FrameContext&) override {
    if (isComplete()) return;
    ++num_frames_;
    add(digest_, view);
    add(digest_, view.ground_truth);
    digest_.add(std::as_bytes(view.tactile_image));
  }
  void end(int) override {}

 private:
  std::uint64_t next_ = 0;
  int num_frames_ = 0;
  Sha256 digest_;
};

}  // namespace

std::string featureProbe(const Model& model, const Scene& scene) {
  SlicePlan plan(scene, kNoOutputs, 0);
  plan.sink_reads = TaskJudge::kReads;
  plan.sink_reads.tactile_image = true;
  ProbeSink sink;
  runProbe(model, plan, sink);
  return sink.hash();
}

std::string graspProbe(const Device& device, const Scene& scene) {
  constexpr int kMost = 200;  // frames, in which fingers touch
  GraspBatch batch(device, scene, kNoOutputs, 1);
  Sha256 digest;
  batch.begin(0, 1);
  for (int frame = 0; frame < std::min(scene.num_steps, kMost); ++frame) {
    batch.step();
    for (int sensor = 0; sensor < batch.robots().numSensors(); ++sensor) {
      const FrameView& view = batch.robots().frame(sensor);
      add(digest, view);
      add(digest, view.ground_truth);
      digest.add(std::as_bytes(view.tactile_image));
    }
  }
  return digest.finish();
}

}  // namespace taxelsim
