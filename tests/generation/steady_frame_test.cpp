// A slice allocates no memory between frames of running episodes, with controllers, robots, moving objects and recording.
#include "episodes/batch.h"
#include "episodes/example_scene.h"
#include "generation/shard_sink.h"
#include "support/allocations.h"
#include "support/test.h"
#include "taxelsim/generate.h"

namespace taxelsim {
namespace {

constexpr int kNumInstances = 6;
constexpr int kWarmUps = 4;  // frames; the first includes the load search

struct Kind {
  const char* name;
  void (*change)(Scene&);
};

// Also records the joint columns.
void usePanTilt(Scene& scene) {
  scene.robot = panTilt({});
  scene.record.push_back("robot");
}

void useJacobian(Scene& scene) {
  scene.controllers[0].servo.jacobian = TactileJacobianSource::kMeasured;
}

// Also records the exact edge.
void addEdge(Scene& scene) {
  scene.objects[0].edge = Vector3{0, 0, 1};
}

void moveObjects(Scene& scene) {
  for (SceneObject& object : scene.objects) {
    object.motion = Sinusoid{.amplitude = 1e-4};
  }
}

class SteadyFrame : public ::testing::TestWithParam<Kind> {};

TEST_P(SteadyFrame, AllocatesNoMemory) {
  Scene scene = exampleScene();
  scene.num_steps = 30;
  scene.num_episodes = scene.episodes_per_shard = kNumInstances;
  GetParam().change(scene);
  const SlicePlan plan(scene, outputsOf(scene));
  const Device device = support::openUnvalidated();
  const Model model(device, modelOptionsOf(scene));
  const TestDirectory directory;
  Manifest manifest;
  manifest.scene = scene.resolved;
  manifest.sensor_name = scene.sensor.name;
  manifest.num_episodes = manifest.episodes_per_shard = kNumInstances;
  manifest.program_version = manifest.device = "0";
  manifest.columns = columnsOf(scene);
  DatasetWriter dataset(directory.path(), manifest);
  ShardWriter writer(dataset, 1);
  ShardQueue queue(manifest, {false}, plan.num_frames);
  const Recorder recorder(planColumns(scene), plan.edges);
  std::vector<LoadMisses> load_misses(scene.objects.size());
  ContactMisses misses;
  ContactMissCounter contact_misses(plan, misses);
  ShardSink sink(plan, recorder, queue, writer, load_misses, contact_misses, kNumInstances);
  Slice slice(model, plan, kNumInstances, sink);

  slice.submit();
  for (int frame = 0; frame < kWarmUps; ++frame) {
    slice.collect();
    slice.submit();
  }
  const int num_frames = plan.num_frames - kWarmUps - 1;
  const support::NoAllocations watch;
  std::uint64_t num_seen = 0;
  for (int frame = 0; frame < num_frames; ++frame) {
    num_seen += slice.collect().num_frames;
    slice.submit();
  }
  EXPECT_EQ(watch.count(), 0u) << "in " << num_frames << " frames";
  EXPECT_EQ(num_seen, static_cast<std::uint64_t>(num_frames) * kNumInstances) << "every instance active in every frame";
  EXPECT_EQ(slice.collect().num_episodes, static_cast<std::uint64_t>(kNumInstances));
}

INSTANTIATE_TEST_SUITE_P(Kinds, SteadyFrame,
                         ::testing::Values(Kind{"flying", [](Scene&) {}}, Kind{"pan_tilt", usePanTilt}, Kind{"jacobian", useJacobian},
                                           Kind{"moving", moveObjects}, Kind{"edge", addEdge}),
                         [](const auto& param) { return std::string(param.param.name); });

}  // namespace
}  // namespace taxelsim
