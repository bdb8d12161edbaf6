#include "evaluation/probe.h"

#include "base/sha256.h"
#include "episodes/probe.h"
#include "episodes/task_judge.h"
#include "evaluation/play.h"
#include "simulation/feature_table.h"

namespace taxelsim {
namespace {

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
    add(view);
    add(view.ground_truth);
    digest_.add(std::as_bytes(view.tactile_image));
  }
  void end(int) override {}

 private:
  void add(const FeatureView& features) {
    for (const FeatureField<FeatureView>& field : imageFeatures()) {
      std::visit([this](auto values) { digest_.add(std::as_bytes(values)); }, field.values(features));
    }
  }

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

}  // namespace taxelsim
