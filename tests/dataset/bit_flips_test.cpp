// Every flipped bit and every truncation of a small data set's files: minutes to hours, so that the suites are studies (scripts/campaign
// flips). TAXELSIM_FLIP_STRIDE takes each n-th bit and truncation only.
#include <algorithm>
#include <chrono>
#include <cstdlib>

#include "dataset/example.h"

namespace taxelsim::testing {
namespace {

namespace fs = std::filesystem;

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

// Damages one file of a data set in every way. `problemOf`: what a reader says of the data set.
template <typename Renew, typename ProblemOf>
Tally damage(const fs::path& file, Renew renew, ProblemOf problemOf) {
  const std::string whole = filesIn(file.parent_path())[file.filename().string()];
  Tally tally;
  const auto check = [&](const std::string& bytes, const std::string& what) {
    overwrite(file, bytes);
    renew(file);
    const auto start = std::chrono::steady_clock::now();
    const std::string problem = problemOf();
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    EXPECT_LT(seconds, kMaxSeconds) << what;
    EXPECT_EQ(problem.find('\n'), std::string::npos) << what << problem;
    ++tally.num_files;
    tally.num_found += !problem.empty();
    tally.num_killed += problem.find("broken or hostile file") != std::string::npos;
    tally.slowest = std::max(tally.slowest, seconds);
  };
  for (std::size_t bit = 0; bit < 8 * whole.size(); bit += stride()) {
    std::string bytes = whole;
    bytes[bit / 8] ^= static_cast<char>(1 << bit % 8);
    check(bytes, "bit " + std::to_string(bit) + ": ");
  }
  for (std::size_t size = 0; size < whole.size(); size += stride()) check(whole.substr(0, size), "cut to " + std::to_string(size) + ": ");
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

// Without checksums of files.
TEST(FormatOneBitFlipsStudy, HarmNobody) {
  const TemporaryDirectory directory;
  fs::copy(TAXELSIM_SOURCE_DIR "/tests/dataset/data/format_1", directory / "d");
  for (const char* name : {"shard-000000.h5", "dataset.yaml"}) {
    std::cout << name << ", format 1: "
              << damage(
                     directory / "d" / name, [](const fs::path&) {}, [&] { return problemOfShard(directory / "d"); })
              << std::endl;
  }
}

}  // namespace
}  // namespace taxelsim::testing
