// dataset.yaml: round trip of all text, and rejection of invalid manifests.
#include <rapidcheck.h>

#include "dataset/column.h"
#include "dataset/example.h"
#include "dataset/manifest.h"

namespace taxelsim::testing {
namespace {

Manifest parsed(const Manifest& manifest) {
  return dataset::parseManifest("dataset.yaml", dataset::writeManifest(manifest));
}

TEST(Manifest, RoundTrips) {
  const Manifest original = exampleManifest();
  const Manifest found = parsed(original);
  EXPECT_EQ(dataset::writeManifest(found), dataset::writeManifest(original));
  EXPECT_EQ(found.scene, original.scene);
  EXPECT_EQ(found.seed, original.seed);
  EXPECT_EQ(found.sensor_name, original.sensor_name);
  EXPECT_EQ(found.pitch, original.pitch);
  EXPECT_EQ(found.columns[2].shape, std::vector<std::size_t>{6});
  EXPECT_TRUE(found.columns[4].per_episode);
  EXPECT_EQ(found.format_version, 2u);
  EXPECT_EQ(found.chunk_bytes, original.chunk_bytes);
  EXPECT_EQ(found.policy, original.policy);
  EXPECT_EQ(found.columns[6].value_names, (std::vector<std::string>{"none", "point", "edge"}));
  EXPECT_EQ(found.columns[7].bit_names, (std::vector<std::string>{"limit", "lost"}));
  EXPECT_EQ(found.columns[9].text_length, 5u);
}

TEST(Manifest, HasTheNumbersOfChosenEpisodes) {
  Manifest manifest = exampleManifest();
  EXPECT_EQ(dataset::writeManifest(manifest).find("\nepisodes:"), std::string::npos);
  EXPECT_TRUE(parsed(manifest).episodes.empty());
  for (std::uint64_t k = 0; k < manifest.num_episodes; ++k) manifest.episodes.push_back(~std::uint64_t{0} - k);
  EXPECT_EQ(parsed(manifest).episodes, manifest.episodes);
  manifest.episodes.pop_back();
  expectError(ErrorKind::kInput, "episodes has", [&] { dataset::checkManifest(manifest); });
}

TEST(Manifest, RoundTripsAnySceneText) {
  const bool holds = rc::check("scene text survives YAML", [] {
    Manifest manifest = exampleManifest();
    const auto piece = rc::gen::element<std::string>("a", " ", "\n", "\t", ":", "#", "\"", "\\", "'", "- ", "é", "|", "\r", "{", "%",
                                                     "\x01", "---\n", "...\n");
    manifest.scene.clear();
    for (const std::string& part : *rc::gen::container<std::vector<std::string>>(piece)) manifest.scene += part;
    if (*rc::gen::arbitrary<bool>()) manifest.scene += "\n";
    manifest.device = manifest.scene;
    const Manifest found = parsed(manifest);
    RC_ASSERT(found.scene == manifest.scene);
    RC_ASSERT(found.device == manifest.device);
  });
  EXPECT_TRUE(holds);
}

TEST(Manifest, RejectsChangedOrInvalidFiles) {
  const std::string text = dataset::writeManifest(exampleManifest());
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string result = text;
    EXPECT_NE(result.find(from), std::string::npos) << from;
    return result.replace(result.find(from), from.size(), to);
  };
  const auto expectRejected = [](const std::string& content, const std::string& part) {
    expectError(ErrorKind::kInput, part, [&] { dataset::parseManifest("d/dataset.yaml", content); });
  };
  expectRejected(changed("format_version: 2", "format_version: 3"), "newer taxelsim");
  expectRejected(changed("format_version: 2", "format_version: 0"), "reads 1 to 2");
  expectRejected(changed("format_version: 2", "format_version: x"), "d/dataset.yaml:2");
  expectRejected(changed("format_version: 2", "other: 1"), "format_version is missing");
  expectRejected(changed("seed: 18446744073709551615", "seed: -1"), "seed");
  expectRejected(changed("\"press\"", "\"Press\""), "was changed");
  expectRejected(changed("type: uint16", "type: uint17"), "uint17");
  expectRejected(changed("rows: frames", "rows: cows"), "cows");
  expectRejected(changed("num_episodes: 11", "num_episodes: 0"), "num_episodes");
  expectRejected(changed("columns:\n", "columns: [\n"), "d/dataset.yaml");
  expectRejected("", "d/dataset.yaml");
  expectRejected(changed("num_rows: 2", "num_rows: 2147483648"), "num_rows: 2147483648 is not allowed: a whole number from 0 to 128");
  expectRejected(changed("pitch: [", "pitch: [1, "), "pitch: a list is not allowed: a list of 2 numbers");
  expectRejected(changed("shape: [2, 3]", "shape: [2, 3.5]"), "shape: 3.5 is not allowed");
  expectRejected(changed("shape: [2, 3]", "shape: " + std::string(100'000, '[')), "brackets are open");
  expectRejected(changed("shape: [2, 3]", "shape: &a [*a]"), "an anchor");
  expectRejected(changed("device: ", "x: [" + std::string(8'000'000, ',') + "]\ndevice: "), "d/dataset.yaml");
  expectRejected("- 1\n", "not a mapping");
}

TEST(Manifest, RejectsInvalidColumns) {
  const auto expectRejected = [](const std::string& part, auto change) {
    Manifest manifest = exampleManifest();
    change(manifest);
    expectError(ErrorKind::kInput, part, [&] { dataset::checkManifest(manifest); });
  };
  EXPECT_NO_THROW(dataset::checkManifest(exampleManifest()));
  expectRejected("twice", [](Manifest& m) { m.columns.push_back(m.columns[0]); });
  expectRejected("start with data/", [](Manifest& m) { m.columns[0].name = "meta/x"; });
  expectRejected("start with data/", [](Manifest& m) { m.columns[4].name = "data/x"; });
  expectRejected("letters, digits", [](Manifest& m) { m.columns[0].name = "data//x"; });
  expectRejected("letters, digits", [](Manifest& m) { m.columns[0].name = "data/../x"; });
  expectRejected("group", [](Manifest& m) { m.columns[0].name = "data/total_force/x"; });
  expectRejected("episode_ends", [](Manifest& m) { m.columns[4].name = "meta/episode_ends"; });
  expectRejected("unit", [](Manifest& m) { m.columns[0].unit.clear(); });
  expectRejected("1 GiB", [](Manifest& m) { m.columns[0].shape = {0}; });
  expectRejected("1 GiB", [](Manifest& m) { m.columns[0].shape = {std::size_t{1} << 40, std::size_t{1} << 40}; });
  expectRejected("dimensions", [](Manifest& m) { m.columns[0].shape.assign(9, 1); });
  expectRejected("has 0 columns", [](Manifest& m) { m.columns.clear(); });
  expectRejected("episodes_per_shard", [](Manifest& m) { m.episodes_per_shard = 0; });
  expectRejected("episodes_per_shard is 1000001, not 1 to 1000000", [](Manifest& m) { m.episodes_per_shard = 1'000'001; });
  expectRejected("episodes has 1000001 numbers, which is not allowed: at most 1000000",
                 [](Manifest& m) { m.episodes.resize(m.num_episodes = 1'000'001); });
  expectRejected("4097 columns", [](Manifest& m) { m.columns.assign(4097, m.columns[0]); });
  expectRejected("num_rows or num_cols is 129", [](Manifest& m) { m.num_cols = 129; });
  expectRejected("compression", [](Manifest& m) { m.compression = 10; });
  expectRejected("chunk_bytes", [](Manifest& m) { m.chunk_bytes = 1023; });
  expectRejected("chunk_bytes", [](Manifest& m) { m.chunk_bytes = kMaxChunkBytes + 1; });
  expectRejected("not allowed: at most 1000000", [](Manifest& m) { m.num_episodes = std::uint64_t{1} << 48; });
  expectRejected("policy", [](Manifest& m) { m.policy.assign(1 << 20, 'p'); });
  expectRejected("description", [](Manifest& m) { m.columns[0].description.assign(1 << 20, 'p'); });
  expectRejected("length is 0", [](Manifest& m) { m.columns[9].text_length = 0; });
  expectRejected("length is 1025", [](Manifest& m) { m.columns[9].text_length = kMaxTextLength + 1; });
  expectRejected("length is 4", [](Manifest& m) { m.columns[0].text_length = 4; });
  expectRejected("unsigned integers", [](Manifest& m) { m.columns[1].value_names = {"a"}; });
  expectRejected("values and of bits", [](Manifest& m) { m.columns[6].bit_names = {"a"}; });
  expectRejected("more names than bits", [](Manifest& m) { m.columns[7].bit_names.assign(9, "a"); });
  expectRejected("1 to 64 bytes", [](Manifest& m) { m.columns[6].value_names = {"a", ""}; });
}

TEST(Manifest, ShardNamesHaveAtLeastSixDigits) {
  EXPECT_EQ(dataset::shardName(0), "shard-000000.h5");
  EXPECT_EQ(dataset::shardName(1234567), "shard-1234567.h5");
}

}  // namespace
}  // namespace taxelsim::testing
