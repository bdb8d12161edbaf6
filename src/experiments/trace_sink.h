// Records one episode in memory, for experiments.
#pragma once

#include "episodes/episode_sink.h"
#include "episodes/true_edge.h"
#include "taxelsim/experiment.h"

namespace taxelsim {

// For a slice with one instance, which simulates episode 0. Records its first sensor.
class TraceSink : public EpisodeSink {
 public:
  // `scene`, with one object and one controller, must outlive this.
  explicit TraceSink(const Scene& scene);

  std::optional<std::uint64_t> next(int instance) override;
  void begin(int instance, const EpisodeRecord& record) override;
  void frame(const FrameView& view, const FrameContext& context) override;
  void end(int) override {}

  const EpisodeRecord& record() const { return record_; }
  ServoTrace& trace() { return trace_; }

 private:
  const Scene& scene_;
  TrueEdge edge_;
  bool played_ = false;
  EpisodeRecord record_;
  ServoTrace trace_;
};

}  // namespace taxelsim
