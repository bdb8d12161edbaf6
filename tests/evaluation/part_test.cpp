// Evaluations in parts: the same evaluations as at once, exact text, and refusal of parts that do not belong together.
#include "episodes/example_scene.h"
#include "evaluation/part_text.h"
#include "support/input_error.h"
#include "support/test.h"
#include "taxelsim/error.h"
#include "taxelsim/version.h"

namespace taxelsim {
namespace {

Scene smallScene() {
  Scene scene = exampleScene();
  scene.num_steps = 4;
  scene.num_episodes = 6;
  scene.resolved = "name: example\nseed: 1\n";
  scene.controllers = {{"first", 1, edgeServo()}, {"second", 1, edgeServo()}};
  scene.task = Task{.hold = 0.02};
  (*scene.task)[TaskMeasure::kTotalForce] = TaskCriterion{.tolerance = 0.5};
  return scene;
}

EvaluateOptions episodes(std::uint64_t first, std::uint64_t end) {
  return {.batch_size = 3, .episodes = EpisodeRange{first, end}};
}

void expectRefused(const std::function<void()>& call, const std::string& part) {
  EXPECT_THAT(support::inputError([&] { call(); }), ::testing::HasSubstr(part));
}

TEST(EvaluationPart, PartsTogetherGiveTheEvaluationsOfOneRun) {
  const Device device = Device::open();
  const Scene scene = smallScene();
  const std::vector<Evaluation> whole = evaluate(device, scene);
  std::vector<NamedPart> parts;  // in no order, with an overlap
  for (const auto& [first, end] : {std::pair{4, 6}, std::pair{0, 3}, std::pair{2, 4}}) {
    const EvaluationPart part = evaluatePart(device, scene, {}, episodes(first, end));
    const std::string text = evaluationPartText(part);
    parts.push_back({.name = "part", .part = parseEvaluationPart(text, "part")});
    EXPECT_EQ(evaluationPartText(parts.back().part), text);
  }
  const std::vector<Evaluation> merged = mergeEvaluationParts(scene, parts);
  ASSERT_EQ(merged.size(), 2u);
  for (std::size_t c = 0; c < merged.size(); ++c) {
    EXPECT_EQ(merged[c].controller, whole[c].controller);
    EXPECT_EQ(digitsOf(merged[c].verdicts), digitsOf(whole[c].verdicts));
    for (std::size_t k = 0; k < merged[c].verdicts.size(); ++k) EXPECT_EQ(merged[c].verdicts[k].episode, k);
    EXPECT_EQ(merged[c].total.num_successes, whole[c].total.num_successes);
    EXPECT_EQ(merged[c].by_start.size(), whole[c].by_start.size());
  }

  parts[1].part.evaluations[1].verdicts[2].peak_force += 1;
  expectRefused([&] { mergeEvaluationParts(scene, parts); }, "episode 2 differs from the one in another part");
  parts.erase(parts.begin() + 1);
  expectRefused([&] { mergeEvaluationParts(scene, parts); }, "episodes 0..1 are missing in the parts of the evaluation; 2 of 6");
  expectRefused([&] { evaluate(device, scene, {}, episodes(3, 7)); }, "episodes: 3..6 is not allowed: the scene has episodes 0..5");
  expectRefused([&] { evaluate(device, scene, {}, episodes(3, 3)); }, "episodes: 3..2 is not allowed");
}

EvaluationPart examplePart(const Scene& scene) {
  Verdict verdict{.object = 1, .success = true, .settling_time = std::numeric_limits<float>::quiet_NaN()};
  verdict.steady_error = {0.1f, std::numeric_limits<float>::infinity(), -0.0f, 1e-40f};
  return {.program_version = kVersion,
          .device = "device",
          .probe_sha256 = "probe",
          .scene = scene.resolved,
          .condition = scene.condition,
          .seed = scene.seed,
          .num_episodes = scene.num_episodes,
          .policy = "",
          .episodes = {0, scene.num_episodes},
          .evaluations = {{.controller = "first", .verdicts = std::vector<Verdict>(scene.num_episodes, verdict)}}};
}

TEST(EvaluationPart, ForeignPartsAreRefusedByName) {
  const Scene scene = smallScene();
  const EvaluationPart part = examplePart(scene);
  EXPECT_EQ(mergeEvaluationParts(scene, {{"a", part}}).size(), 1u);
  const auto refuse = [&](auto change, const std::string& message) {
    EvaluationPart other = part;
    change(other);
    expectRefused([&] { mergeEvaluationParts(scene, {{"a", part}, {"b", other}}); }, message);
  };
  refuse([](EvaluationPart& other) { other.program_version = "0.0.1"; }, "b: has another program version (0.0.1 there, ");
  refuse([](EvaluationPart& other) { other.condition = "unseen"; }, "b: has another condition (unseen there, nominal expected)");
  refuse([](EvaluationPart& other) { other.seed += 1; }, "b: has another seed");
  refuse([](EvaluationPart& other) { other.num_episodes += 1; }, "b: has another number of episodes (7 there, 6 expected)");
  refuse([](EvaluationPart& other) { other.scene = "name: example\nseed: 2\n"; }, "b: is of another scene: seed: 2 there, 1 requested");
  refuse([](EvaluationPart& other) { other.device = "GPU"; }, "b: has another device (GPU there, device expected)");
  refuse([](EvaluationPart& other) { other.probe_sha256 = "other"; }, "b: has another probe");
  refuse([](EvaluationPart& other) { other.policy = "sha"; }, "b: has another policy (sha there, none expected)");
  refuse([](EvaluationPart& other) { other.evaluations[0].controller = "x"; },
         "b: has another set of controllers (x there, first expected)");
  refuse([](EvaluationPart& other) { other.evaluations[0].verdicts[0].object = 9; }, "b: object 9 is not allowed: the scene has 0 to ");
  expectRefused([&] { mergeEvaluationParts(scene, {}); }, "no parts of an evaluation found");
}

TEST(EvaluationPart, DamagedTextIsRefused) {
  const std::string text = evaluationPartText(examplePart(smallScene()));
  EXPECT_EQ(evaluationPartText(parseEvaluationPart(text, "a")), text);
  for (std::size_t i = 0; i < text.size(); ++i) {
    std::string changed = text;
    changed[i] ^= 1;
    try {
      // A change between the tokens is none.
      EXPECT_EQ(evaluationPartText(parseEvaluationPart(changed, "a")), text) << i << ": " << changed.substr(i, 20);
    } catch (const Error& error) {
      EXPECT_EQ(error.kind(), ErrorKind::kInput);
    }
    if (i + 1 < text.size()) expectRefused([&] { parseEvaluationPart(text.substr(0, i), "a"); }, "a: ");
  }
}

TEST(EvaluationPart, PartsOfEpisodesDifferByOneAtMost) {
  for (const std::uint64_t num_episodes : {1u, 5u, 4096u, 16777216u}) {
    for (const std::uint64_t num_parts : {1u, 2u, 3u, 7u}) {
      std::uint64_t next = 0;
      for (std::uint64_t part = 1; part <= num_parts; ++part) {
        const EpisodeRange range = partOfEpisodes(num_episodes, part, num_parts);
        EXPECT_EQ(range.first, next);
        EXPECT_LE(range.size(), num_episodes / num_parts + 1);
        EXPECT_GE(range.size(), num_episodes / num_parts);
        next = range.end;
      }
      EXPECT_EQ(next, num_episodes);
    }
  }
}

}  // namespace
}  // namespace taxelsim
