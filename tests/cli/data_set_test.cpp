// `inspect` and `render` on a small data set, complete and damaged.
#include <nlohmann/json.hpp>

#include "cli/command_line.h"
#include "cli/pressed_pad.h"
#include "figures/frame_figures.h"
#include "support/test.h"
#include "taxelsim/error.h"

namespace taxelsim::testing {
namespace {

using ::testing::HasSubstr;

constexpr std::size_t kBlankPicture = 8000;  // bytes; a PNG without drawing in it is smaller

class DataSet : public ::testing::Test {
 protected:
  std::string at(const std::string& name) const { return root_ / name; }
  static std::string content(const std::string& file) { return contentOf(file); }

  void flipByteOf(const std::string& file, std::size_t place) const {
    std::string bytes = content(file);
    bytes.at(place) ^= 1;
    std::ofstream(file, std::ios::binary) << bytes;
  }

 private:
  TemporaryDirectory root_;
};

TEST_F(DataSet, InspectPrintsTheContents) {
  writePressedPad(at("d"));
  const Outcome text = succeed({"inspect", at("d")});
  for (const char* part : {"turning bar", "made-up pad", "3 of 3 complete", "data/tactile_image", "6 x 14", "counts", "meta/load"})
    EXPECT_THAT(text.out, HasSubstr(part));

  const Outcome outcome = runTaxelsim({"inspect", at("d"), "--json"});
  const nlohmann::json json = nlohmann::json::parse(outcome.out);
  EXPECT_EQ(json["scene"], "turning bar");
  EXPECT_EQ(json["seed"], 7);
  EXPECT_EQ(json["episodes_on_disk"], 5);
  EXPECT_EQ(json["frames_on_disk"], 15);
  EXPECT_EQ(json["shards"]["whole"], 3);
  const nlohmann::json& load = json["columns"][4];
  EXPECT_EQ(load["name"], "meta/load");
  EXPECT_EQ(load["non_finite"], 1) << "the NaN of episode 0";
  EXPECT_EQ(load["min"], 0.5);
  EXPECT_EQ(load["max"], 2.0);
  EXPECT_EQ(load["mean"], (0.5 + 1.0 + 1.5 + 2.0) / 4);
}

TEST_F(DataSet, InspectShowsFormatPolicyAndNamedValues) {
  writePressedPad(at("d"));
  const Outcome text = runTaxelsim({"inspect", at("d")});
  for (const char* part : {"policy    drop 1", "format    2", "dataset.h5 verified", "text[4]", "bar 3, drop 2", "false 2, true 3"})
    EXPECT_THAT(text.out, HasSubstr(part));
  const nlohmann::json json = nlohmann::json::parse(runTaxelsim({"inspect", at("d"), "--json"}).out);
  EXPECT_EQ(json["policy"], "drop 1");
  EXPECT_EQ(json["format_version"], 2);
  EXPECT_EQ(json["chunk_bytes"], 262144);
  EXPECT_EQ(json["view"], "whole");
  for (const nlohmann::json& column : json["columns"]) {
    const nlohmann::json counts = column.value("counts", nlohmann::json());
    const std::string name = column["name"];
    EXPECT_EQ(counts, name == "meta/object_name" ? (nlohmann::json{{"bar", 3}, {"drop", 2}})
                      : name == "meta/success"   ? (nlohmann::json{{"false", 2}, {"true", 3}})
                                                 : nlohmann::json())
        << name;
  }
}

TEST_F(DataSet, InspectReportsTheView) {
  writePressedPad(at("d"));
  flipByteOf(at("d/dataset.h5"), 100);
  const Outcome broken = runTaxelsim({"inspect", at("d")});
  expectRefused(broken, "dataset.h5: its SHA-256");
  EXPECT_THAT(broken.out, HasSubstr("dataset.h5 is broken"));
  succeed({"render", at("d"), "-o", at("a.png")});  // the shards are whole
  std::filesystem::remove(at("d/dataset.h5"));
  const Outcome missing = succeed({"inspect", at("d")});
  EXPECT_THAT(missing.out, HasSubstr("dataset.h5 is missing"));
}

TEST_F(DataSet, RenderRefusesBrokenShards) {
  writePressedPad(at("d"));
  flipByteOf(at("d/shard-000001.h5"), content(at("d/shard-000001.h5")).size() - 1);
  expectRefused(runTaxelsim({"render", at("d"), "-o", at("a.png")}), "shard-000001.h5: its SHA-256");
  EXPECT_FALSE(std::filesystem::exists(at("a.png")));
  succeed({"render", at("d"), "-o", at("a.png"), "--episode", "0"});  // of another shard
}

TEST_F(DataSet, Format1IsInspectedRenderedAndCompared) {
  const std::string old = TAXELSIM_SOURCE_DIR "/tests/dataset/data/format_1";
  const Outcome outcome = succeed({"inspect", old});
  for (const char* part : {"format    1", "2 of 2 complete", "all values of all shards", "no checksum in format 1", "int32"})
    EXPECT_THAT(outcome.out, HasSubstr(part));
  EXPECT_THAT(runTaxelsim({"inspect", old, "--quick"}).out, HasSubstr("headers of all shards"));
  succeed({"render", old, "-o", at("a.png")});
  EXPECT_GT(content(at("a.png")).size(), kBlankPicture);
  succeed({"compare", old, old});
}

// Of the contact law pasternak, which was removed. data/pasternak was written by version 0.3.0 from data/pasternak_scene.yaml.
TEST_F(DataSet, OfARemovedLawIsInspectedRenderedAndComparedButNotContinued) {
  const std::string old = TAXELSIM_SOURCE_DIR "/tests/dataset/data/pasternak", scene = old + "_scene.yaml";
  const Outcome outcome = succeed({"inspect", old});
  for (const char* part : {"1 of 1 complete", "data/tactile_image", "6 x 14"}) EXPECT_THAT(outcome.out, HasSubstr(part));
  succeed({"render", old, "-o", at("a.png")});
  EXPECT_GT(content(at("a.png")).size(), kBlankPicture);
  succeed({"compare", old, old});
  std::filesystem::copy(old, at("d"));
  const std::string refusal = scene +
                              ":13:10: sensor.skin.law: pasternak is not allowed: removed; use elastic_layer, or winkler with "
                              "depth_sampling: area";
  expectRefused(runTaxelsim({"generate", scene, "-o", at("d")}), refusal);
  expectRefused(runTaxelsim({"evaluate", scene}), refusal);
  succeed({"inspect", at("d")});
}

TEST_F(DataSet, InspectListsMissingShards) {
  writePressedPad(at("d"));
  std::filesystem::remove(at("d/shard-000001.h5"));
  const nlohmann::json json = jsonOf({"inspect", at("d"), "--json"});
  EXPECT_EQ(json["shards"]["missing"], nlohmann::json::array({1}));
  EXPECT_EQ(json["episodes_on_disk"], 3);
}

TEST_F(DataSet, InspectRefusesBrokenShards) {
  writePressedPad(at("d"));
  const std::string bytes = content(at("d/shard-000002.h5"));
  const std::vector<std::byte> image = DatasetReader(at("d")).read("data/tactile_image", 12, 3);  // the shard's only episode
  const std::size_t in_values = bytes.find(std::string(reinterpret_cast<const char*>(image.data()), image.size()));
  const std::size_t in_header = bytes.find("scene_sha256");
  for (const std::size_t place : {in_values, in_header}) {
    ASSERT_NE(place, std::string::npos);
    flipByteOf(at("d/shard-000002.h5"), place);
    const Outcome outcome = runTaxelsim({"inspect", at("d")});
    expectRefused(outcome, "shard-000002.h5");
    EXPECT_THAT(outcome.out, HasSubstr("1 broken (2)"));
    flipByteOf(at("d/shard-000002.h5"), place);
  }
  succeed({"inspect", at("d")});
}

TEST_F(DataSet, InspectRefusesAChangedScene) {
  writePressedPad(at("d"));
  std::string text = content(at("d/dataset.yaml"));
  text.replace(text.find("turning"), 7, "burning");
  std::ofstream(at("d/dataset.yaml")) << text;
  expectRefused(runTaxelsim({"inspect", at("d")}), "dataset.yaml");
}

TEST_F(DataSet, TextOfAManifestDoesNotControlTheTerminal) {
  writePressedPad(at("d"));
  std::string text = content(at("d/dataset.yaml"));
  text.replace(text.find("\"drop 1\""), 8, "\"\\x1b]0;drop\\x07\"");
  std::ofstream(at("d/dataset.yaml")) << text;
  for (const char* option : {"--quick", "--json"}) {
    const Outcome outcome = runTaxelsim({"inspect", at("d"), option});
    expectRefused(outcome, "policy is drop 1, not \\x1b]0;drop\\x07");
    EXPECT_THAT(outcome.out, HasSubstr(std::string(option) == "--json" ? "\\u001b]0;drop\\u0007" : "\\x1b]0;drop\\x07"));
    EXPECT_EQ((outcome.out + outcome.err).find_first_of("\x1b\x07"), std::string::npos) << outcome.out << outcome.err;
  }
}

TEST_F(DataSet, RenderDrawsAPicture) {
  writePressedPad(at("d"));
  succeed({"render", at("d"), "-o", at("a.png"), "--frames", "6"});
  EXPECT_TRUE(content(at("a.png")).starts_with("\x89PNG"));
  EXPECT_GT(content(at("a.png")).size(), kBlankPicture);
  const Outcome episode = runTaxelsim({"render", at("d"), "-o", at("b.png"), "--episode", "1"});
  EXPECT_EQ(episode.out, at("b.png") + ": 3 frames\n");
  EXPECT_NE(content(at("a.png")), content(at("b.png")));
  expectRefused(runTaxelsim({"render", at("d"), "-o", at("c.png"), "--episode", "5"}), "episodes 0 to 4");
  EXPECT_FALSE(std::filesystem::exists(at("c.png")));
  const Outcome refused = runTaxelsim({"render", at("d"), "-o", at("none/c.png")});
  EXPECT_EQ(refused.status, 1) << refused.err;
  EXPECT_THAT(refused.err, HasSubstr("none/c.png: its folder does not exist"));
}

TEST_F(DataSet, RenderNamesTheObject) {
  writePressedPad(at("d"));
  writePressedPad(at("other"), {.bar_name = "rod"});
  for (const auto& [episode, is_other] : {std::pair{"0", true}, std::pair{"1", false}}) {
    succeed({"render", at("d"), "-o", at("a.png"), "--episode", episode});
    succeed({"render", at("other"), "-o", at("b.png"), "--episode", episode});
    EXPECT_EQ(content(at("a.png")) != content(at("b.png")), is_other) << "episode " << episode;
  }
  writePressedPad(at("bytes"), {.bar_name = "\xff\n"});
  succeed({"render", at("bytes"), "-o", at("c.png")});  // Cairo draws no text that is not UTF-8
  EXPECT_GT(content(at("c.png")).size(), kBlankPicture);
}

// Of one size and one colour scale, which a picture of one frame does not have.
TEST_F(DataSet, FramesOfAnEpisodeAreDrawnOneByOne) {
  writePressedPad(at("d"));
  figures::FrameFigures figures({.directory = at("d"), .episode = 3});
  EXPECT_EQ(figures.times(), (std::vector<double>{0, 0.01, 0.02}));
  const figures::Pixels last = figures.pictureOf(2).pixels(), first = figures.pictureOf(0).pixels();
  EXPECT_EQ(last.values.size(), 3 * last.width * last.height);
  EXPECT_EQ(std::pair(first.width, first.height), std::pair(last.width, last.height));
  EXPECT_NE(first.values, last.values);
  EXPECT_EQ(figures.figureOf({2}).pixels().values, last.values);
  EXPECT_EQ(figures::FrameFigures({.directory = at("d")}).pictureOf(3 * 3 + 2).pixels().values, last.values) << "the same frame";

  writePressedPad(at("bare"), {.features = false});
  EXPECT_THROW(figures::FrameFigures({.directory = at("bare"), .episode = 0}).times(), Error);
}

TEST_F(DataSet, RenderWorksWithoutFeaturesAndWithoutGrid) {
  writePressedPad(at("bare"), {.features = false});
  succeed({"render", at("bare"), "-o", at("a.png")});
  writePressedPad(at("list"), {.one_grid = false});
  succeed({"render", at("list"), "-o", at("b.png")});
  EXPECT_GT(content(at("b.png")).size(), kBlankPicture);
}

}  // namespace
}  // namespace taxelsim::testing
