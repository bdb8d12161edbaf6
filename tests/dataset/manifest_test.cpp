// dataset.yaml: every text survives, and what cannot be a data set is refused.
#include <rapidcheck.h>

#include "dataset/example.h"
#include "dataset/manifest.h"

namespace taxelsim::testing {
namespace {

Manifest parsed(const Manifest& manifest) {
  return dataset::parseManifest("dataset.yaml", dataset::writeManifest(manifest));
}

TEST(Manifest, ComesBackWhole) {
  const Manifest wanted = exampleManifest();
  const Manifest found = parsed(wanted);
  EXPECT_EQ(dataset::writeManifest(found), dataset::writeManifest(wanted));
  EXPECT_EQ(found.scene, wanted.scene);
  EXPECT_EQ(found.seed, wanted.seed);
  EXPECT_EQ(found.sensor_name, wanted.sensor_name);
  EXPECT_EQ(found.pitch, wanted.pitch);
  EXPECT_EQ(found.columns[2].shape, std::vector<std::size_t>{6});
  EXPECT_TRUE(found.columns[4].per_episode);
}

TEST(Manifest, KeepsEveryScene) {
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

TEST(Manifest, HasNoOtherReading) {
  const std::string text = dataset::writeManifest(exampleManifest());
  const auto changed = [&](const std::string& from, const std::string& to) {
    std::string result = text;
    EXPECT_NE(result.find(from), std::string::npos) << from;
    return result.replace(result.find(from), from.size(), to);
  };
  const auto refuses = [](const std::string& content, const std::string& part) {
    expectError(ErrorKind::kInput, part, [&] { dataset::parseManifest("d/dataset.yaml", content); });
  };
  refuses(changed("format_version: 1", "format_version: 2"), "newer taxelsim");
  refuses(changed("format_version: 1", "format_version: x"), "d/dataset.yaml:2");
  refuses(changed("format_version: 1", "other: 1"), "format_version is missing");
  refuses(changed("seed: 18446744073709551615", "seed: -1"), "seed");
  refuses(changed("\"press\"", "\"Press\""), "was changed");
  refuses(changed("type: uint16", "type: uint17"), "uint17");
  refuses(changed("rows: frames", "rows: cows"), "cows");
  refuses(changed("num_episodes: 11", "num_episodes: 0"), "num_episodes");
  refuses(changed("columns:\n", "columns: [\n"), "d/dataset.yaml");
  refuses("", "d/dataset.yaml");
  refuses("- 1\n", "not a mapping");
}

TEST(Manifest, RefusesColumnsThatNoFileCanHave) {
  const auto refuses = [](const std::string& part, auto change) {
    Manifest manifest = exampleManifest();
    change(manifest);
    expectError(ErrorKind::kInput, part, [&] { dataset::checkManifest(manifest); });
  };
  EXPECT_NO_THROW(dataset::checkManifest(exampleManifest()));
  refuses("twice", [](Manifest& m) { m.columns.push_back(m.columns[0]); });
  refuses("under data/", [](Manifest& m) { m.columns[0].name = "meta/x"; });
  refuses("under data/", [](Manifest& m) { m.columns[4].name = "data/x"; });
  refuses("words", [](Manifest& m) { m.columns[0].name = "data//x"; });
  refuses("words", [](Manifest& m) { m.columns[0].name = "data/../x"; });
  refuses("folder", [](Manifest& m) { m.columns[0].name = "data/total_force/x"; });
  refuses("episode_ends", [](Manifest& m) { m.columns[4].name = "meta/episode_ends"; });
  refuses("unit", [](Manifest& m) { m.columns[0].unit.clear(); });
  refuses("1 GiB", [](Manifest& m) { m.columns[0].shape = {0}; });
  refuses("1 GiB", [](Manifest& m) { m.columns[0].shape = {std::size_t{1} << 40, std::size_t{1} << 40}; });
  refuses("dimensions", [](Manifest& m) { m.columns[0].shape.assign(9, 1); });
  refuses("no columns", [](Manifest& m) { m.columns.clear(); });
  refuses("episodes_per_shard", [](Manifest& m) { m.episodes_per_shard = 0; });
  refuses("compression", [](Manifest& m) { m.compression = 10; });
}

TEST(Manifest, NamesShards) {
  EXPECT_EQ(dataset::shardName(0), "shard-000000.h5");
  EXPECT_EQ(dataset::shardName(1234567), "shard-1234567.h5");
}

}  // namespace
}  // namespace taxelsim::testing
