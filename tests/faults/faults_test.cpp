// Faults around `taxelsim generate`: a lost device, a refused pipeline, limits of memory and of open files, a clock that jumps. Each ends
// with one line or with the data set; complete shards stay, and resuming gives the bytes of an undisturbed run.
#include <sys/resource.h>

#include <chrono>
#include <csignal>
#include <iostream>

#include "faults/failing.h"
#include "support/cases.h"
#include "support/test.h"

namespace taxelsim::testing {
namespace {

constexpr int kNumShards = 6;           // of two episodes
constexpr int kProgramNotLoaded = 127;  // exit status of the loader of shared libraries

class Faults : public ::testing::Test {
 protected:
  Faults() {
    std::ofstream(root_ / "scene.yaml") << "format_version: 1\nname: balls\nkind: contacts\nsensor: " << TAXELSIM_SOURCE_DIR
                                        << "/scenes/sensors/wts0614_soft_cover.yaml\nobjects: [{sphere: {radius_mm: 5}}]\n"
                                        << "randomization: {load: [0.1, 1]}\nrecord: [tactile_image]\n"
                                        << "data_set: {episodes: 12, seed: 1, episodes_per_shard: 2}\n";
    if (complete_.empty()) {
      EXPECT_EQ(generate(root_ / "complete").status, 0);
      complete_ = filesOf(root_ / "complete");
    }
  }

  // A batch of one, so that each episode is a submit of its own.
  Outcome generate(const std::filesystem::path& out, const RunOptions& options = {}) {
    return runTaxelsim({"--log-level", "error", "generate", root_ / "scene.yaml", "-o", out, "--batch-size", "1"}, options);
  }

  // Whole shards in `out`, which must have the bytes of an undisturbed run.
  int wholeShards(const std::filesystem::path& out) {
    int whole = 0;
    for (const auto& [name, bytes] : filesOf(out)) {
      if (!name.ends_with(".h5")) continue;
      EXPECT_TRUE(complete_.contains(name)) << name;
      EXPECT_TRUE(bytes == complete_[name]) << name;
      whole += name.starts_with("shard-");
    }
    return whole;
  }

  // Resumes without the fault.
  void expectResumes(const std::filesystem::path& out) {
    const Outcome resumed = generate(out);
    EXPECT_EQ(resumed.status, 0) << resumed.err;
    EXPECT_TRUE(filesOf(out) == complete_) << "resumed data set differs";
    std::filesystem::remove_all(out);
  }

  TemporaryDirectory root_;
  static inline Files complete_;  // of an undisturbed run
};

// A driver reset at every submit, or at every fifth one.
TEST_F(Faults, LostDeviceKeepsWhatWasComputed) {
  int num_lost = 0, kept = 0;
  for (int n = 1; n < kManyFaults; n += support::numCases(5, 1)) {
    SCOPED_TRACE("submit " + std::to_string(n));
    const Outcome outcome = generate(root_ / "lost", failing("TAXELSIM_FAIL_SUBMIT", n));
    if (outcome.status == 0) break;
    expectDeviceError(outcome, "the device was lost during");
    const int whole = wholeShards(root_ / "lost");
    EXPECT_GE(whole, kept) << "more was computed than before the last loss";
    kept = whole;
    expectResumes(root_ / "lost");
    ++num_lost;
  }
  std::cout << num_lost << " lost devices, up to " << kept << " of " << kNumShards << " shards kept" << std::endl;
  EXPECT_GE(num_lost, 3) << "the layer has no effect";
  EXPECT_GE(kept, kNumShards / 2);
}

// The first Ctrl-C waits for the batch that the device computes; the second one does not.
TEST_F(Faults, HungDeviceIsLeftByTheSecondCtrlC) {
  RunOptions options = failing("TAXELSIM_HANG_SUBMIT", kNumShards + 1);
  options.signal = SIGINT;
  options.signal_after = 1;  // s, until the device hangs, or earlier on a slow machine: the program ends as well
  options.num_signals = 2;
  const Outcome outcome = generate(root_ / "hung", options);
  EXPECT_TRUE(outcome.status == 128 + SIGINT) << outcome.status << outcome.err;
  wholeShards(root_ / "hung");
  expectResumes(root_ / "hung");
}

TEST_F(Faults, RefusedPipelineIsOneLine) {
  int num_refused = 0;
  for (int n = 1; n < kManyFaults; n += support::numCases(4, 1)) {
    SCOPED_TRACE("pipeline " + std::to_string(n));
    const Outcome outcome = generate(root_ / "refused", failing("TAXELSIM_FAIL_PIPELINE", n));
    if (outcome.status == 0) break;
    expectDeviceError(outcome, "failed: ErrorInitializationFailed");
    wholeShards(root_ / "refused");
    expectResumes(root_ / "refused");
    ++num_refused;
  }
  std::cout << num_refused << " refused pipelines" << std::endl;
  EXPECT_GE(num_refused, 1) << "the layer has no effect";
}

// From what does not load the program to what suffices. How many files that is depends on those that the test inherits.
TEST_F(Faults, FewOpenFilesAreOneLine) {
  int num_refused = 0, num_whole = 0;
  for (std::uint64_t limit = 4; limit < 32 && num_whole == 0; ++limit) {
    SCOPED_TRACE(std::to_string(limit) + " files");
    const Outcome outcome = generate(root_ / "files", {.limits = {{RLIMIT_NOFILE, limit}}});
    num_refused += outcome.status != 0;
    num_whole += outcome.status == 0;
    if (outcome.status == kProgramNotLoaded) continue;
    if (outcome.status != 0) expectDeviceError(outcome, "Too many open files");
    wholeShards(root_ / "files");
    expectResumes(root_ / "files");
  }
  std::cout << num_refused << " errors, " << num_whole << " data sets" << std::endl;
  EXPECT_GE(num_refused, 1) << "no limit is too small";
  EXPECT_GE(num_whole, 1) << "no limit suffices";
}

// From what the program hardly starts with to what suffices. Mesa and SPIRV-Cross crash where they find no memory: this is one line, too.
TEST_F(Faults, LittleMemoryIsOneLine) {
  constexpr std::uint64_t kMebibyte = 1 << 20;
  int num_errors = 0;
  for (std::uint64_t limit = 200; limit <= 1100; limit += 100 * static_cast<std::uint64_t>(support::numCases(4, 1))) {
    SCOPED_TRACE(std::to_string(limit) + " MiB");
    const Outcome outcome = generate(root_ / "memory", {.limits = {{RLIMIT_AS, limit * kMebibyte}}});
    if (outcome.status != 0) {
      ++num_errors;
      expectDeviceError(outcome, "");
    }
    wholeShards(root_ / "memory");
    if (support::runsAllCases()) expectResumes(root_ / "memory");
  }
  std::cout << num_errors << " errors" << std::endl;
  EXPECT_GE(num_errors, 1) << "no size is too small";
}

TEST_F(Faults, JumpingClockChangesNothing) {
  const RunOptions jumping{.environment = {"LD_PRELOAD=" TAXELSIM_JUMPING_CLOCK}};
  const Outcome outcome = generate(root_ / "clock", jumping);
  EXPECT_EQ(outcome.status, 0) << outcome.err;
  EXPECT_TRUE(filesOf(root_ / "clock") == complete_);

  // The clock was set back, or forward, after some shards were written.
  for (int years = -40; years <= 40; years += support::numCases(81, 80)) {
    SCOPED_TRACE(std::to_string(years) + " years");
    for (const auto& entry : std::filesystem::directory_iterator(root_ / "clock"))
      std::filesystem::last_write_time(entry, std::filesystem::file_time_type::clock::now() + std::chrono::years(years));
    std::filesystem::remove(root_ / "clock/shard-000003.h5");
    RunOptions killed = jumping;
    killed.signal = SIGKILL;
    killed.signal_after = 0.2;
    generate(root_ / "clock", killed);
    wholeShards(root_ / "clock");
    EXPECT_EQ(generate(root_ / "clock", jumping).status, 0);
    EXPECT_TRUE(filesOf(root_ / "clock") == complete_);
    succeed({"inspect", root_ / "clock", "--verify"}, jumping);
  }
}

}  // namespace
}  // namespace taxelsim::testing
