// Files that are made to break their reader: HDF5 that crashes, hangs, or claims more than it holds. Isolated readers refuse them in
// bounded time and memory.
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <future>
#include <thread>

#include "dataset/child_reading.h"
#include "dataset/column_io.h"
#include "dataset/example.h"
#include "dataset/shard_listing.h"

namespace taxelsim::testing {
namespace {

using dataset::readInChild;

constexpr std::size_t kFlipStride = 101;  // bytes between flipped bits; prime, so that every bit of a byte is flipped somewhere

// A data set of one shard whose only column of frames is `data/x`, float32.
Manifest oneColumn() {
  Manifest manifest = exampleManifest();
  manifest.num_episodes = manifest.episodes_per_shard = 2;
  manifest.columns = {{"data/x", ScalarType::kFloat32, {}, "N", "A number.", false}};
  return manifest;
}

std::string problemOf(const std::filesystem::path& directory) {
  return checkShards(directory, /*contents=*/true, /*isolated=*/true)[0].problem;
}

TEST(ReadInChild, ReturnsTheBytesAndTheProblem) {
  const TemporaryDirectory directory;
  std::vector<std::byte> bytes(5000);
  readInChild(directory / "f", bytes, [](std::span<std::byte> buffer) { std::fill(buffer.begin(), buffer.end(), std::byte{7}); });
  EXPECT_EQ(bytes, std::vector<std::byte>(5000, std::byte{7}));
  expectError(ErrorKind::kInput, "it is bad",
              [&] { readInChild(directory / "f", bytes, [](std::span<std::byte>) { throw Error(ErrorKind::kInput, "it is bad"); }); });
}

TEST(ReadInChild, SurvivesCrashes) {
  const TemporaryDirectory directory;
  for (const int signal : {SIGSEGV, SIGABRT, SIGBUS}) {
    expectError(ErrorKind::kInput, "file: broken or hostile file: HDF5 crashed on it (signal " + std::to_string(signal) + ")",
                [&] { readInChild(directory / "file", {}, [&](std::span<std::byte>) { raise(signal); }); });
  }
  expectError(ErrorKind::kInput, "HDF5 crashed on it",
              [&] { readInChild(directory / "file", {}, [](std::span<std::byte>) { _exit(0); }); });
}

TEST(ReadInChild, EndsWhatHangs) {
  const TemporaryDirectory directory;
  const auto start = std::chrono::steady_clock::now();
  expectError(ErrorKind::kInput, "took more than 1 s",
              [&] { readInChild(directory / "file", {}, [](std::span<std::byte>) { pause(); }, {.seconds = 1}); });
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(5));
}

TEST(ReadInChild, LimitsMemory) {
  const TemporaryDirectory directory;
  expectError(ErrorKind::kInput, "memory", [&] {
    readInChild(directory / "file", {}, [](std::span<std::byte>) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
      throw std::bad_alloc();  // their address space cannot be limited
#endif
      const std::vector<char> large(2 * dataset::ChildLimits().bytes, 'a');
      if (large[5] != 'a') _exit(1);
    });
  });
}

// Workers of torch are forked while other threads read.
TEST(Hdf5Session, IsFreeInAForkedChild) {
  std::promise<void> held;
  std::thread other([&] {
    const dataset::Hdf5Session session;
    held.set_value();
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
  });
  held.get_future().wait();
  const pid_t child = fork();
  if (child == 0) {
    alarm(10);
    const dataset::Hdf5Session session;
    _exit(0);
  }
  int status = -1;
  EXPECT_EQ(waitpid(child, &status, 0), child);
  EXPECT_EQ(status, 0) << "the child waits for a thread that it does not have";
  other.join();
}

// Not even a child reads what cannot be a shard.
TEST(Hostile, CountsAreComparedWithTheSizeOfTheFile) {
  const TemporaryDirectory directory;
  writeExample(directory / "d", oneColumn());
  std::string text = filesIn(directory / "d")["dataset.yaml"];
  for (const std::string key : {"num_episodes: ", "episodes_per_shard: "})
    text.replace(text.find(key + "2"), key.size() + 1, key + "1000000");
  overwrite(directory / "d/dataset.yaml", text);
  for (const std::string& problem : {problemOf(directory / "d"), checkView(directory / "d").problem})
    EXPECT_NE(problem.find("too few for the 1000000 episodes of the manifest"), std::string::npos) << problem;
}

// Writes data/x of a shard again, as `create` does, and renews the checksum, as an attacker would.
template <typename Create>
void replaceColumn(const std::filesystem::path& shard, hsize_t num_rows, Create create) {
  {
    const dataset::Hdf5Session session;
    const dataset::Handle file(H5Fopen(shard.c_str(), H5F_ACC_RDWR, H5P_DEFAULT), H5Fclose);
    dataset::checked(H5Ldelete(file, "data/x", H5P_DEFAULT));
    const dataset::Handle space(H5Screate_simple(1, &num_rows, nullptr), H5Sclose);
    const dataset::Handle properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    create(static_cast<hid_t>(file), static_cast<hid_t>(space), static_cast<hid_t>(properties));
  }
  renewChecksum(shard);
}

void createColumn(hid_t file, hid_t space, hid_t properties) {
  const dataset::Handle data(H5Dcreate2(file, "data/x", H5T_IEEE_F32LE, space, H5P_DEFAULT, properties, H5P_DEFAULT), H5Dclose);
  dataset::writeColumnAttributes(data, oneColumn().columns[0]);
}

class HostileColumn : public ::testing::Test {
 protected:
  HostileColumn() { writeExample(directory_ / "d", oneColumn()); }

  const hsize_t num_rows_ = exampleLength(0) + exampleLength(1);
  TemporaryDirectory directory_;
  std::filesystem::path shard_ = directory_ / "d/shard-000000.h5";
};

// One child process reads several shards; a broken one among them is found and named, and does not harm the others.
TEST(Hostile, ShardsThatAreReadTogetherDoNotHideABrokenOne) {
  const TemporaryDirectory directory;
  const Manifest manifest = exampleManifest();
  writeExample(directory / "d", manifest);
  const auto rowsOf = [&](bool isolated) {
    const DatasetReader reader(directory / "d", /*allow_incomplete=*/false, isolated);
    std::vector<std::vector<std::byte>> rows;
    for (const Column& column : manifest.columns)
      rows.push_back(reader.read(column.name, 1, (column.per_episode ? reader.numEpisodes() : reader.numFrames()) - 2));
    return rows;
  };
  EXPECT_EQ(rowsOf(/*isolated=*/true), rowsOf(/*isolated=*/false)) << "from within the first shard to within the last one";
  const std::filesystem::path file = directory / "d/shard-000001.h5";
  std::string bytes = filesIn(directory / "d")["shard-000001.h5"];
  bytes.replace(0, 8, "no HDF5.");
  overwrite(file, bytes);
  renewChecksum(file);
  const std::vector<ShardStatus> statuses = checkShards(directory / "d", /*contents=*/true, /*isolated=*/true);
  ASSERT_EQ(statuses.size(), 3u);
  for (const ShardStatus& status : statuses)
    EXPECT_EQ(status.state, status.shard == 1 ? ShardStatus::State::kBroken : ShardStatus::State::kWhole) << status.problem;
  expectError(ErrorKind::kInput, "shard-000001.h5: broken or foreign shard", [&] { rowsOf(/*isolated=*/true); });
}

TEST_F(HostileColumn, HasItsRowsInTheFile) {
  replaceColumn(shard_, num_rows_, createColumn);
  EXPECT_NE(problemOf(directory_ / "d").find("more than its 0 bytes"), std::string::npos) << "never written, so that HDF5 reads zeros";
  replaceColumn(shard_, num_rows_, [](hid_t file, hid_t space, hid_t properties) {
    const hsize_t chunk = 1;
    dataset::checked(H5Pset_chunk(properties, 1, &chunk));
    createColumn(file, space, properties);
  });
  EXPECT_NE(problemOf(directory_ / "d").find("more than its 0 bytes"), std::string::npos) << "no chunk";
}

TEST_F(HostileColumn, HasNoLinks) {
  std::filesystem::copy_file(shard_, directory_ / "elsewhere.h5");
  replaceColumn(shard_, num_rows_, [&](hid_t file, hid_t, hid_t) {
    dataset::checked(H5Lcreate_external("../elsewhere.h5", "/data/x", file, "data/x", H5P_DEFAULT, H5P_DEFAULT));
  });
  EXPECT_NE(problemOf(directory_ / "d").find("data/x is a link"), std::string::npos) << problemOf(directory_ / "d");
}

TEST_F(HostileColumn, IsNotStoredElsewhere) {
  overwrite(directory_ / "secret", "this text is in another file than the shard");
  replaceColumn(shard_, num_rows_, [&](hid_t file, hid_t space, hid_t properties) {
    dataset::checked(H5Pset_external(properties, (directory_ / "secret").c_str(), 0, H5F_UNLIMITED));
    createColumn(file, space, properties);
  });
  EXPECT_NE(problemOf(directory_ / "d").find("is not stored in this file"), std::string::npos) << problemOf(directory_ / "d");
}

TEST_F(HostileColumn, HasNoOtherFilters) {
  replaceColumn(shard_, num_rows_, [&](hid_t file, hid_t space, hid_t properties) {
    dataset::checked(H5Pset_chunk(properties, 1, &num_rows_));
    dataset::checked(H5Pset_fletcher32(properties));
    dataset::checked(H5Pset_alloc_time(properties, H5D_ALLOC_TIME_EARLY));
    createColumn(file, space, properties);
  });
  EXPECT_NE(problemOf(directory_ / "d").find("another filter"), std::string::npos) << problemOf(directory_ / "d");
}

TEST_F(HostileColumn, HasChunksOfLimitedSize) {
  replaceColumn(shard_, num_rows_, [&](hid_t file, hid_t space, hid_t properties) {
    const hsize_t chunk = kMaxChunkBytes / 4 + 1;  // rows
    const hsize_t unlimited = H5S_UNLIMITED;
    dataset::checked(H5Sset_extent_simple(space, 1, &num_rows_, &unlimited));
    dataset::checked(H5Pset_chunk(properties, 1, &chunk));
    dataset::checked(H5Pset_deflate(properties, 9));
    createColumn(file, space, properties);
    const dataset::Handle data(H5Dopen2(file, "data/x", H5P_DEFAULT), H5Dclose);
    const std::vector<float> rows(num_rows_);
    dataset::checked(H5Dwrite(data, H5T_NATIVE_FLOAT, H5S_ALL, H5S_ALL, H5P_DEFAULT, rows.data()));
  });
  EXPECT_NE(problemOf(directory_ / "d").find("chunks of another shape"), std::string::npos) << problemOf(directory_ / "d");
}

// A flipped bit is found, or the file is read; the parent survives. `renew`: with a checksum that an attacker has made.
void flipBits(const std::filesystem::path& directory, bool renew) {
  const std::filesystem::path shard = directory / "shard-000000.h5";
  std::string bytes = filesIn(directory)["shard-000000.h5"];
  for (std::size_t i = 0; i < bytes.size(); i += kFlipStride) {
    bytes[i] ^= static_cast<char>(1 << i % 8);
    overwrite(shard, bytes);
    if (renew) renewChecksum(shard);
    const std::string problem = problemOf(directory);
    EXPECT_EQ(problem.find('\n'), std::string::npos);
    EXPECT_TRUE(problem.empty() || problem.find("shard-000000.h5") != std::string::npos) << problem;
    bytes[i] ^= static_cast<char>(1 << i % 8);
  }
}

TEST(Hostile, FlippedBitsDoNotReachTheParent) {
  const TemporaryDirectory directory;
  Manifest manifest = oneColumn();
  writeExample(directory / "plain", manifest);
  flipBits(directory / "plain", /*renew=*/true);
  manifest.compression = 4;
  writeExample(directory / "compressed", manifest);
  flipBits(directory / "compressed", /*renew=*/true);
  std::filesystem::copy(TAXELSIM_SOURCE_DIR "/tests/dataset/data/format_1", directory / "format_1");
  flipBits(directory / "format_1", /*renew=*/false);
}

TEST(Hostile, IsolatedReadersGiveTheSameValues) {
  const TemporaryDirectory directory;
  writeExample(directory / "d", exampleManifest());
  const DatasetReader reader(directory / "d"), isolated(directory / "d", false, /*isolated=*/true);
  EXPECT_EQ(isolated.episodeEnds(), reader.episodeEnds());
  for (const Column& column : exampleManifest().columns) {
    const std::uint64_t count = column.per_episode ? reader.numEpisodes() : reader.numFrames();
    EXPECT_EQ(isolated.read(column.name, 0, count), reader.read(column.name, 0, count)) << column.name;
  }
}

TEST(Hostile, ShardsAreRegularFilesOfTheirNames) {
  const TemporaryDirectory directory;
  const Manifest manifest = exampleManifest();
  writeExample(directory / "d", manifest);
  std::filesystem::remove(directory / "d/shard-000001.h5");
  for (const char* name : {"shard-1.h5", "shard-0000001.h5", "shard-000009.h5", "shard-000001.h5x", "shard-.h5"})
    overwrite(directory / "d" / name, "");
  EXPECT_EQ(dataset::shardsOnDisk(directory / "d", manifest), (std::vector<bool>{true, false, true}));
  ASSERT_EQ(mkfifo((directory / "d/shard-000001.h5").c_str(), 0600), 0);
  EXPECT_NE(checkShards(directory / "d", true)[1].problem.find("not a regular file"), std::string::npos) << "a FIFO does not block";
  std::filesystem::remove(directory / "d/dataset.yaml");
  ASSERT_EQ(mkfifo((directory / "d/dataset.yaml").c_str(), 0600), 0);
  expectError(ErrorKind::kInput, "dataset.yaml: not a regular file", [&] { readManifest(directory / "d"); });
  expectError(ErrorKind::kInput, "dataset.yaml: not a regular file", [&] { DatasetWriter(directory / "d", manifest); });
}

}  // namespace
}  // namespace taxelsim::testing
