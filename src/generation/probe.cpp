#include "generation/probe.h"

#include <algorithm>
#include <vector>

#include "base/sha256.h"
#include "episodes/probe.h"
#include "generation/loop_outputs.h"
#include "generation/recorder.h"
#include "taxelsim/generate.h"

namespace taxelsim {
namespace {

// The episodes as one shard. The rows of frames that an episode does not have are 0.
Manifest probeManifest(const ColumnPlan& columns) {
  Manifest manifest;
  manifest.num_episodes = manifest.episodes_per_shard = kNumProbeEpisodes;
  manifest.columns = columns.columns();
  return manifest;
}

class ProbeSink : public EpisodeSink {
 public:
  ProbeSink(const ColumnPlan& columns, const Recorder& recorder)
      : recorder_(recorder),
        queue_(probeManifest(columns), {false}, kNumProbeFrames),
        episodes_(kNumProbeEpisodes),
        frames_(kNumProbeEpisodes),
        frames_left_(kNumProbeEpisodes, kNumProbeFrames) {}

  bool isComplete() const { return num_complete_ == kNumProbeEpisodes; }

  std::string hash() const {
    Sha256 digest;
    for (const std::vector<std::byte>& column : episodes_[0].buffer->data.columns) digest.add(column);
    return digest.finish();
  }

  std::optional<std::uint64_t> next(int instance) override {
    const std::optional<EpisodePlace> place = queue_.next();
    if (!place) return {};
    episodes_[instance] = *place;
    return place->episode;
  }

  void begin(int instance, const EpisodeRecord& record) override {
    const EpisodePlace& place = episodes_[instance];
    frames_[instance] = {place.buffer->columns.data(), place.row * kNumProbeFrames, static_cast<std::size_t>(record.object)};
    recorder_.recordEpisode({.record = record, .success = false}, place);
  }

  void frame(const FrameView& view, const FrameContext& context) override {
    recorder_.recordFrames(view, context, frames_);
    for (int i = 0; i < kNumProbeEpisodes; ++i) {
      ++frames_[i].row;
      if (frames_[i].columns && --frames_left_[i] == 0) end(i);
    }
  }

  void end(int instance) override {
    if (frames_[instance].columns) ++num_complete_;
    frames_[instance] = {};
  }

 private:
  const Recorder& recorder_;
  ShardQueue queue_;
  int num_complete_ = 0;

  // (kNumProbeEpisodes), one per instance
  std::vector<EpisodePlace> episodes_;
  std::vector<FramePlace> frames_;
  std::vector<int> frames_left_;
};

}  // namespace

std::string probeHash(const Model& model, const Scene& scene, const ColumnPlan& columns) {
  SlicePlan plan(scene, outputsOf(scene));
  plan.sink_reads = loopOutputsOf(scene, columns);
  const Recorder recorder(columns, plan.edges);
  ProbeSink sink(columns, recorder);
  runProbe(model, plan, sink);
  return sink.hash();
}

}  // namespace taxelsim
