// `generate --processes` and `evaluate --processes`: the bytes of one process, interruptions, and processes that are killed. Small batches
// make runs that are long enough to be interrupted; the bytes do not depend on them.
#include <dirent.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <thread>

#include "cli/command_line.h"
#include "cli/small_task.h"
#include "support/test.h"

namespace taxelsim::testing {
namespace {

using ::testing::HasSubstr;

constexpr auto kPeriod = std::chrono::milliseconds(5);

struct ProcessStatus {
  pid_t parent = 0;
  char state = 'X';
};

// State X if there is no such process, Z if it has ended.
ProcessStatus statusOf(pid_t process) {
  std::ifstream stream("/proc/" + std::to_string(process) + "/stat");
  std::string text;
  std::getline(stream, text);  // fails without an exception if the process ends meanwhile
  ProcessStatus status;
  if (const std::size_t name_end = text.rfind(')'); name_end != std::string::npos) {
    status.state = text[name_end + 2];
    status.parent = std::stoi(text.substr(name_end + 4));
  }
  return status;
}

std::vector<pid_t> childrenOf(pid_t parent) {
  std::vector<pid_t> children;
  for (const auto& entry : std::filesystem::directory_iterator("/proc")) {
    const std::string name = entry.path().filename().string();
    if (!std::all_of(name.begin(), name.end(), [](unsigned char c) { return std::isdigit(c) != 0; })) continue;
    const ProcessStatus status = statusOf(std::stoi(name));
    if (status.parent == parent && status.state != 'Z') children.push_back(std::stoi(name));
  }
  return children;
}

// The processes that a program has started, once all run. Empty if the program ends before.
std::vector<pid_t> processesOf(const RunningTaxelsim& program, std::size_t num_processes) {
  while (statusOf(program.process()).state != 'Z') {
    std::vector<pid_t> children = childrenOf(program.process());
    if (children.size() == num_processes) return children;
    std::this_thread::sleep_for(kPeriod);
  }
  return {};
}

// Returns when a process has ended. The test's limit of time ends the wait for one that does not.
void waitForEnd(pid_t process) {
  for (char state = 'R'; state != 'X' && state != 'Z'; state = statusOf(process).state) std::this_thread::sleep_for(kPeriod);
}

std::size_t numShards(const std::string& directory) {
  if (!std::filesystem::exists(directory)) return 0;
  return static_cast<std::size_t>(std::count_if(std::filesystem::directory_iterator(directory), {},
                                                [](const auto& entry) { return entry.path().extension() == ".h5"; }));
}

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t number = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1)) ++number;
  return number;
}

// Without progress, whose lines depend on time.
std::string warningsIn(const std::string& text) {
  std::string warnings;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with("warning: ")) warnings += line + "\n";
  return warnings;
}

std::vector<std::string> joined(std::vector<std::string> first, const std::vector<std::string>& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

class Processes : public ::testing::Test {
 protected:
  Processes() {
    // 40 shards of one episode, with loads out of reach.
    std::string text = kSmallTask;
    text.replace(text.find("load: [1, 3]"), 12, "load: [1, 900]");
    text.replace(text.find("seed: 3"), 7, "seed: 3, episodes_per_shard: 1");
    std::ofstream(scene_) << text;
  }

  std::vector<std::string> generating(const std::string& directory, const std::vector<std::string>& options) const {
    return joined({"generate", scene_, "-o", root_ / directory}, options);
  }
  std::vector<std::string> evaluating(const std::vector<std::string>& options) const { return joined({"evaluate", scene_}, options); }

  TemporaryDirectory root_;
  const std::string scene_ = root_ / "small.yaml";
  const std::vector<std::string> long_run_{"--processes", "3", "--batch-size", "3"};
};

TEST_F(Processes, GiveTheBytesAndTheTableOfOne) {
  const Outcome one = succeed(generating("one", {}));
  EXPECT_EQ(count(one.err, "load out of reach"), 1u) << one.err;
  const Outcome table = runTaxelsim(evaluating({"--json"}));
  for (const std::string number : {"1", "3"}) {
    const Outcome several = succeed(generating(number, {"--processes", number}));
    EXPECT_EQ(filesOf(root_ / number), filesOf(root_ / "one"));
    EXPECT_EQ(warningsIn(several.err), warningsIn(one.err)) << "loads out of reach of all processes together";
    EXPECT_EQ(count(several.err, "40 of 40 episodes"), 1u) << "one line of progress: " << several.err;
    EXPECT_EQ(count(several.err, "40 episodes on "), 1u) << several.err;
    EXPECT_THAT(several.out, HasSubstr(": 40 episodes (0 found on disk), 2,400 frames simulated"));
    EXPECT_EQ(runTaxelsim(evaluating({"--json", "--processes", number})).out, table.out);
  }
}

TEST_F(Processes, GiveTheBytesAndTheTableOfOneForGrasps) {
  const std::string grasp = TAXELSIM_SOURCE_DIR "/scenes/gripper_grasp.yaml";
  for (const std::string number : {"1", "2"}) {
    const Outcome outcome =
        succeed({"--log-level", "warning", "generate", grasp, "-o", root_ / number, "--episodes", "33", "--processes", number});
    EXPECT_EQ(outcome.err, "");
  }
  EXPECT_EQ(filesOf(root_ / "2"), filesOf(root_ / "1"));
  const std::vector<std::string> words{"evaluate", grasp, "--episodes", "5", "--gain", "5", "--gain", "20", "--json"};
  const Outcome one = succeed(words);
  const Outcome several = runTaxelsim(joined(words, {"--processes", "2"}));
  EXPECT_EQ(several.out, one.out) << several.err;
  EXPECT_EQ(count(several.err, "10 of 10 episodes"), 1u) << several.err;
}

TEST_F(Processes, ExtendARangeRepairAndPlayPartsAsOneDoes) {
  succeed(generating("one", {}));
  const std::string out = root_ / "out";
  succeed(generating("out", {"--episodes", "8", "--processes", "2"}));
  const Outcome part = runTaxelsim(generating("out", {"--episodes", "8", "--processes", "2", "--part", "1/2"}));
  EXPECT_THAT(part.out, HasSubstr("shards 0 to 3 of 8 complete, 4 episodes (4 found on disk)")) << part.out << part.err;
  const Outcome extended = runTaxelsim(generating("out", {"--processes", "2"}));
  EXPECT_THAT(extended.out, HasSubstr("40 episodes (8 found on disk), 1,920 frames")) << extended.out << extended.err;
  EXPECT_EQ(filesOf(out), filesOf(root_ / "one"));

  std::ofstream(out + "/shard-000030.h5") << "damaged";
  expectRefused(runTaxelsim(joined({"--log-level", "error"}, generating("out", {"--processes", "2"}))), "shard-000030.h5: its SHA-256 is");
  const Outcome repaired = succeed(generating("out", {"--processes", "2", "--repair"}));
  EXPECT_EQ(count(repaired.err, "the shard is removed and made again"), 1u) << repaired.err;
  EXPECT_EQ(filesOf(out), filesOf(root_ / "one"));

  for (const std::string number : {"1", "2"})
    succeed(evaluating({"--episode-range", "5..39", "-o", root_ / number, "--processes", number}));
  EXPECT_EQ(filesOf(root_ / "2"), filesOf(root_ / "1"));
  const Outcome again = runTaxelsim(evaluating({"--episode-range", "5..39", "-o", root_ / "2", "--processes", "2"}));
  EXPECT_THAT(again.out, HasSubstr("35 episodes per controller found on disk")) << again.out << again.err;
}

TEST_F(Processes, AreStoppedByAnInterruptAndResume) {
  const std::vector<std::string> episodes{"--episodes", "150"};  // seconds in small batches, interrupted at the first shard
  succeed(generating("one", episodes));
  for (const bool to_group : {true, false}) {  // of a terminal, or of `kill`
    const std::string name = to_group ? "group" : "parent";
    RunningTaxelsim program(generating(name, joined(long_run_, episodes)));
    const std::vector<pid_t> processes = processesOf(program, 3);
    ASSERT_EQ(processes.size(), 3u) << program.wait().err;
    while (numShards(root_ / name) == 0) std::this_thread::sleep_for(kPeriod);
    kill(to_group ? -program.process() : program.process(), SIGINT);
    const Outcome stopped = program.wait();
    EXPECT_EQ(stopped.status, 130) << stopped.err;
    EXPECT_EQ(count(stopped.err, "stopped: " + std::to_string(numShards(root_ / name)) + " of 150 episodes are in"), 1u) << stopped.err;
    for (const pid_t process : processes) EXPECT_EQ(statusOf(process).state, 'X') << "ended before the program";
    succeed(generating(name, joined({"--processes", "2"}, episodes)));
    EXPECT_EQ(filesOf(root_ / name), filesOf(root_ / "one"));
  }
  RunningTaxelsim program(evaluating(joined(long_run_, episodes)));
  ASSERT_EQ(processesOf(program, 3).size(), 3u) << program.wait().err;
  kill(-program.process(), SIGINT);
  const Outcome stopped = program.wait();
  EXPECT_EQ(stopped.status, 130) << stopped.err;
  EXPECT_THAT(stopped.err, HasSubstr(" of 2 controllers are evaluated"));
}

TEST_F(Processes, AreLeftBehindByNoSecondInterrupt) {
  RunningTaxelsim program(generating("out", long_run_));
  const std::vector<pid_t> processes = processesOf(program, 3);
  ASSERT_EQ(processes.size(), 3u) << program.wait().err;
  kill(processes[0], SIGSTOP);  // the first interrupt waits for it without end
  while (statusOf(program.process()).state != 'Z') {
    kill(program.process(), SIGINT);
    std::this_thread::sleep_for(kPeriod);
  }
  EXPECT_EQ(program.wait().status, 128 + SIGINT);
  kill(processes[0], SIGCONT);  // it may have been stopped before it asked the kernel to end with its parent
  for (const pid_t process : processes) waitForEnd(process);
}

TEST_F(Processes, EndWithTheProgram) {
  for (const bool is_generate : {true, false}) {
    RunningTaxelsim program(is_generate ? generating("out", long_run_) : evaluating(long_run_));
    const std::vector<pid_t> processes = processesOf(program, 3);
    ASSERT_EQ(processes.size(), 3u) << program.wait().err;
    kill(program.process(), SIGKILL);
    for (const pid_t process : processes) waitForEnd(process);
    EXPECT_EQ(program.wait().status, 128 + SIGKILL);
  }
  succeed(generating("out", {}));
}

TEST_F(Processes, ThatAreKilledGiveOneLineAndTheRunContinues) {
  succeed(generating("one", {}));
  for (const bool is_generate : {true, false}) {
    RunningTaxelsim program(joined({"--log-level", "error"}, is_generate ? generating("out", long_run_) : evaluating(long_run_)));
    const std::vector<pid_t> processes = processesOf(program, 3);
    ASSERT_EQ(processes.size(), 3u) << program.wait().err;
    kill(processes[0], SIGKILL);
    const Outcome outcome = program.wait();
    EXPECT_EQ(outcome.status, 1) << outcome.err;
    EXPECT_TRUE(outcome.err.starts_with("taxelsim: process ")) << outcome.err;
    EXPECT_TRUE(outcome.err.ends_with(" of 3: killed by signal 9 (Killed)\n")) << outcome.err;
    EXPECT_EQ(count(outcome.err, "\n"), 1u) << outcome.err;
    EXPECT_EQ(outcome.out, "");
    for (const pid_t process : processes) EXPECT_EQ(statusOf(process).state, 'X') << "ended before the program";
  }
  succeed(generating("out", long_run_));
  EXPECT_EQ(filesOf(root_ / "out"), filesOf(root_ / "one"));
}

TEST_F(Processes, NumbersThatAreNoneAndFormerOptionsAreRefused) {
  for (const char* value : {"0", "-1", "x", "1000000000", "1.5"}) {
    expectRefused(runTaxelsim(generating("out", {"--processes", value})), "--processes: ");
    expectRefused(runTaxelsim(evaluating({"--processes", value})), "--processes: ");
  }
  expectRefused(runTaxelsim(generating("out", {"--workers", "2"})), "--workers: is --processes now");
  expectRefused(runTaxelsim(evaluating({"--workers=2"})), "--workers: is --processes now");
  const std::vector<std::string> quiet{"--log-level", "error"};
  expectRefused(runTaxelsim(joined(quiet, evaluating({"--processes", "2", "--controller", "unknown"}))),
                "controller unknown: not in this scene");
  const Outcome no_device = runTaxelsim(joined(quiet, generating("out", {"--processes", "2", "--device", "unknown"})));
  EXPECT_NE(no_device.status, 0);
  EXPECT_EQ(count(no_device.err, "\n"), 1u) << no_device.err;
  EXPECT_FALSE(std::filesystem::exists(root_ / "out"));
}

}  // namespace
}  // namespace taxelsim::testing
