// A step of some instances computes the first frames of new episodes and leaves all other instances as they are: every episode has the
// bits of the same episode alone in a simulator of its own.
#include "simulation/comparison.h"
#include "support/plain.h"
#include "support/random_scene.h"
#include "support/test.h"

namespace taxelsim {
namespace {

using support::Random;
using support::Touch;
using Bits = std::vector<std::uint32_t>;
using Selected = std::vector<std::uint8_t>;

constexpr int kNumInstances = 4;
constexpr int kNumFrames = 12;  // of an episode, at most

struct Case {
  Sensor sensor;
  std::vector<Object> objects{};
  OutputOptions outputs{};
  int num_slots = 1;
  int max_contacts = 0;
  int max_regions = 0;
  bool loads = false;    // drives every other episode by its load
  double motion = 2e-4;  // m per frame
  ReadoutVariation variation{.gain = 1.1f, .gain_spread = 0.1f, .noise = 3};
};

constexpr OutputOptions kAllOutputs{
    .contact_features = true, .clean_contact_features = true, .tactile_jacobian = true, .clean_tactile_jacobian = true};

Sensor smallSensor(const ContactLaw& law = Winkler{1.73e8, 1, 0}) {
  Sensor sensor = support::gridSensor({.num_rows = 3, .num_cols = 4, .samples_per_taxel = 2});
  sensor.skin.law = law;
  sensor.psf = gaussianPsf(0.6, 3);
  sensor.readout.curve = {2400};
  return sensor;
}

// Inputs of an episode. The same number gives the same inputs.
class Episode {
 public:
  Episode(const Case& of, int number) {
    Random random(static_cast<std::uint64_t>(1000 + number));
    load = of.loads && number % 2 == 0 ? static_cast<float>(random.uniform(0.2, 2)) : kPoseDriven;
    if (of.max_contacts > 0) {
      placeContacts(of, random);
    } else {
      placeObjects(of, random);
    }
  }

  float load = kPoseDriven;
  std::vector<Touch> touches;                       // (kNumFrames); empty for contacts
  std::vector<std::vector<ContactPoint>> contacts;  // (kNumFrames)

 private:
  void placeObjects(const Case& of, Random& random) {
    Sensor foundation = of.sensor;  // under which the depth of a first touch is found
    foundation.skin.law = Winkler{.normal_contact_stiffness = 1e8};
    Touch touch;
    for (int slot = 0; slot < of.num_slots; ++slot) {
      touch.ids.push_back(random.integer(0, static_cast<int>(of.objects.size()) - 1));
      touch.X_SO.push_back(support::randomContact(random, foundation, of.objects[static_cast<std::size_t>(touch.ids.back())]));
    }
    for (int frame = 0; frame < kNumFrames; ++frame) {
      touches.push_back(touch);
      for (Pose& X_SO : touch.X_SO) move(random, of.motion, X_SO);
    }
  }

  // Rolls, slides and lifts.
  static void move(Random& random, double size, Pose& X_SO) {
    const Vector3 axis{random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(0.1, 1)};
    X_SO.rotation = axisAngle(axis, random.uniform(0, 100) * size) * X_SO.rotation;
    for (double& coordinate : X_SO.position) coordinate += random.uniform(-1, 1) * size;
  }

  void placeContacts(const Case& of, Random& random) {
    for (int frame = 0; frame < kNumFrames; ++frame) {
      contacts.emplace_back();
      for (int k = random.integer(1, of.max_contacts); k > 0; --k) {
        contacts.back().push_back({{random.uniform(-6e-3, 6e-3), random.uniform(-8e-3, 8e-3), 0}, random.uniform(0.1, 1)});
      }
    }
  }
};

// Names the first value that differs.
void expectEqual(const Bits& found, const Bits& expected, const char* what, std::size_t number) {
  ASSERT_EQ(found.size(), expected.size());
  const auto difference = std::mismatch(found.begin(), found.end(), expected.begin());
  EXPECT_EQ(difference.first, found.end()) << what << " " << number << ": value " << difference.first - found.begin() << " of "
                                           << found.size() << " differs";
}

// A simulator whose instances run episodes. Every step sets the inputs of the next frame of all instances.
class Episodes {
 public:
  // An episode so far.
  struct Run {
    int number = 0;
    std::vector<double> steps;  // s, of every frame
    std::vector<Bits> frames;
  };

  Episodes(const Case& of, const Model& model, int num_instances)
      : case_(of),
        simulator_(model, {.num_instances = num_instances,
                           .num_slots = of.num_slots,
                           .seed = 5,
                           .outputs = of.outputs,
                           .max_contacts = of.max_contacts,
                           .max_regions = of.max_regions}),
        runs_(static_cast<std::size_t>(num_instances)) {}

  void start(int instance, int number) {
    simulator_.reset(instance, static_cast<std::uint64_t>(number), case_.variation);
    Run& run = runs_[static_cast<std::size_t>(instance)];
    if (!run.frames.empty()) ended_.push_back(run);
    run = {number, {}, {}};
  }

  void step(double dt) {
    setInputs();
    simulator_.step(dt);
    record(dt, Selected(runs_.size(), 1));
  }

  // The frames of the other instances must stay.
  void step(double dt, const Selected& selected) {
    const std::vector<Bits> before = bits();
    setInputs();
    simulator_.step(dt, selected);
    record(dt, selected);
    const std::vector<Bits> after = bits();
    for (std::size_t i = 0; i < runs_.size(); ++i) {
      if (selected[i] != 0) continue;
      expectEqual(after[i], before[i], "instance", i);
    }
  }

  std::vector<Run> all() const {
    std::vector<Run> runs = ended_;
    runs.insert(runs.end(), runs_.begin(), runs_.end());
    return runs;
  }
  int numCoherent() const { return num_coherent_; }

 private:
  std::vector<Bits> bits() {
    const FrameView frame = simulator_.read();
    std::vector<Bits> result;
    const auto n = static_cast<int>(runs_.size());
    for (int i = 0; i < n; ++i) result.push_back(support::bitsOf(frame, i, n));
    return result;
  }

  void setInputs() {
    for (std::size_t i = 0; i < runs_.size(); ++i) {
      const auto instance = static_cast<int>(i);
      const Episode episode(case_, runs_[i].number);
      const std::size_t frame = runs_[i].frames.size();
      if (case_.max_contacts > 0) {
        simulator_.setContacts(instance, episode.contacts.at(frame));
      } else {
        simulator_.setObjects(instance, episode.touches.at(frame).ids, episode.touches.at(frame).X_SO);
        simulator_.setLoad(instance, episode.load);
      }
    }
  }

  void record(double dt, const Selected& selected) {
    const std::vector<Bits> frames = bits();
    num_coherent_ += simulator_.timing().num_coherent;
    for (std::size_t i = 0; i < runs_.size(); ++i) {
      if (selected[i] == 0) continue;
      runs_[i].steps.push_back(dt);
      runs_[i].frames.push_back(frames[i]);
    }
  }

  const Case& case_;
  Simulator simulator_;
  std::vector<Run> runs_;   // (num_instances)
  std::vector<Run> ended_;  // before them
  int num_coherent_ = 0;
};

// Instances 0 and 2 run one episode for most of the time. Instances 1 and 3 start new ones: before the first step of all, alone, together,
// twice in a row, and while another instance has been reset but is not computed.
void runWithHeldInstances(Episodes& batch) {
  constexpr double kDt = 0.01, kOtherDt = 0.012;  // s
  for (int i = 0; i < kNumInstances; ++i) batch.start(i, 10 + i);
  batch.step(kDt, {0, 1, 0, 0});
  batch.step(kDt);
  batch.step(kOtherDt);
  batch.start(1, 20);
  batch.start(3, 23);
  batch.step(kOtherDt, {0, 1, 0, 0});
  batch.step(kDt);
  batch.start(1, 31);
  batch.start(3, 32);
  batch.step(kDt, {0, 1, 0, 255});
  batch.start(3, 43);
  batch.step(kDt, {0, 0, 0, 1});
  for (int k = 0; k < 4; ++k) batch.step(kDt);
  for (int i = 0; i < kNumInstances; ++i) batch.start(i, 50 + i);
  batch.step(kDt, {1, 1, 1, 1});
  batch.step(kDt);
}

// Returns how many instances used candidates, summed over the steps.
int expectEpisodesAsAlone(const Case& of) {
  const Model model(support::sharedDevice(), {.sensor = of.sensor, .objects = of.objects});
  Episodes batch(of, model, kNumInstances);
  runWithHeldInstances(batch);
  bool moved = false;
  for (const Episodes::Run& run : batch.all()) {
    SCOPED_TRACE("episode " + std::to_string(run.number));
    Episodes alone(of, model, 1);
    alone.start(0, run.number);
    for (const double dt : run.steps) alone.step(dt);
    const std::vector<Bits> expected = alone.all()[0].frames;
    for (std::size_t frame = 0; frame < expected.size(); ++frame) expectEqual(run.frames[frame], expected[frame], "frame", frame);
    moved = moved || (expected.size() > 1 && expected[0] != expected[1]);
  }
  EXPECT_TRUE(moved);
  return batch.numCoherent();
}

std::vector<Object> solids() {
  return {Object("ball", Sphere{6e-3}), Object("box", Box{{8e-3, 6e-3, 1e-2}})};
}

TEST(HeldInstancesOnEveryDriver, Friction) {
  Sensor sensor = smallSensor();
  sensor.skin.friction = {.tangential_stiffness = 5e7, .friction_coefficient = 0.8};
  expectEpisodesAsAlone({.sensor = sensor, .objects = solids(), .loads = true});
  expectEpisodesAsAlone({.sensor = sensor, .objects = solids(), .num_slots = 2});
}

TEST(HeldInstancesOnEveryDriver, Damping) {
  expectEpisodesAsAlone({.sensor = smallSensor(Winkler{1.73e8, 1.2, 1e5}), .objects = solids(), .loads = true});
}

TEST(HeldInstancesOnEveryDriver, Relaxation) {
  Sensor sensor = smallSensor();
  sensor.skin.relaxation = {{.fraction = 0.3, .time = 0.02}, {.fraction = 0.2, .time = 0.5}};
  sensor.skin.friction = {.tangential_stiffness = 5e7, .friction_coefficient = 0.8};
  expectEpisodesAsAlone({.sensor = sensor, .objects = solids(), .loads = true});
}

TEST(HeldInstancesOnEveryDriver, LuGre) {
  expectEpisodesAsAlone({.sensor = smallSensor(LuGre{.normal_contact_stiffness = 1e8}), .objects = solids(), .loads = true});
}

TEST(HeldInstancesOnEveryDriver, MassSpringDamper) {
  Sensor sensor = smallSensor(MassSpringDamper{.normal_contact_stiffness = 1e8});
  sensor.skin.friction = {.tangential_stiffness = 5e7, .friction_coefficient = 0.8};
  expectEpisodesAsAlone({.sensor = sensor, .objects = solids()});
}

TEST(HeldInstancesOnEveryDriver, DeformationMask) {
  expectEpisodesAsAlone({.sensor = smallSensor(DeformationMask{}), .objects = solids(), .outputs = kAllOutputs});
}

TEST(HeldInstancesOnEveryDriver, Proximity) {
  expectEpisodesAsAlone({.sensor = smallSensor(Proximity{.sensitivity = 1e8}), .objects = solids()});
}

TEST(HeldInstancesOnEveryDriver, ElasticLayer) {
  Sensor sensor = smallSensor(ElasticLayer{.elastic_modulus = 1e6});
  expectEpisodesAsAlone({.sensor = sensor, .objects = solids(), .outputs = kAllOutputs, .loads = true});
  sensor.skin.friction = {.tangential_stiffness = 5e7, .friction_coefficient = 0.8};
  sensor.skin.relaxation = {{.fraction = 0.4, .time = 0.05}};
  sensor.skin.margin = 3e-3;
  expectEpisodesAsAlone({.sensor = sensor, .objects = solids(), .loads = true});
}

TEST(HeldInstancesOnEveryDriver, TimeBehaviourAndImperfectionsOfReadout) {
  Sensor sensor = smallSensor();
  Readout& readout = sensor.readout;
  readout.hysteresis_strength = {0.2, 0.1};
  readout.hysteresis_width = {0.02, 0.1};
  readout.creep = {{0.2, 0.05}};
  readout.low_pass_time = 0.01;
  readout.delay = 0.015;
  readout.noise = 4;
  readout.bias = 10;
  readout.random_walk = 20;
  readout.dead_taxel_probability = 0.1;
  readout.press_gain_spread = 0.05;
  expectEpisodesAsAlone({.sensor = sensor, .objects = solids()});
  readout.jitter = 2e-3;
  sensor.frame_rate = 60;  // Hz, slower than the steps
  expectEpisodesAsAlone({.sensor = sensor, .objects = solids(), .outputs = kAllOutputs});
}

TEST(HeldInstancesOnEveryDriver, ContactFeaturesAndJacobian) {
  expectEpisodesAsAlone(
      {.sensor = smallSensor(), .objects = solids(), .outputs = kAllOutputs, .num_slots = 2, .max_regions = 2, .variation = {}});
}

// Loads are searched over tiles.
TEST(HeldInstancesOnEveryDriver, SeveralPatches) {
  Sensor sensor = smallSensor();
  support::addPatch(sensor, {{0.012, 0, 0}, axisAngle({0, 1, 0}, 0.1)});
  expectEpisodesAsAlone({.sensor = sensor, .objects = solids(), .outputs = kAllOutputs, .max_regions = 2, .loads = true});
  sensor.skin.friction = {.tangential_stiffness = 5e7, .friction_coefficient = 0.8};
  sensor.skin.relaxation = {{.fraction = 0.3, .time = 0.02}};
  expectEpisodesAsAlone({.sensor = sensor, .objects = solids(), .loads = true});
}

TEST(HeldInstancesOnEveryDriver, ListOfTaxels) {
  Sensor sensor = smallSensor();
  sensor.patches.clear();
  for (int k = 0; k < 8; ++k) {
    const double x = 3e-3 * (k % 4) - 4.5e-3, y = 3e-3 * (k / 4) - 1.5e-3;
    sensor.patches.push_back(taxelPatch("", {x, y, -10 * x * x}, {20 * x, 0, 1}, {3e-3, 3e-3}));
  }
  sensor.psf = Psf{.sigma = 2e-3};
  expectEpisodesAsAlone({.sensor = sensor,
                         .objects = solids(),
                         .outputs = {.contact_features = true, .clean_contact_features = true},
                         .max_regions = 2,
                         .loads = true});
}

TEST(HeldInstancesOnEveryDriver, ContactPoints) {
  expectEpisodesAsAlone({.sensor = smallSensor(),
                         .outputs = {.penetration_depth = false, .contact_features = true, .clean_contact_features = true},
                         .max_contacts = 5,
                         .max_regions = 2});
}

TEST(HeldInstancesOnEveryDriver, Meshes) {
  Random random(4);
  const std::vector<Object> bumps{Object("bumps", support::icosphere(0.01, 3, 0.02, random))};
  const int num_coherent = expectEpisodesAsAlone({.sensor = smallSensor(), .objects = bumps, .motion = 1e-6});
  EXPECT_TRUE(num_coherent > 0 || support::isSwitchedOff("candidates"));
  expectEpisodesAsAlone({.sensor = smallSensor(), .objects = bumps, .loads = true, .motion = 1e-6});
}

TEST(HeldInstancesOnEveryDriver, Polyhedra) {
  Random random(4);
  const std::vector<Object> prisms{support::randomPolyhedron(random, 0.02), support::randomPolyhedron(random, 0.02)};
  expectEpisodesAsAlone({.sensor = smallSensor(), .objects = prisms});
}

}  // namespace
}  // namespace taxelsim
