// Sensor and scene files: every setting is read into its field in SI units; defaults are those of the headers.
#include <numbers>

#include "scene_text.h"
#include "taxelsim/scene.h"
#include "taxelsim/sensor.h"

namespace taxelsim {
namespace {

// A few ulp: sines and cosines in products of three rotations.
constexpr double kRotationTolerance = 1e-15;

Sensor load(const std::string& text) {
  const testing::TemporaryDirectory directory;
  return loadSensor(directory.write("sensor.yaml", "format_version: 1\nname: x\n" + text));
}

constexpr const char* kGrid = "num_rows: 3\nnum_cols: 4\npitch: 0.0034\n";
constexpr const char* kRest = "skin: {thickness: 0.002, normal_contact_stiffness: 1.73e8}\nreadout: {curve: {counts_per_newton: 2400}}\n";

TEST(SensorFile, HasTheDefaultsOfTheHeader) {
  const Sensor sensor = load(std::string(kGrid) + kRest);
  EXPECT_EQ(sensor.name, "x");
  ASSERT_EQ(sensor.patches.size(), 1u);
  EXPECT_EQ(sensor.patches[0].num_rows, 3);
  EXPECT_EQ(sensor.patches[0].num_cols, 4);
  EXPECT_EQ(sensor.patches[0].pitch, (std::array<double, 2>{0.0034, 0.0034}));
  EXPECT_EQ(sensor.patches[0].X_SP, Pose{});
  EXPECT_EQ(sensor.samples_per_taxel, Sensor{}.samples_per_taxel);
  EXPECT_EQ(sensor.depth_sampling, Sensor{}.depth_sampling);
  EXPECT_EQ(sensor.frame_rate, Sensor{}.frame_rate);
  EXPECT_EQ(sensor.skin.thickness, 0.002);
  EXPECT_EQ(std::get<Winkler>(sensor.skin.law), (Winkler{.normal_contact_stiffness = 1.73e8}));
  EXPECT_EQ(sensor.skin.friction, Friction{});
  EXPECT_TRUE(sensor.skin.relaxation.empty());
  EXPECT_EQ(sensor.psf.size, Psf{}.size);
  EXPECT_EQ(sensor.psf.kernel, Psf{}.kernel);
  EXPECT_EQ(sensor.psf.normalization, Psf{}.normalization);
  EXPECT_EQ(sensor.readout.curve, std::vector<double>{2400});
  EXPECT_EQ(sensor.readout.output_scale, Readout{}.output_scale);
  EXPECT_EQ(sensor.readout.trigger, Readout{}.trigger);
  EXPECT_EQ(sensor.readout.adc_bits, Readout{}.adc_bits);
  EXPECT_EQ(sensor.readout.saturation, Readout{}.saturation);
  EXPECT_EQ(sensor.readout.noise, Readout{}.noise);
  EXPECT_TRUE(sensor.readout.taxel_gain.empty());
  EXPECT_TRUE(sensor.readout.taxel_trigger.empty());
  EXPECT_TRUE(sensor.readout.hysteresis_strength.empty());
  EXPECT_TRUE(sensor.readout.creep.empty());
  EXPECT_EQ(sensor.readout.low_pass_time, Readout{}.low_pass_time);
  EXPECT_EQ(sensor.readout.delay, Readout{}.delay);
  EXPECT_EQ(sensor.readout.jitter, Readout{}.jitter);
  EXPECT_EQ(sensor.readout.bias, Readout{}.bias);
  EXPECT_EQ(sensor.readout.random_walk, Readout{}.random_walk);
  EXPECT_EQ(sensor.readout.gain_spread, Readout{}.gain_spread);
  EXPECT_EQ(sensor.readout.press_gain_spread, Readout{}.press_gain_spread);
  EXPECT_EQ(sensor.readout.dead_taxel_probability, Readout{}.dead_taxel_probability);
}

// Three standard deviations of the noise are the trigger of a file that gives none.
TEST(SensorFile, NoiseAloneIsNoContact) {
  const auto readout = [](const std::string& settings) {
    return load("num_rows: 1\nnum_cols: 2\npitch_mm: 3\nskin: {thickness_mm: 2, normal_contact_stiffness: 1e8}\nreadout: {" + settings +
                "}\n")
        .readout;
  };
  EXPECT_EQ(readout("curve: {counts_per_newton: 1000}").trigger, 0);
  EXPECT_EQ(readout("curve: {counts_per_newton: 1000}, noise: 4").trigger, 0.012);
  EXPECT_EQ(readout("curve: {counts_per_newton: 1000}, noise: 4, output_scale: 2").trigger, 0.006);
  EXPECT_EQ(readout("curve: {coefficients: [400, 1]}, noise: 4").trigger, 0.03);
  EXPECT_EQ(readout("curve: {points: [[0.5, 100], [1, 2400]]}, noise: 4").trigger, 0.06);
  EXPECT_EQ(readout("curve: {coefficients: [0, 400]}, noise: 4").trigger, 0) << "none silences it";
  EXPECT_EQ(readout("curve: {counts_per_newton: 1000}, noise: 4, trigger: 0").trigger, 0);
  EXPECT_EQ(readout("curve: {counts_per_newton: 1000}, noise: 4, taxel_trigger: [0.1, 0.2]").trigger, 0);
}

TEST(SensorFile, ReadsEverySetting) {
  const Sensor sensor = load(R"(patches:
  - {name: a, num_rows: 1, num_cols: 2, pitch_mm: [3, 4], pose: {position_mm: [1, 2, 3], rotation: [0, 1, 0, 0]}}
  - {num_rows: 1, num_cols: 1, pitch: 0.005, pose: {rpy_deg: [0, 0, 90]}}
samples_per_taxel: 16
frame_rate: 31
skin: {thickness_mm: 1.5, law: winkler, normal_contact_stiffness: 2e8, normal_exponent: 1.5, normal_damping: 10,
       friction_coefficient: 0.6, tangential_stiffness: 5e7}
psf: {kernel: [[0, 1, 0], [2, 4, 2], [0, 1, 0.5]], normalization: none}
readout: {curve: {coefficients: [100, 2, 0.5]}, output_scale: 2, trigger: 0.1, adc_bits: 10, saturation: 1000, noise: 3,
          taxel_gain: [1, 2, 3], taxel_trigger: [0.1, 0.2, 0.3], hysteresis_strength: [0.1, 0.2], hysteresis_width: [0.3, 0.4],
          creep: [{fraction: 0.5, time: 6}, {time: 8, fraction: 0.7}], low_pass_time: 0.01, delay: 0.02, jitter: 0.03, bias: 4,
          random_walk: 5, gain_spread: 0.6, press_gain_spread: 0.7, dead_taxel_probability: 0.8,
          three_axis: {gain: [[1, 2, 3], [4, 5, 6], [7, 8, 9]], noise: [1, 2, 3], hysteresis_strength: [0.1, 0.2, 0.3],
                       hysteresis_width: [0.4, 0.5, 0.6], saturation: 99}}
)");
  ASSERT_EQ(sensor.patches.size(), 2u);
  EXPECT_EQ(sensor.patches[0].name, "a");
  EXPECT_EQ(sensor.patches[0].pitch, (std::array<double, 2>{0.003, 0.004}));
  EXPECT_EQ(sensor.patches[0].X_SP, (Pose{{0.001, 0.002, 0.003}, {0, 1, 0, 0}}));
  EXPECT_EQ(sensor.patches[1].name, "patch_1");
  const Vector3 turned = rotate(sensor.patches[1].X_SP.rotation, {1, 0, 0});
  EXPECT_NEAR(turned[0], 0, kRotationTolerance);
  EXPECT_NEAR(turned[1], 1, kRotationTolerance);
  EXPECT_EQ(sensor.samples_per_taxel, 16);
  EXPECT_EQ(sensor.frame_rate, 31);
  EXPECT_EQ(sensor.skin.thickness, 0.0015);
  EXPECT_EQ(std::get<Winkler>(sensor.skin.law), (Winkler{.normal_contact_stiffness = 2e8, .normal_exponent = 1.5, .normal_damping = 10}));
  EXPECT_EQ(sensor.skin.friction, (Friction{.tangential_stiffness = 5e7, .friction_coefficient = 0.6}));
  EXPECT_EQ(sensor.psf.size, 3);
  EXPECT_EQ(sensor.psf.kernel, (std::vector<double>{0, 1, 0, 2, 4, 2, 0, 1, 0.5}));
  EXPECT_EQ(sensor.psf.normalization, Psf::Normalization::kNone);
  EXPECT_EQ(sensor.readout.curve, (std::vector<double>{100, 2, 0.5}));
  EXPECT_EQ(sensor.readout.output_scale, 2);
  EXPECT_EQ(sensor.readout.trigger, 0.1);
  EXPECT_EQ(sensor.readout.adc_bits, 10);
  EXPECT_EQ(sensor.readout.saturation, 1000);
  EXPECT_EQ(sensor.readout.noise, 3);
  EXPECT_EQ(sensor.readout.taxel_gain, (std::vector<double>{1, 2, 3}));
  EXPECT_EQ(sensor.readout.taxel_trigger, (std::vector<double>{0.1, 0.2, 0.3}));
  EXPECT_EQ(sensor.readout.hysteresis_strength, (std::vector<double>{0.1, 0.2}));
  EXPECT_EQ(sensor.readout.hysteresis_width, (std::vector<double>{0.3, 0.4}));
  EXPECT_EQ(sensor.readout.creep, (std::vector<CreepTerm>{{0.5, 6}, {0.7, 8}}));
  EXPECT_EQ(sensor.readout.low_pass_time, 0.01);
  EXPECT_EQ(sensor.readout.delay, 0.02);
  EXPECT_EQ(sensor.readout.jitter, 0.03);
  EXPECT_EQ(sensor.readout.bias, 4);
  EXPECT_EQ(sensor.readout.random_walk, 5);
  EXPECT_EQ(sensor.readout.gain_spread, 0.6);
  EXPECT_EQ(sensor.readout.press_gain_spread, 0.7);
  EXPECT_EQ(sensor.readout.dead_taxel_probability, 0.8);
  EXPECT_EQ(sensor.readout.three_axis, (ThreeAxisReadout{.gain = {{{1, 2, 3}, {4, 5, 6}, {7, 8, 9}}},
                                                         .noise = {1, 2, 3},
                                                         .hysteresis_strength = {0.1, 0.2, 0.3},
                                                         .hysteresis_width = {0.4, 0.5, 0.6},
                                                         .saturation = 99}));
}

TEST(SensorFile, ReadsTheKeysOfElasticLayer) {
  const std::string readout = "readout: {curve: {counts_per_newton: 2400}}\n";
  const Sensor plain = load(kGrid + ("skin: {thickness_mm: 2, law: elastic_layer, elastic_modulus: 1e6, poisson_ratio: 0.45}\n" + readout));
  EXPECT_EQ(std::get<ElasticLayer>(plain.skin.law), (ElasticLayer{.elastic_modulus = 1e6, .poisson_ratio = 0.45}));
  EXPECT_EQ(plain.skin.margin, 0);
  const Sensor sensor =
      load(kGrid + ("skin: {thickness_mm: 2, law: elastic_layer, elastic_modulus: 2e6, poisson_ratio: 0.5, base: half_space, "
                    "iterations: 25, tolerance: 1e-4, margin_mm: 4, friction_coefficient: 0.6, tangential_stiffness: 5e7}\n" +
                    readout));
  EXPECT_EQ(
      std::get<ElasticLayer>(sensor.skin.law),
      (ElasticLayer{
          .elastic_modulus = 2e6, .poisson_ratio = 0.5, .base = ElasticLayer::Base::kHalfSpace, .iterations = 25, .tolerance = 1e-4}));
  EXPECT_EQ(sensor.skin.margin, 0.004);
  EXPECT_EQ(sensor.skin.friction, (Friction{.tangential_stiffness = 5e7, .friction_coefficient = 0.6}));
}

TEST(SensorFile, Relaxation) {
  const std::vector<RelaxationTerm> terms{{0.5, 6}, {0.2, 8}};
  for (const std::string law : {"winkler, normal_contact_stiffness: 1e8", "mass_spring_damper, normal_contact_stiffness: 1e8",
                                "deformation_mask", "elastic_layer, elastic_modulus: 1e6, poisson_ratio: 0.45"}) {
    const Sensor sensor = load(
        "num_rows: 1\nnum_cols: 1\npitch: 0.003\nskin: {thickness: 0.002, relaxation: [{fraction: 0.5, time: 6}, "
        "{time: 8, fraction: 0.2}], law: " +
        law + "}\nreadout: {curve: {counts_per_newton: 2400}}\n");
    EXPECT_EQ(sensor.skin.relaxation, terms);
  }
}

TEST(SensorFile, ReadsGainsInRows) {
  const std::string readout = "skin: {thickness: 0.002, normal_contact_stiffness: 1.73e8}\nreadout: {curve: {counts_per_newton: 2400}, ";
  const std::vector<double> expected{1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12};
  EXPECT_EQ(load(kGrid + readout + "taxel_gain: [[1, 2, 3, 4], [5, 6, 7, 8], [9, 10, 11, 12]]}").readout.taxel_gain, expected);
  EXPECT_EQ(load(kGrid + readout + "taxel_gain: [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12]}").readout.taxel_gain, expected);
}

TEST(SensorFile, ReadsOneElementOfHysteresisAsNumber) {
  const Sensor sensor = load(std::string(kGrid) +
                             "skin: {thickness: 0.002, normal_contact_stiffness: 1.73e8}\nreadout: {curve: {counts_per_newton: 2400}, "
                             "hysteresis_strength: 0.1, hysteresis_width: 0.2}");
  EXPECT_EQ(sensor.readout.hysteresis_strength, std::vector<double>{0.1});
  EXPECT_EQ(sensor.readout.hysteresis_width, std::vector<double>{0.2});
}

TEST(SensorFile, FullScaleDependsOnAdcBits) {
  const std::string text =
      std::string(kGrid) +
      "skin: {thickness: 0.002, normal_contact_stiffness: 1.73e8}\nreadout: {curve: {counts_per_newton: 100}, adc_bits: 8}\n";
  EXPECT_EQ(load(text).readout.saturation, 255);
}

TEST(SensorFile, ReadsEveryLaw) {
  const std::string readout = "\nreadout: {curve: {counts_per_newton: 2400}}\n";
  const auto law = [&](const std::string& skin) {
    return load(std::string(kGrid) + "skin: {thickness_mm: 2, law: " + skin + "}" + readout).skin.law;
  };
  EXPECT_EQ(law("mass_spring_damper, normal_contact_stiffness: 1e8"), ContactLaw(MassSpringDamper{.normal_contact_stiffness = 1e8}));
  EXPECT_EQ(law("mass_spring_damper, normal_contact_stiffness: 1e8, mass: 2, stiffness: 3, damping: 4"),
            ContactLaw(MassSpringDamper{1e8, 2, 3, 4}));
  EXPECT_EQ(law("deformation_mask"), ContactLaw(DeformationMask{}));
  EXPECT_EQ(law("deformation_mask, normal_contact_stiffness: 1e7, saturation_pressure: 1e5"), ContactLaw(DeformationMask{1e7, 1e5}));
  EXPECT_EQ(law("proximity, sensitivity: 5e7"), ContactLaw(Proximity{5e7}));
  EXPECT_EQ(law("lugre, normal_contact_stiffness: 1e8"), ContactLaw(LuGre{.normal_contact_stiffness = 1e8}));
  EXPECT_EQ(law("lugre, normal_contact_stiffness: 1e8, bristle_stiffness: 2, bristle_damping: 3, viscous_friction: 4, static_friction: 6, "
                "coulomb_friction: 5, stribeck_velocity: 7"),
            ContactLaw(LuGre{1e8, 2, 3, 4, 6, 5, 7}));
}

TEST(SensorFile, AppliesRollThenPitchThenYaw) {
  // Roll rotates y to z, pitch z to x, yaw x to y.
  const Sensor sensor = load(std::string(kGrid) + "pose: {rpy_deg: [90, 90, 90]}\n" + kRest);
  const Vector3 turned = rotate(sensor.patches[0].X_SP.rotation, {0, 1, 0});
  EXPECT_NEAR(turned[0], 0, kRotationTolerance);
  EXPECT_NEAR(turned[1], 1, kRotationTolerance);
  EXPECT_NEAR(turned[2], 0, kRotationTolerance);
}

TEST(SensorFile, NormalizesQuaternions) {
  const Sensor sensor = load(std::string(kGrid) + "pose: {rotation: [0.7071, 0.7071, 0, 0]}\n" + kRest);
  const Quaternion& q = sensor.patches[0].X_SP.rotation;
  EXPECT_NEAR(q[0] * q[0] + q[1] * q[1], 1, kRotationTolerance);
}

TEST(SceneFile, HasTheDefaultsOfTheHeader) {
  const testing::TemporaryDirectory directory;
  const std::string sensor = std::string("format_version: 1\nname: x\n") + kGrid + kRest;
  directory.write("sensors/x.yaml", sensor);
  const Scene scene = loadScene(directory.write("scene.yaml", R"(format_version: 1
name: plain
kind: servo
sensor: sensors/x.yaml
objects: [{half_space: {}}, {sphere: {radius: 1}}, {sphere: {radius: 1}}]
episode: {num_steps: 3}
randomization: {depth_mm: 1}
controller: {tactile_servo: {edge_angle: {kp: 1}}}
)"));
  const Scene expected;
  EXPECT_EQ(scene.sensor.name, "x");
  ASSERT_EQ(scene.objects.size(), 3u);
  EXPECT_EQ(scene.objects[0].object.name, "half_space");
  EXPECT_EQ(scene.objects[1].object.name, "sphere");
  EXPECT_EQ(scene.objects[2].object.name, "sphere_2");
  EXPECT_EQ(scene.objects[0].weight, 1);
  EXPECT_EQ(scene.num_steps, 3);
  EXPECT_EQ(scene.simulation_rate, expected.simulation_rate);
  EXPECT_EQ(scene.control_rate, expected.control_rate);
  const FeatureLoop &angle = scene.controllers[0].servo[ServoFeature::kEdgeAngle], loop;
  EXPECT_TRUE(angle.selected);
  EXPECT_EQ(angle.reference, loop.reference);
  EXPECT_EQ(angle.ki, loop.ki);
  EXPECT_EQ(angle.kd, loop.kd);
  EXPECT_EQ(angle.error_limit, loop.error_limit);
  EXPECT_FALSE(scene.controllers[0].servo[ServoFeature::kTotalForce].selected);
  EXPECT_EQ(scene.controllers[0].servo.max_linear_velocity, expected.controllers[0].servo.max_linear_velocity);
  EXPECT_EQ(scene.controllers[0].servo.min_confidence, expected.controllers[0].servo.min_confidence);
  EXPECT_EQ(scene.num_episodes, expected.num_episodes);
  EXPECT_EQ(scene.episodes_per_shard, expected.episodes_per_shard);
  EXPECT_EQ(scene.compression, expected.compression);
  EXPECT_EQ(scene.chunk_bytes, expected.chunk_bytes);
  EXPECT_EQ(scene.randomization.gain.min, 1);
  EXPECT_EQ(scene.randomization.noise.max, 0);
  ASSERT_TRUE(scene.randomization.depth.has_value());
  EXPECT_FALSE(scene.randomization.load.has_value());
  EXPECT_EQ(scene.randomization.depth->min, 0.001);
  EXPECT_EQ(scene.randomization.depth->max, 0.001);
  EXPECT_EQ(scene.record, (std::vector<std::string>{"tactile_image", "features", "ground_truth", "poses", "actions"}));
  EXPECT_EQ(scene.max_regions, 0);
}

TEST(SceneFile, ReadsEverySetting) {
  const testing::TemporaryDirectory directory;
  directory.write("meshes/mesh.obj", kMeshText);
  std::string text = edited(kScene, "sphere: {radius_mm: 5}", "{mesh: meshes/mesh.obj, scale: 2, up_axis: x, name: m}");
  text = edited(text, "    weight: 2\n", "");
  text = edited(text, "{edge_angle: {kp: 0.78}}",
                "{edge_angle: {kp: 1, ki: 2, kd: 0.3, reference_deg: 90, error_limit_deg: 180, integral_limit: 5, derivative_limit: 6}, "
                "total_force: {kp: 2.5, reference: 7}, center_x: {kp: 3, reference_mm: 8, error_limit_mm: 9}, center_y: {kp: 4}, "
                "exploration_velocity_mm: -4, max_angular_velocity: 5, max_linear_velocity_mm: 6, min_confidence: 0.7}");
  text = edited(text, "  yaw_deg: 30\n",
                "  y: [0.001, 0.002]\n  yaw_deg: 180\n  tilt: [0, 0.1]\n  gain: 2\n  gain_spread: 0.1\n  noise: [1, 2]\n");
  text = edited(text, "seed: 7", "seed: 18446744073709551615, episodes_per_shard: 5, compression: 9, chunk_bytes: 65536");
  text = edited(text, "[tactile_image, features]", "[actions, contact_features, penetration_depth]\nmax_regions: 6");
  const Scene scene = loadScene(directory.write("scene.yaml", text));
  EXPECT_EQ(scene.name, "small_scene");
  EXPECT_EQ(scene.kind, Scene::Kind::kServo);
  ASSERT_EQ(scene.objects.size(), 2u);
  EXPECT_EQ(scene.objects[0].object.name, "m");
  ASSERT_TRUE(std::holds_alternative<Mesh>(scene.objects[0].object.shape));
  EXPECT_EQ(std::get<Mesh>(scene.objects[0].object.shape).triangles.size(), 2u);
  EXPECT_EQ(std::get<Cylinder>(scene.objects[1].object.shape).length, 0.04);
  EXPECT_EQ(scene.num_steps, 20);
  EXPECT_EQ(scene.control_rate, 50);
  const FeatureLoop &angle = scene.controllers[0].servo[ServoFeature::kEdgeAngle],
                    &force = scene.controllers[0].servo[ServoFeature::kTotalForce], &x = scene.controllers[0].servo[ServoFeature::kCenterX],
                    &y = scene.controllers[0].servo[ServoFeature::kCenterY];
  EXPECT_TRUE(angle.selected && force.selected && x.selected && y.selected);
  EXPECT_FALSE(scene.controllers[0].servo[ServoFeature::kCenterAcross].selected);
  EXPECT_EQ(angle.kp, 1);
  EXPECT_EQ(angle.ki, 2);
  EXPECT_EQ(angle.kd, 0.3);
  EXPECT_EQ(angle.reference, std::numbers::pi / 2);
  EXPECT_EQ(angle.error_limit, std::numbers::pi);
  EXPECT_EQ(angle.integral_limit, 5);
  EXPECT_EQ(angle.derivative_limit, 6);
  EXPECT_EQ(force.kp, 2.5);
  EXPECT_EQ(force.reference, 7);
  EXPECT_EQ(x.kp, 3);
  EXPECT_EQ(x.reference, 0.008);
  EXPECT_EQ(x.error_limit, 0.009);
  EXPECT_EQ(y.kp, 4);
  EXPECT_FALSE(y.reference);
  EXPECT_EQ(scene.controllers[0].servo.exploration_velocity, -0.004);
  EXPECT_EQ(scene.controllers[0].servo.max_angular_velocity, 5);
  EXPECT_EQ(scene.controllers[0].servo.max_linear_velocity, 0.006);
  EXPECT_EQ(scene.controllers[0].servo.min_confidence, 0.7);
  const Randomization& random = scene.randomization;
  EXPECT_EQ(random.x.min, -0.002);
  EXPECT_EQ(random.x.max, 0.002);
  EXPECT_EQ(random.y.max, 0.002);
  EXPECT_EQ(random.yaw.min, std::numbers::pi);
  EXPECT_EQ(random.tilt.max, 0.1);
  EXPECT_EQ(random.load->min, 0.5);
  EXPECT_EQ(random.gain.max, 2);
  EXPECT_EQ(random.gain_spread.min, 0.1);
  EXPECT_EQ(random.noise.max, 2);
  EXPECT_EQ(scene.num_episodes, 10u);
  EXPECT_EQ(scene.seed, 18446744073709551615u);
  EXPECT_EQ(scene.episodes_per_shard, 5u);
  EXPECT_EQ(scene.compression, 9);
  EXPECT_EQ(scene.chunk_bytes, 65536u);
  EXPECT_EQ(scene.record, (std::vector<std::string>{"penetration_depth", "contact_features", "actions"}));
  EXPECT_EQ(scene.max_regions, 6);
}

// The simplification of a flat plate of 20 x 20 cells keeps the vertices of its border only.
TEST(SceneFile, SimplifiesMeshesWithinMaxDepthError) {
  constexpr int kCells = 20;
  const testing::TemporaryDirectory directory;
  std::string plate;
  for (int i = 0; i <= kCells; ++i) {
    for (int j = 0; j <= kCells; ++j) plate += "v " + std::to_string(1e-3 * i) + " " + std::to_string(1e-3 * j) + " 0\n";
  }
  for (int i = 0; i < kCells; ++i) {
    for (int j = 1; j <= kCells; ++j) {
      const std::string a = std::to_string(i * (kCells + 1) + j), b = std::to_string(i * (kCells + 1) + j + 1);
      const std::string c = std::to_string((i + 1) * (kCells + 1) + j + 1), d = std::to_string((i + 1) * (kCells + 1) + j);
      plate += "f " + a + " " + d + " " + c + "\nf " + a + " " + c + " " + b + "\n";
    }
  }
  directory.write("plate.obj", plate);
  const auto numTriangles = [&](const std::string& setting) {
    const std::string text = edited(kScene, "sphere: {radius_mm: 5}", "mesh: plate.obj" + setting);
    return std::get<Mesh>(loadScene(directory.write("scene.yaml", text)).objects[0].object.shape).triangles.size();
  };
  EXPECT_EQ(numTriangles("\n    max_depth_error: 0"), 800u);
  EXPECT_LT(numTriangles("\n    max_depth_error_mm: 0.01"), 200u);
  EXPECT_LT(numTriangles(""), 200u);
}

TEST(SceneFile, NamesManyObjectsInLinearTime) {
  constexpr int kMany = 50'000;  // takes minutes if the search for each name starts at the first one
  const testing::TemporaryDirectory directory;
  const std::string text(kScene);
  std::string objects = "objects:\n  - {name: sphere_3, sphere: {radius: 1}}\n";
  for (int i = 0; i < kMany; ++i) objects += "  - sphere: {radius: 1}\n";
  const Scene scene =
      loadScene(directory.write("scene.yaml", text.substr(0, text.find("objects:")) + objects + text.substr(text.find("episode:"))));
  EXPECT_EQ(scene.objects[1].object.name, "sphere");
  EXPECT_EQ(scene.objects[2].object.name, "sphere_2");
  EXPECT_EQ(scene.objects[3].object.name, "sphere_4");
  EXPECT_EQ(scene.objects.back().object.name, "sphere_" + std::to_string(kMany + 1));
}

TEST(SceneFile, ReadsEverySolid) {
  const testing::TemporaryDirectory directory;
  const std::string text(kScene);
  const Scene scene = loadScene(directory.write("scene.yaml", text.substr(0, text.find("objects:")) + R"(objects:
  - sphere: {radius_mm: 1}
  - cylinder: {radius_mm: 1, length_mm: 2}
  - capsule: {radius_mm: 1, length: 0}
  - box: {size_mm: [1, 2, 3]}
  - half_space: {}
  - cone: {radius_mm: 1, height_mm: 2}
  - torus: {major_radius_mm: 2, minor_radius_mm: 1}
)" + text.substr(text.find("episode:"))));
  ASSERT_EQ(scene.objects.size(), 7u);
  const auto shape = [&](std::size_t i) -> const Shape& { return scene.objects[i].object.shape; };
  EXPECT_EQ(std::get<Sphere>(shape(0)).radius, 0.001);
  EXPECT_EQ(std::get<Cylinder>(shape(1)).radius, 0.001);
  EXPECT_EQ(std::get<Capsule>(shape(2)).length, 0);
  EXPECT_EQ(std::get<Box>(shape(3)).size, (Vector3{0.001, 0.002, 0.003}));
  EXPECT_TRUE(std::holds_alternative<HalfSpace>(shape(4)));
  EXPECT_EQ(std::get<Cone>(shape(5)).height, 0.002);
  EXPECT_EQ(std::get<Torus>(shape(6)).major_radius, 0.002);
  EXPECT_EQ(std::get<Torus>(shape(6)).minor_radius, 0.001);
}

}  // namespace
}  // namespace taxelsim
