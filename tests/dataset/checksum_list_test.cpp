// dataset.checksums vouches for shards that have not changed, and for no others; each process hashes a file once.
#include "dataset/checksum_list.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>

#include "dataset/example.h"

namespace taxelsim::testing {
namespace {

namespace fs = std::filesystem;

// Until files that are written now get a later time than `file` has.
void waitForClockOfFiles(const fs::path& file) {
  const TemporaryDirectory directory;
  const std::int64_t changed = dataset::stampOf(file).changed;
  do {
    std::ofstream(directory / "now") << "x";
  } while (dataset::stampOf(directory / "now").changed <= changed);
}

// A complete data set whose list is later than its shards.
void writeListedExample(const fs::path& directory) {
  writeExample(directory, exampleManifest());
  waitForClockOfFiles(directory / "dataset.checksums");
  fs::remove(directory / "dataset.checksums");
  { const DatasetWriter writer(directory, exampleManifest()); }
  waitForClockOfFiles(directory / "dataset.checksums");
}

std::vector<ShardStatus> quick(const fs::path& directory) {
  return checkShards(directory, /*contents=*/false);
}

TEST(ChecksumList, VouchesForUnchangedShards) {
  const TemporaryDirectory directory;
  writeListedExample(directory / "d");
  for (const ShardStatus& status : quick(directory / "d")) {
    EXPECT_EQ(status.state, ShardStatus::State::kWhole);
    EXPECT_TRUE(status.is_vouched_for);
  }
  for (const ShardStatus& status : checkShards(directory / "d", /*contents=*/true)) EXPECT_FALSE(status.is_vouched_for);
}

TEST(ChecksumList, MissingShortenedAndTouchedShardsAreNoticed) {
  const TemporaryDirectory directory;
  writeListedExample(directory / "d");
  const fs::path shard = directory / "d/shard-000001.h5";
  const std::string whole = filesIn(directory / "d")["shard-000001.h5"];
  const auto statusOf = [&] { return quick(directory / "d")[1]; };

  fs::last_write_time(shard, fs::file_time_type::clock::now());
  EXPECT_EQ(statusOf().state, ShardStatus::State::kWhole);
  EXPECT_FALSE(statusOf().is_vouched_for) << "touched, and read again";

  const auto old_time = fs::last_write_time(directory / "d/shard-000000.h5");
  std::string changed = whole;
  changed[changed.size() / 2] ^= 1;
  overwrite(shard, changed);
  fs::last_write_time(shard, old_time);
  EXPECT_EQ(statusOf().state, ShardStatus::State::kBroken) << "with its old size and time of modification";

  overwrite(shard, whole.substr(0, whole.size() - 1));
  EXPECT_EQ(statusOf().state, ShardStatus::State::kBroken) << "shortened";

  fs::remove(shard);
  EXPECT_EQ(statusOf().state, ShardStatus::State::kMissing);
  EXPECT_TRUE(quick(directory / "d")[0].is_vouched_for) << "the others are unchanged";
}

TEST(ChecksumList, ChangedChecksumFilesAreNoticed) {
  const TemporaryDirectory directory;
  writeListedExample(directory / "d");
  overwrite(directory / "d/shard-000001.h5.sha256", filesIn(directory / "d")["shard-000000.h5.sha256"]);
  EXPECT_NE(quick(directory / "d")[1].problem.find("is not a line of sha256sum for shard-000001.h5"), std::string::npos);
}

TEST(ChecksumList, AShardOfTheSameTickAsTheListIsRead) {
  const TemporaryDirectory directory;
  writeListedExample(directory / "d");
  const fs::path shard = directory / "d/shard-000000.h5";
  const dataset::ChecksumList list(directory / "d", 3);
  EXPECT_TRUE(list.vouchesFor(0, shard));
  const timespec times[2] = {{.tv_sec = 0, .tv_nsec = UTIME_OMIT}, {.tv_sec = 4'000'000'000, .tv_nsec = 0}};
  ASSERT_EQ(utimensat(AT_FDCWD, (directory / "d/dataset.checksums").c_str(), times, 0), 0);
  ASSERT_EQ(utimensat(AT_FDCWD, shard.c_str(), times, 0), 0);
  EXPECT_FALSE(dataset::ChecksumList(directory / "d", 3).vouchesFor(0, shard)) << "equal times";
}

// A list that is written again is later than the change, as if the clock had been set back for the change.
TEST(ChecksumList, AChangeThatSeemsOlderThanTheListIsFoundBeforeItsRowsAreUsed) {
  const TemporaryDirectory directory;
  writeListedExample(directory / "d");
  const auto files = filesIn(directory / "d");
  std::string changed = files.at("shard-000001.h5");
  changed[changed.size() / 2] ^= 1;
  overwrite(directory / "d/shard-000001.h5", changed);
  waitForClockOfFiles(directory / "d/shard-000001.h5");
  overwrite(directory / "d/dataset.checksums", files.at("dataset.checksums"));
  EXPECT_TRUE(quick(directory / "d")[1].is_vouched_for);
  EXPECT_EQ(checkShards(directory / "d", /*contents=*/true)[1].state, ShardStatus::State::kBroken);
  const DatasetReader reader(directory / "d");
  expectError(ErrorKind::kInput, "shard-000001.h5", [&] { reader.readAsDouble(exampleManifest().columns[0].name, 0, reader.numFrames()); });
}

TEST(ChecksumList, DamagedListsVouchForNothing) {
  const TemporaryDirectory directory;
  writeListedExample(directory / "d");
  const fs::path list = directory / "d/dataset.checksums";
  const std::string text = filesIn(directory / "d")["dataset.checksums"];
  const std::string line = text.substr(0, text.find('\n') + 1);
  for (const std::string& damaged :
       {std::string("x"), line + line, line.substr(0, 70), "../" + line, line + std::string(100, 'a'),
        line.substr(0, 65) + "-1 shard-000000.h5\n", line.substr(0, line.rfind(' ')) + " ../shard-000000.h5\n"}) {
    overwrite(list, damaged);
    EXPECT_FALSE(dataset::ChecksumList(directory / "d", 3).vouchesFor(0, directory / "d/shard-000000.h5")) << damaged;
    for (const ShardStatus& status : quick(directory / "d")) EXPECT_EQ(status.problem, "");
  }
  fs::remove(list);
  ASSERT_EQ(mkfifo(list.c_str(), 0600), 0);
  EXPECT_EQ(quick(directory / "d")[0].problem, "") << "a FIFO is not read";
  fs::remove(list);
  EXPECT_EQ(quick(directory / "d")[0].problem, "") << "a data set of an earlier version";
}

TEST(ChecksumList, AWriterReadsWhatItDoesNotVouchForOnly) {
  const TemporaryDirectory directory;
  writeListedExample(directory / "d");
  const dataset::FileStamp listed = dataset::stampOf(directory / "d/dataset.checksums");
  { const DatasetWriter writer(directory / "d", exampleManifest()); }
  EXPECT_EQ(dataset::stampOf(directory / "d/dataset.checksums"), listed) << "nothing was read, the list is as it was";
  fs::last_write_time(directory / "d/shard-000001.h5", fs::file_time_type::clock::now());
  { const DatasetWriter writer(directory / "d", exampleManifest()); }
  EXPECT_NE(dataset::stampOf(directory / "d/dataset.checksums"), listed) << "one shard was read";
}

TEST(ChecksumList, IsNotWrittenForAShardThatChangesMeanwhile) {
  const TemporaryDirectory directory;
  writeListedExample(directory / "d");
  std::vector<dataset::HashedShard> shards(3);
  for (int i = 0; i < 3; ++i)
    shards[i] = {std::string(64, 'a'), dataset::stampOf(directory / ("d/shard-00000" + std::to_string(i) + ".h5"))};
  dataset::writeChecksumList(directory / "d", shards);
  fs::last_write_time(directory / "d/shard-000002.h5", fs::file_time_type::clock::now());
  expectError(ErrorKind::kIo, "shard-000002.h5: another program changed it", [&] { dataset::writeChecksumList(directory / "d", shards); });
  EXPECT_FALSE(fs::exists(directory / "d/dataset.checksums"));
}

// The checksum file is read with the shard, so that a damaged one shows whether a process verifies again.
TEST(Reader, HashesAShardOncePerProcess) {
  const TemporaryDirectory directory;
  writeListedExample(directory / "d");
  const auto read = [&] {
    const DatasetReader reader(directory / "d");
    return reader.readAsDouble("data/total_force", 0, reader.numFrames());
  };
  const std::vector<double> values = read();
  const fs::path shard = directory / "d/shard-000001.h5";
  const std::string line = filesIn(directory / "d")["shard-000001.h5.sha256"];
  overwrite(fs::path(shard).concat(".sha256"), "damaged");
  EXPECT_EQ(read(), values) << "verified before";
  fs::last_write_time(shard, fs::file_time_type::clock::now());
  expectError(ErrorKind::kInput, "is not a line of sha256sum", read);
  overwrite(fs::path(shard).concat(".sha256"), line);
  EXPECT_EQ(read(), values);
}

}  // namespace
}  // namespace taxelsim::testing
