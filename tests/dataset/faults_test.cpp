// A disk or a network file system that fails at the nth call: full at a write, an error of fsync(), rename() or ftruncate(), a stale mount
// at any of them or at a read, once or from then on. Every file that has its name is complete, no temporary file remains, and resuming
// gives the same bytes. The calls of the library arrive here, because a program's functions take precedence over libc's.
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>

#include "dataset/example.h"
#include "support/cases.h"
#include "taxelsim/version.h"

namespace {

enum class Call { kWrite, kFsync, kRename, kTruncate, kRead, kAllButRead };

std::atomic<Call> failing_call;
std::atomic<int> failing_code;                            // errno; 0: that of a disk, ENOSPC or EIO
std::atomic<int> num_calls, first_failing, last_failing;  // of that kind, from 1; counted where first_failing is not 0

bool fails(Call call, int code) {
  if (first_failing == 0 || (call != failing_call && (failing_call != Call::kAllButRead || call == Call::kRead))) return false;
  const int number = ++num_calls;
  if (number < first_failing || number > last_failing) return false;
  errno = failing_code != 0 ? failing_code.load() : code;
  return true;
}

}  // namespace

extern "C" {
ssize_t pwrite(int file, const void* data, size_t size, off_t offset) {
  return fails(Call::kWrite, ENOSPC) ? -1 : syscall(SYS_pwrite64, file, data, size, offset);
}
ssize_t read(int file, void* data, size_t size) {
  return fails(Call::kRead, EIO) ? -1 : syscall(SYS_read, file, data, size);
}
ssize_t pread(int file, void* data, size_t size, off_t offset) {
  return fails(Call::kRead, EIO) ? -1 : syscall(SYS_pread64, file, data, size, offset);
}
int fsync(int file) {
  return fails(Call::kFsync, EIO) ? -1 : static_cast<int>(syscall(SYS_fsync, file));
}
int rename(const char* from, const char* to) noexcept {
  return fails(Call::kRename, EIO) ? -1 : static_cast<int>(syscall(SYS_rename, from, to));
}
int ftruncate(int file, off_t size) noexcept {
  return fails(Call::kTruncate, ENOSPC) ? -1 : static_cast<int>(syscall(SYS_ftruncate, file, size));
}
}

namespace taxelsim::testing {
namespace {

constexpr int kNever = 1'000'000'000;
constexpr int kStride = 6;  // of the calls that fail; with TAXELSIM_CASES=all each one does

constexpr int kSharedFaults = 8;  // first failing calls of several writers: those of the manifest and of the shards

struct Fault {
  Call call;
  bool lasts;  // all later calls fail as well
  int code = 0;
};

class FailingDisk : public ::testing::TestWithParam<Fault> {
 protected:
  ~FailingDisk() override { first_failing = failing_code = 0; }

  // Writes or resumes the data set while calls from the nth on fail. Returns the number of calls.
  int writeWithFault(const std::filesystem::path& target, int first) {
    num_calls = 0;
    failing_call = GetParam().call;
    failing_code = GetParam().code;
    last_failing = GetParam().lasts ? kNever : first;
    first_failing = first;
    try {
      resume(target);
      is_written_ = true;
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kIo) << error.what();
      is_written_ = false;
    }
    first_failing = 0;
    return num_calls;
  }

  void resume(const std::filesystem::path& target) {
    DatasetWriter writer(target, manifest_);
    for (std::uint64_t shard = 0; shard < manifest_.numShards(); ++shard)
      if (!writer.isComplete(shard)) writer.writeShard(shard, exampleShard(manifest_, shard));
    writer.finish();
  }

  const Manifest manifest_ = exampleManifest();
  TemporaryDirectory directory_;
  bool is_written_ = false;
};

TEST_P(FailingDisk, LosesNothing) {
  const int total = writeWithFault(directory_ / "complete", kNever);
  ASSERT_TRUE(is_written_);
  ASSERT_GT(total, 3) << "the calls do not arrive here";
  const auto complete = filesIn(directory_ / "complete");
  int num_faults = 0, num_errors = 0;
  for (int n = 1; n <= total; n += support::runsAllCases() ? 1 : kStride) {
    const std::filesystem::path target = directory_ / std::to_string(n);
    writeWithFault(target, n);
    ++num_faults;
    num_errors += !is_written_;
    if (std::filesystem::exists(target)) {
      for (const auto& [name, bytes] : filesIn(target)) {
        if (name == "dataset.checksums" || (name.starts_with(".") && !name.starts_with(".dataset") && !name.starts_with(".shard")))
          continue;
        ASSERT_TRUE(complete.contains(name)) << "call " << n << " left " << name;
        EXPECT_TRUE(complete.at(name) == bytes) << "call " << n << ": " << name;
      }
    }
    resume(target);
    EXPECT_TRUE(filesIn(target) == complete) << "resumed after a fault at call " << n;
  }
  std::cout << num_faults << " faults, " << num_errors << " errors" << std::endl;
  EXPECT_GT(2 * num_errors, num_faults);
}

// Three processes share a directory while the disk gets full for each of them, at another write.
TEST(FullDisk, OfSeveralWritersLosesNothing) {
  const TemporaryDirectory directory;
  Manifest manifest = exampleManifest();
  manifest.program_version = kVersion;
  const DatasetWriterOptions all{.shards = ShardRange{.first = 0, .end = manifest.numShards()}};
  writeExample(directory / "one", manifest);
  const auto complete = filesIn(directory / "one");
  const auto work = [&](const std::filesystem::path& target) {
    DatasetWriter writer(target, manifest, all);
    for (std::uint64_t shard = 0; shard < manifest.numShards(); ++shard)
      if (writer.claim(shard)) writer.writeShard(shard, exampleShard(manifest, shard));
  };
  int num_errors = 0;
  for (int first = 1; first <= kSharedFaults; ++first) {
    const std::filesystem::path target = directory / std::to_string(first);
    std::array<pid_t, 3> children{};
    for (std::size_t i = 0; i < children.size(); ++i) {
      children[i] = fork();
      if (children[i] != 0) continue;
      failing_call = Call::kWrite;
      last_failing = kNever;
      first_failing = first + 2 * static_cast<int>(i);
      try {
        work(target);
        _exit(0);
      } catch (const Error& error) {
        _exit(error.kind() == ErrorKind::kIo ? 3 : 4);
      }
    }
    for (const pid_t child : children) {
      int status = -1;
      waitpid(child, &status, 0);
      ASSERT_TRUE(WIFEXITED(status));
      EXPECT_TRUE(WEXITSTATUS(status) == 0 || WEXITSTATUS(status) == 3) << WEXITSTATUS(status);
      num_errors += WEXITSTATUS(status) == 3;
    }
    for (const auto& [name, bytes] : filesIn(target)) {
      if (name.starts_with(".l") || name.starts_with(".c")) continue;  // .lock, .claims
      ASSERT_TRUE(complete.contains(name)) << "fault at " << first << " left " << name;
      EXPECT_TRUE(complete.at(name) == bytes) << name;
    }
    work(target);
    ASSERT_TRUE(finishDataset(target));
    EXPECT_TRUE(filesIn(target) == complete) << "after a fault at " << first;
  }
  EXPECT_GT(num_errors, kSharedFaults) << "the calls do not arrive here";
}

class FailingReads : public FailingDisk {};

// A complete data set is verified, resumed and read while reads fail: an error, or the values; no file changes.
TEST_P(FailingReads, AreErrorsAndChangeNothing) {
  const std::filesystem::path target = directory_ / "d";
  resume(target);
  std::filesystem::remove(target / "dataset.checksums");  // otherwise its list vouches for the shards
  const auto complete = filesIn(target);
  const auto withoutList = [](std::map<std::string, std::string> files) {
    files.erase("dataset.checksums");
    return files;
  };
  const int total = writeWithFault(target, kNever);
  ASSERT_GT(total, 8) << "the calls do not arrive here";
  int num_errors = 0;
  for (int n = 1; n <= total; ++n) {
    std::filesystem::remove(target / "dataset.checksums");
    writeWithFault(target, n);
    num_errors += !is_written_;
    EXPECT_TRUE(withoutList(filesIn(target)) == complete) << "call " << n;
  }
  std::cout << total << " faults, " << num_errors << " errors" << std::endl;
  EXPECT_GT(4 * num_errors, 3 * total) << "others are those of an old view, which is written again";
}

std::string nameOf(const ::testing::TestParamInfo<Fault>& tested) {
  constexpr std::array<const char*, 6> kNames{"Write", "Fsync", "Rename", "Truncate", "Read", "Mount"};
  const std::string code = tested.param.code == ESTALE ? "Stale" : tested.param.code == EIO ? "InputOutput" : "";
  return kNames[static_cast<std::size_t>(tested.param.call)] + code + (tested.param.lasts ? "Lasting" : "Once");
}

INSTANTIATE_TEST_SUITE_P(Calls, FailingDisk,
                         ::testing::Values(Fault{Call::kWrite, false}, Fault{Call::kWrite, true}, Fault{Call::kFsync, false},
                                           Fault{Call::kFsync, true}, Fault{Call::kRename, false}, Fault{Call::kTruncate, false},
                                           Fault{Call::kWrite, false, EIO}, Fault{Call::kRename, false, ESTALE},
                                           Fault{Call::kAllButRead, true, ESTALE}),
                         nameOf);

INSTANTIATE_TEST_SUITE_P(Calls, FailingReads,
                         ::testing::Values(Fault{Call::kRead, false, EIO}, Fault{Call::kRead, true, EIO}, Fault{Call::kRead, false, ESTALE},
                                           Fault{Call::kRead, true, ESTALE}),
                         nameOf);

}  // namespace
}  // namespace taxelsim::testing
