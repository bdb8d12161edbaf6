// Targets of the files of a data set.
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "base/files.h"
#include "base/sha256.h"
#include "dataset/checksum.h"
#include "dataset/child_reading.h"
#include "dataset/manifest.h"
#include "dataset/shard.h"
#include "dataset/view.h"
#include "fuzz/input.h"
#include "fuzz/targets.h"

// Of clang's runtime and linker; null in other builds.
extern "C" {
extern std::uint8_t __start___sancov_cntrs[] __attribute__((weak, visibility("hidden")));
extern std::uint8_t __stop___sancov_cntrs[] __attribute__((weak, visibility("hidden")));
void __sanitizer_set_death_callback(void (*callback)()) __attribute__((weak));
}

namespace taxelsim::fuzz {
namespace {

using namespace dataset;

constexpr std::uint64_t kMaxSeconds = 1;  // of a child; some files make HDF5 loop

void readManifestText(std::string_view input) {
  Manifest manifest;
  if (!accepts([&] { manifest = parseManifest("dataset.yaml", std::string(input)); }) || manifest.format_version == 1) return;
  const std::string text = writeManifest(manifest);
  require(writeManifest(parseManifest("same.yaml", text)) == text, "the text of the manifest is read differently");
}

// Counters of coverage in this library; none where it is built without.
std::span<std::byte> coverage() {
  return {reinterpret_cast<std::byte*>(__start___sancov_cntrs), reinterpret_cast<std::byte*>(__stop___sancov_cntrs)};
}

// Reads a file of a data set in a child process, which HDF5 may crash, with the checksum that an attacker would make. The child's coverage
// is added to that of this process. `read`: checkShardFiles() or viewEnds().
template <typename ReadFile>
void readHdf5File(const std::string& name, const char* manifest_name, std::string_view input, ReadFile read) {
  const auto manifest_file = std::filesystem::path(TAXELSIM_SOURCE_DIR) / "tests/fuzz/data" / manifest_name;
  const Manifest manifest = parseManifest(manifest_file, readTextFile(manifest_file, kMaxManifestBytes));
  const auto file = inputFolder().write(name, input);
  inputFolder().write(checksumFile(file).filename().string(), sha256File(file) + "  " + name + "\n");
  std::vector<std::byte> result(1 + coverage().size());  // whether there is a finding; counters of the child
  accepts([&] {
    readInChild(file, result,
                [&](std::span<std::byte> buffer) {
                  if (__sanitizer_set_death_callback != nullptr)
                    __sanitizer_set_death_callback(nullptr);  // libFuzzer's, which is for this process
                  try {
                    accepts([&] { read(file, manifest, Isolation::kNone); });
                  } catch (const std::logic_error&) {
                    buffer[0] = std::byte{1};
                  }
                  std::ranges::copy(coverage(), buffer.begin() + 1);
                },
                {.seconds = kMaxSeconds});
  });
  require(result[0] == std::byte{0}, "the child refuses its input in another way than promised");
  for (std::size_t i = 0; i < coverage().size(); ++i) coverage()[i] = std::max(coverage()[i], result[1 + i]);
}

void readShard(const char* manifest_name, std::string_view input) {
  readHdf5File(shardName(0), manifest_name, input, [](const auto& file, const Manifest& manifest, Isolation isolation) {
    checkShardFiles(std::array{ShardFile{file, 0}}, manifest, /*contents=*/true, isolation);
  });
}

}  // namespace

std::span<const Target> datasetTargets() {
  static constexpr std::array kTargets{
      Target{"manifest", readManifestText}, Target{"shard", [](std::string_view input) { readShard("format_2.yaml", input); }},
      Target{"shard_compressed", [](std::string_view input) { readShard("format_2_compressed.yaml", input); }},
      Target{"shard_1", [](std::string_view input) { readShard("format_1.yaml", input); }},
      Target{"view", [](std::string_view input) { readHdf5File(kViewName, "format_2.yaml", input, viewEnds); }}};
  return kTargets;
}

}  // namespace taxelsim::fuzz
