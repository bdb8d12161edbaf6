// Work that takes long ends within 0.5 s after a signal, and leaves no file. Seconds are those of the processor: the clock of a busy
// machine says nothing of the program.
#include <csignal>

#include "cli/command_line.h"
#include "support/test.h"

namespace taxelsim::testing {
namespace {

constexpr double kMaxSeconds = 0.5;

// A torus with waves: `n` x `n` quads of two triangles, a binary STL.
void writeWaves(const std::filesystem::path& file, std::uint32_t n) {
  const auto point = [n](std::uint32_t i, std::uint32_t j) {
    const double u = 2 * std::numbers::pi * (i % n) / n, v = 2 * std::numbers::pi * (j % n) / n;
    const double tube = 0.004 * (1 + 0.1 * std::cos(7 * u) * std::cos(5 * v)), radius = 0.012 + tube * std::cos(v);
    return std::array{static_cast<float>(radius * std::cos(u)), static_cast<float>(radius * std::sin(u)),
                      static_cast<float>(tube * std::sin(v))};
  };
  const std::string header(80, ' ');
  const std::uint32_t num_triangles = 2 * n * n;
  std::ofstream stream(file, std::ios::binary);
  const auto write = [&](const auto& value) { stream.write(reinterpret_cast<const char*>(&value), sizeof value); };
  stream << header;
  write(num_triangles);
  const auto writeTriangle = [&](const auto&... corners) {
    write(std::array<float, 3>{});
    (write(corners), ...);
    write(std::uint16_t{0});
  };
  for (std::uint32_t i = 0; i < n; ++i) {
    for (std::uint32_t j = 0; j < n; ++j) {
      writeTriangle(point(i, j), point(i + 1, j), point(i + 1, j + 1));
      writeTriangle(point(i, j), point(i + 1, j + 1), point(i, j + 1));
    }
  }
}

// One shard, sparse, of 64 GiB: it takes minutes to verify.
TEST(Signals, VerificationHearsThem) {
  const TemporaryDirectory root;
  std::ofstream(root / "scene.yaml")
      << "format_version: 1\nname: s\nkind: contacts\nsensor: " TAXELSIM_SOURCE_DIR
         "/scenes/sensors/wts0614_soft_cover.yaml\nobjects: [{sphere: {radius_mm: 5}}]\nrandomization: {load: 1}\nrecord: [tactile_image]\n"
         "data_set: {episodes: 2, episodes_per_shard: 1}\n";
  const std::vector<std::string> command{"generate", root / "scene.yaml", "-o", root / "out"};
  succeed(command);
  std::filesystem::resize_file(root / "out/shard-000000.h5", std::uintmax_t{64} << 30);
  const Outcome outcome = runTaxelsim(command, {.signal = SIGTERM, .signal_at = "verifying: 0 of 2 shards: 0:"});
  EXPECT_EQ(outcome.status, 130) << outcome.err;
  EXPECT_LT(outcome.cpu_after_signal, kMaxSeconds);
  EXPECT_THAT(outcome.err, ::testing::HasSubstr("stopped before the shards in"));
}

// Of 28,800 triangles: 2.5 s.
TEST(Signals, SimplificationHearsThem) {
  const TemporaryDirectory root;
  writeWaves(root / "waves.stl", 120);
  const Outcome outcome =
      runTaxelsim({"frame", "--sensor", TAXELSIM_SOURCE_DIR "/scenes/sensors/wts0614_soft_cover.yaml", "--object", root / "waves.stl",
                   "--load", "1", "--device", "none"},
                  {.signal = SIGTERM, .signal_at_cpu = 0.5, .environment = {"XDG_CACHE_HOME=" + (root / "cache").string()}});
  EXPECT_EQ(outcome.status, 128 + SIGTERM) << outcome.err;
  EXPECT_LT(outcome.cpu_after_signal, kMaxSeconds);
  EXPECT_FALSE(std::filesystem::exists(root / "cache/taxelsim")) << "a result that is not complete is not stored";
}

// Two fits of 3 s and more.
TEST(Signals, CharacterizeHearsThem) {
  const TemporaryDirectory root;
  std::vector<std::string> command{"characterize", "--cross-validate", "-o", root / "s.yaml"};
  for (const char* name : {"force_curve", "force_depth", "point_images", "step_response", "stamp_3N", "stamp_6N"})
    command.push_back(TAXELSIM_SOURCE_DIR "/scenes/measurements/" + std::string(name) + ".yaml");
  const Outcome outcome = runTaxelsim(command, {.signal = SIGTERM, .signal_at_cpu = 0.5});
  EXPECT_EQ(outcome.status, 128 + SIGTERM) << outcome.err;
  EXPECT_LT(outcome.cpu_after_signal, kMaxSeconds);
  EXPECT_FALSE(std::filesystem::exists(root / "s.yaml"));
}

}  // namespace
}  // namespace taxelsim::testing
