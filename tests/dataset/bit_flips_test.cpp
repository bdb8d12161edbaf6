// Every flipped bit and every truncation of a small data set's files: minutes to an hour, so that the suites are studies (scripts/campaign
// flips). TAXELSIM_FLIP_STRIDE takes each n-th bit and truncation only.
#include <chrono>

#include "dataset/example.h"
#include "dataset/serial_reading.h"
#include "dataset/shard.h"
#include "support/test.h"

namespace taxelsim::testing {
namespace {

namespace fs = std::filesystem;

using Clock = std::chrono::steady_clock;

constexpr double kMaxSeconds = 10;  // of one file

std::size_t stride() {
  const char* text = std::getenv("TAXELSIM_FLIP_STRIDE");
  return text == nullptr ? 1 : std::max<std::size_t>(1, std::strtoull(text, nullptr, 10));
}

struct Tally {
  std::size_t num_files = 0;
  std::size_t num_found = 0;   // refused
  std::size_t num_killed = 0;  // of those, because HDF5 crashed or ran into a limit in its child
  double slowest = 0;          // s

  friend std::ostream& operator<<(std::ostream& stream, const Tally& t) {
    return stream << t.num_files << " files, " << t.num_found << " refused (" << t.num_killed
                  << " crashed, hung or asked for too much in the child), " << t.num_files - t.num_found << " read; slowest " << t.slowest
                  << " s";
  }
};

// Damage number `number` of a file: first each bit flips, then each shorter length is left.
std::size_t numDamages(const std::string& whole) {
  return 9 * whole.size();
}

std::string damaged(const std::string& whole, std::size_t number) {
  if (number >= 8 * whole.size()) return whole.substr(0, number - 8 * whole.size());
  std::string bytes = whole;
  bytes[number / 8] ^= static_cast<char>(1 << number % 8);
  return bytes;
}

// Damages one file of a data set in every way. `problemOf`: what a reader says of the data set.
template <typename Renew, typename ProblemOf>
Tally damage(const fs::path& file, Renew renew, ProblemOf problemOf) {
  const std::string whole = filesIn(file.parent_path())[file.filename().string()];
  Tally tally;
  const auto check = [&](const std::string& bytes, const std::string& what) {
    overwrite(file, bytes);
    renew(file);
    const Clock::time_point start = Clock::now();
    const std::string problem = problemOf();
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    EXPECT_LT(seconds, kMaxSeconds) << what;
    EXPECT_EQ(problem.find('\n'), std::string::npos) << what << problem;
    ++tally.num_files;
    tally.num_found += !problem.empty();
    tally.num_killed += problem.find("broken or hostile file") != std::string::npos;
    tally.slowest = std::max(tally.slowest, seconds);
  };
  for (std::size_t number = 0; number < numDamages(whole); number += stride())
    check(damaged(whole, number), "damage " + std::to_string(number) + ": ");
  overwrite(file, whole);
  renew(file);
  return tally;
}

Manifest smallManifest(int compression) {
  Manifest manifest = exampleManifest();
  manifest.num_episodes = manifest.episodes_per_shard = 2;
  manifest.columns = {{"data/x", ScalarType::kFloat32, {}, "N", "A number.", false}};
  manifest.compression = compression;
  return manifest;
}

std::string problemOfShard(const fs::path& directory) {
  try {
    return checkShards(directory, /*contents=*/true, /*isolated=*/true)[0].problem;
  } catch (const Error& error) {
    EXPECT_EQ(error.kind(), ErrorKind::kInput) << error.what();
    return error.what();
  }
}

std::string problemOfView(const fs::path& directory) {
  return checkView(directory, /*isolated=*/true).problem;
}

class BitFlipsStudy : public ::testing::TestWithParam<int> {
 protected:
  BitFlipsStudy() { writeExample(directory_ / "d", smallManifest(GetParam())); }

  template <typename Renew>
  Tally damageFile(const std::string& name, Renew renew) {
    const Tally tally = damage(directory_ / "d" / name, renew,
                               [&] { return name == "dataset.h5" ? problemOfView(directory_ / "d") : problemOfShard(directory_ / "d"); });
    std::cout << name << ", compression " << GetParam() << ": " << tally << std::endl;
    return tally;
  }

  TemporaryDirectory directory_;
};

TEST_P(BitFlipsStudy, KeptChecksumsFindAll) {
  for (const char* name : {"shard-000000.h5", "dataset.h5"}) {
    const Tally tally = damageFile(name, [](const fs::path&) {});
    EXPECT_EQ(tally.num_found, tally.num_files) << name;
  }
  // A process does not verify a file again that has not changed since.
  const fs::path shard = directory_ / "d/shard-000000.h5";
  const std::string bytes = filesIn(directory_ / "d")["shard-000000.h5"];
  const Tally tally = damageFile("shard-000000.h5.sha256", [&](const fs::path&) { overwrite(shard, bytes); });
  EXPECT_EQ(tally.num_found, tally.num_files);
}

TEST_P(BitFlipsStudy, RenewedChecksumsHarmNobody) {
  damageFile("shard-000000.h5", renewChecksum);
  damageFile("dataset.h5", renewChecksum);
}

// The manifest has no checksum; its shards repeat what it says of them. A damaged list of checksums vouches for nothing.
TEST_P(BitFlipsStudy, ManifestsHarmNobody) {
  damageFile("dataset.yaml", [](const fs::path&) {});
  damageFile("dataset.checksums", [](const fs::path&) {});
}

INSTANTIATE_TEST_SUITE_P(Compression, BitFlipsStudy, ::testing::Values(0, 4));

// Without checksums of files. HDF5 survives most damage, so that a process for each file would take hours: a child reads one file after
// another, and those that end it, by a crash or a limit, are read again as a program reads them.
TEST(FormatOneBitFlipsStudy, ShardsHarmNobody) {
  const TemporaryDirectory directory;
  fs::copy(TAXELSIM_SOURCE_DIR "/tests/dataset/data/format_1", directory / "d");
  const fs::path file = directory / "d/shard-000000.h5";
  const std::string whole = filesIn(directory / "d")["shard-000000.h5"];
  const Manifest manifest = readManifest(directory / "d");
  const std::vector<Outcome> outcomes = readSerially(numDamages(whole) / stride(), [&](std::size_t i) {
    overwrite(file, damaged(whole, i * stride()));
    dataset::checkShardFiles(std::array{dataset::ShardFile{file, 0}}, manifest, /*contents=*/true, dataset::Isolation::kNone);
  });
  Tally tally{.num_files = outcomes.size()};
  for (std::size_t i = 0; i < outcomes.size(); ++i) {
    tally.num_found += outcomes[i] != Outcome::kRead;
    if (outcomes[i] != Outcome::kEnded) continue;
    overwrite(file, damaged(whole, i * stride()));
    const Clock::time_point start = Clock::now();
    const std::string problem = problemOfShard(directory / "d");
    const double seconds = std::chrono::duration<double>(Clock::now() - start).count();
    tally.num_killed += problem.find("broken or hostile file") != std::string::npos;
    tally.slowest = std::max(tally.slowest, seconds);
    EXPECT_LT(seconds, kMaxSeconds) << i;
    EXPECT_EQ(problem.find('\n'), std::string::npos) << i << problem;
  }
  std::cout << "shard-000000.h5, format 1: " << tally << std::endl;
}

TEST(FormatOneBitFlipsStudy, ManifestsHarmNobody) {
  const TemporaryDirectory directory;
  fs::copy(TAXELSIM_SOURCE_DIR "/tests/dataset/data/format_1", directory / "d");
  std::cout << "dataset.yaml, format 1: "
            << damage(
                   directory / "d/dataset.yaml", [](const fs::path&) {}, [&] { return problemOfShard(directory / "d"); })
            << std::endl;
}

}  // namespace
}  // namespace taxelsim::testing
