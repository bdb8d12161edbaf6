// Candidates: whether a step tests all clusters of a mesh, or only those near the skin some steps before, changes no bit.
#include "simulation/candidate_schedule.h"
#include "simulation/comparison.h"
#include "support/plain.h"
#include "support/random_scene.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using support::Random;
using support::Touch;

constexpr double kDt = 1e-3;  // s
constexpr int kInstances = 24;
constexpr int kSteps = 24;

// A motion with constant velocity, except for random jumps.
struct Motion {
  Vector3 velocity;  // m per step
  Vector3 axis;
  double angle = 0;  // rad per step
};

struct Scene {
  Sensor sensor;
  std::vector<Object> objects;
  OutputOptions outputs;
};

std::vector<std::vector<Touch>> slowPaths(const Scene& scene, std::uint64_t seed) {
  Random random(seed);
  std::vector<Touch> touches;
  std::vector<Motion> motions;
  const auto num_objects = static_cast<int>(scene.objects.size());
  Sensor foundation = scene.sensor;  // under which the depth of a first touch is found
  foundation.skin.law = Winkler{.normal_contact_stiffness = 1e8};
  const auto placed = [&](int id) -> Touch { return {{id}, {support::randomContact(random, foundation, scene.objects[id])}}; };
  for (int i = 0; i < kInstances; ++i) {
    touches.push_back(placed(i % num_objects));
    // From rest to faster than candidates stay valid.
    const double speed = i % 6 == 0 ? 0 : std::pow(10, random.uniform(-6.5, -3.7));
    const auto direction = [&] { return rotate(random.rotation(), {1, 0, 0}); };
    Motion motion{direction(), direction(), random.uniform(0, 50) * speed};
    for (double& component : motion.velocity) component *= speed;
    motions.push_back(motion);
  }
  std::vector<std::vector<Touch>> steps;
  for (int step = 0; step < kSteps; ++step) {
    steps.push_back(touches);
    for (int i = 0; i < kInstances; ++i) {
      if (random.chance(0.02)) {
        touches[i] = placed(random.integer(0, num_objects - 1));
        continue;
      }
      if (random.chance(0.05)) {  // turns back
        for (double& component : motions[i].velocity) component = -component;
      }
      Pose& X_SO = touches[i].X_SO[0];
      for (std::size_t axis = 0; axis < 3; ++axis) X_SO.position[axis] += motions[i].velocity[axis];
      X_SO.rotation = axisAngle(motions[i].axis, motions[i].angle) * X_SO.rotation;
    }
  }
  return steps;
}

struct Run {
  std::vector<std::vector<std::uint32_t>> bits;  // (kSteps x kInstances)
  int num_coherent = 0;                          // of all steps
};

Run run(const Scene& scene, const std::vector<std::vector<Touch>>& steps, const std::string& plain) {
  const support::Plain without(plain);
  Simulator simulator = support::makeSimulator(scene.sensor, scene.objects, {.num_instances = kInstances, .outputs = scene.outputs});
  Run run;
  for (std::size_t step = 0; step < steps.size(); ++step) {
    support::setTouches(simulator, steps[step]);
    // A load search needs surfaces of any height, so it uses no candidates.
    simulator.setLoad(3, step == steps.size() / 2 && !std::holds_alternative<Proximity>(scene.sensor.skin.law) ? 1.0f : kPoseDriven);
    const FrameView frame = support::stepOnce(simulator, kDt);
    for (int i = 0; i < kInstances; ++i) run.bits.push_back(support::bitsOf(frame, i, kInstances));
    run.num_coherent += simulator.timing().num_coherent;
  }
  return run;
}

// Share of frames that must have used candidates; otherwise the test proves nothing.
void expectNoneShows(const Scene& scene, const std::vector<std::vector<Touch>>& steps, double coherent) {
  const Run plain = run(scene, steps, "candidates");
  const Run faster = run(scene, steps, "");
  EXPECT_EQ(plain.num_coherent, 0);
  EXPECT_GT(faster.num_coherent, coherent * static_cast<double>(plain.bits.size()));
  for (std::size_t at = 0; at < plain.bits.size(); ++at)
    ASSERT_EQ(faster.bits[at], plain.bits[at]) << "step " << at / kInstances << ", instance " << at % kInstances;
}

void expectNoneShows(const Scene& scene, double coherent) {
  expectNoneShows(scene, slowPaths(scene, 11), coherent);
}

Scene sceneOf(Sensor sensor) {
  Random random(5);
  Scene scene{.sensor = std::move(sensor), .objects = {}, .outputs = {.penetration_depth = true}};
  scene.objects.emplace_back("bumpy", support::icosphere(0.01, 4, 0.05, random));
  scene.objects.emplace_back("sheet", support::sheetWithHoles(30, 0.03, 0.3, 0.1, random));
  scene.objects.emplace_back("fine", support::icosphere(0.012, 5, 0.002, random));
  return scene;
}

TEST(CandidatesOnEveryDriver, ChangeNoBit) {
  expectNoneShows(sceneOf(support::gridSensor()), 0.3);
}

// Objects that are fast for so long that the search for candidates pauses, then slow again.
TEST(Candidates, ReturnForObjectsThatSlowDown) {
  constexpr int kFast = 10;
  const Scene scene = sceneOf(support::gridSensor());
  std::vector<std::vector<Touch>> steps = slowPaths(scene, 11);
  for (int k = 0; k < kFast; ++k) {
    std::vector<Touch> handed_on = steps.front();
    std::rotate(handed_on.begin(), handed_on.begin() + 1, handed_on.end());
    steps.insert(steps.begin(), handed_on);
  }
  expectNoneShows(scene, steps, 0.1);
}

TEST(CandidateSchedule, BacksOffExponentiallyWithoutCandidates) {
  CandidateSchedule schedule;
  std::string frames;
  const auto run = [&](int num_frames, bool any) {
    for (frames.clear(); num_frames > 0; --num_frames) {
      const bool keeps = schedule.keeps();
      frames += keeps ? 'k' : '-';
      if (keeps) schedule.found(any);
    }
    return frames;
  };
  EXPECT_EQ(run(6, true), "kkkkkk");
  EXPECT_EQ(run(30, false), "kk----kk--------kk------------");
  EXPECT_EQ(run(100, false), "----kk" + std::string(32, '-') + "kk" + std::string(32, '-') + "kk" + std::string(26, '-'));
  EXPECT_EQ(run(12, true), "------kkkkkk");
  EXPECT_EQ(run(8, false), "kk----kk");  // as if there had never been none
}

TEST(Candidates, ChangeNoBitOfAFineMesh) {
  Scene scene = sceneOf(support::gridSensor());
  Random random(6);
  scene.objects.emplace_back("finest", support::icosphere(0.012, 6, 0.002, random));
  expectNoneShows(scene, 0.3);
}

TEST(Candidates, ChangeNoBitOfLargeTriangles) {
  Scene scene = sceneOf(support::gridSensor({.num_rows = 8, .num_cols = 8, .pitch_x = 0.5e-3, .pitch_y = 0.4e-3, .samples_per_taxel = 4}));
  Random random(7);
  scene.objects = {Object("coarse", support::icosphere(0.03, 3, 0.01, random)), scene.objects[0], Object("ball", Sphere{0.01})};
  expectNoneShows(scene, 0.3);
}

TEST(Candidates, ChangeNoBitOnATiltedPatch) {
  Sensor sensor = support::gridSensor();
  sensor.patches[0].X_SP = {{0.01, -0.02, 0.005}, axisAngle({0, 1, 0}, 0.4) * axisAngle({1, 0, 0}, 0.3)};
  Scene scene = sceneOf(sensor);
  scene.objects.resize(1);
  expectNoneShows(scene, 0.3);
}

TEST(Candidates, ChangeNoBitUnderFrictionDampingAndRelaxation) {
  Sensor sensor = support::gridSensor();
  sensor.skin.friction = {.tangential_stiffness = 5e7, .friction_coefficient = 0.8};
  sensor.skin.relaxation = {{.fraction = 0.4, .time = 0.01}};
  Scene scene = sceneOf(sensor);
  scene.outputs.tactile_shear_force = true;
  expectNoneShows(scene, 0.3);
  expectNoneShows(sceneOf(support::gridSensor({.law = {1.73e8, 1, 1e5}})), 0.3);
}

// The elastic layer also needs surfaces slightly above the skin.
TEST(CandidatesOnEveryDriver, ChangeNoBitOfATactileJacobian) {
  Scene scene = sceneOf(support::gridSensor());
  scene.outputs.tactile_jacobian = scene.outputs.clean_tactile_jacobian = true;
  expectNoneShows(scene, 0.3);
}

TEST(Candidates, ChangeNoBitOfAnElasticLayer) {
  Sensor sensor = support::gridSensor({.num_rows = 5, .num_cols = 6, .samples_per_taxel = 2});
  sensor.skin.law = ElasticLayer{.elastic_modulus = 1e6, .poisson_ratio = 0.49};
  expectNoneShows(sceneOf(sensor), 0.3);
}

// The largest batch that fits a device leaves no memory for candidates; it must still be accepted.
TEST(Candidates, DoNotReduceTheLargestBatch) {
  const Scene scene = sceneOf(support::gridSensor());
  const Model model(support::sharedDevice(), {.sensor = scene.sensor, .objects = scene.objects});
  const MemoryPlan one = Simulator::plan(model, {.num_instances = 1});
  const MemoryPlan most = Simulator::plan(model, {.num_instances = static_cast<int>(one.max_instances)});
  EXPECT_LT(most.bytes_per_instance, one.bytes_per_instance);
  EXPECT_EQ(most.max_instances, one.max_instances);
}

}  // namespace
}  // namespace taxelsim
