// Progress lines: percentage and time left count frames.
#include "cli/progress.h"

#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>

#include "support/test.h"

namespace taxelsim::cli {
namespace {

// One batch of 1,000 episodes of 200 frames, of which a quarter is simulated: no episode has ended.
const Progress kFirstBatch{
    .episodes_done = 0, .num_episodes = 1000, .frames_done = 50'000, .num_frames = 200'000, .episodes_resumed = 0, .seconds = 10};

const Progress kStart{.num_episodes = 1000, .num_frames = 200'000};

TEST(ProgressLine, AdvancesWithinABatch) {
  EXPECT_EQ(progressLine(kFirstBatch, kStart), " 25 %  0 of 1,000 episodes  5,000 frames/s  0:30 left");
}

TEST(ProgressLine, CountsEpisodesOnDisk) {
  Progress progress = kFirstBatch;
  progress.episodes_done = progress.episodes_resumed = 500;
  progress.num_frames = 100'000;
  EXPECT_EQ(progressLine(progress, kStart), " 75 %  500 of 1,000 episodes  5,000 frames/s  0:10 left");
  progress.episodes_done = progress.episodes_resumed = 1000;
  progress.frames_done = progress.num_frames = 0;
  progress.seconds = 0;
  EXPECT_EQ(progressLine(progress, kStart), "100 %  1,000 of 1,000 episodes  0 frames/s  ? left");
}

// The first frame of each of 1,000 instances took 6 s, all others the rest of 10 s: 49,000 frames in 4 s.
TEST(ProgressLine, TimeLeftIgnoresTheFirstFrame) {
  Progress first = kStart;
  first.frames_done = 1000;
  first.seconds = 6;
  EXPECT_EQ(progressLine(first, first), "  0 %  0 of 1,000 episodes  166 frames/s  ? left");
  EXPECT_EQ(progressLine(kFirstBatch, first), " 25 %  0 of 1,000 episodes  5,000 frames/s  0:12 left");
}

TEST(ProgressLine, HasNoEstimateWithoutAFrame) {
  Progress progress = kFirstBatch;
  progress.frames_done = 0;
  EXPECT_EQ(progressLine(progress, kStart), "  0 %  0 of 1,000 episodes  0 frames/s  ? left");
  EXPECT_EQ(progressLine({}, {}), "  0 %  0 of 0 episodes  0 frames/s  ? left");
}

TEST(ProgressPrinter, EndsALogWithAllEpisodes) {
  std::ostringstream log;
  const std::shared_ptr<spdlog::logger> before = spdlog::default_logger();
  spdlog::set_default_logger(std::make_shared<spdlog::logger>("test", std::make_shared<spdlog::sinks::ostream_sink_st>(log)));
  {
    ProgressPrinter printer;
    printer.show(kStart);
    Progress end = kFirstBatch;
    end.seconds = 1;  // before the next line is due
    printer.show(end);
    end.episodes_done = end.num_episodes;
    end.frames_done = end.num_frames;
    printer.show(end);
    printer.show(end);
  }
  spdlog::set_default_logger(before);
  const std::string lines = log.str();
  EXPECT_EQ(std::count(lines.begin(), lines.end(), '\n'), 2) << lines;
  EXPECT_NE(lines.find("100 %  1,000 of 1,000 episodes"), std::string::npos) << lines;
}

TEST(ProgressBar, FitsTheWidth) {
  const std::string bar = progressBar(kFirstBatch, kStart, 120);
  EXPECT_TRUE(bar.starts_with("[########......................]  25 %")) << bar;
  for (const int width : {0, 10, 40, 60, 70, 80})
    EXPECT_LE(progressBar(kFirstBatch, kStart, width).size(), static_cast<std::size_t>(width));
}

}  // namespace
}  // namespace taxelsim::cli
