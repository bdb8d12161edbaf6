// Every scene and sensor file of the project loads and states the source of its numbers.
#include "scene_text.h"
#include "support/test.h"
#include "taxelsim/scene.h"
#include "taxelsim/sensor.h"

namespace taxelsim {
namespace {

const std::filesystem::path kScenes = std::filesystem::path(TAXELSIM_SOURCE_DIR) / "scenes";

std::vector<std::filesystem::path> yamlFiles(const std::filesystem::path& directory) {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(directory)) {
    if (entry.path().extension() == ".yaml") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  return files;
}

TEST(ShippedScenes, AllLoad) {
  const std::vector<std::filesystem::path> files = yamlFiles(kScenes);
  EXPECT_GE(files.size(), 3u);
  for (const std::filesystem::path& file : files) {
    SCOPED_TRACE(file);
    const Scene scene = loadScene(file);
    EXPECT_EQ(scene.name, file.stem().string());
    // The sensors of a grasp are those of its hand.
    EXPECT_TRUE(scene.kind == Scene::Kind::kGrasp || scene.sensor.name.ends_with("_realistic")) << "makes data for learning";
    EXPECT_EQ(scene.resolved.find(TAXELSIM_SOURCE_DIR), std::string::npos) << "contains a path of this machine";
  }
}

TEST(ShippedTasks, LoadAndHaveTasks) {
  const std::vector<std::filesystem::path> files = yamlFiles(kScenes / "tasks");
  EXPECT_GE(files.size(), 6u);
  for (const std::filesystem::path& file : files) {
    SCOPED_TRACE(file);
    const Scene scene = loadScene(file);
    EXPECT_EQ(scene.name, file.stem().string());
    EXPECT_TRUE(scene.task.has_value());
  }
}

// Scatter of gains of real matrices, which scripts/make_sensors.py cites.
constexpr double kLeastScatter = 0.3, kMostScatter = 0.6;

// Every condition of a benchmark scene loads, with a sensor that has the faults of a real one.
TEST(ShippedBenchmark, HasTasksAndConditions) {
  const std::vector<std::filesystem::path> files = yamlFiles(kScenes / "benchmark");
  EXPECT_GE(files.size(), 6u);
  for (const std::filesystem::path& file : files) {
    SCOPED_TRACE(file);
    const Scene scene = loadScene(file);
    EXPECT_EQ(scene.name, file.stem().string());
    EXPECT_EQ(scene.task.has_value(), scene.kind == Scene::Kind::kServo);
    EXPECT_EQ(scene.conditions, (std::vector<std::string>{"randomized", "unseen"}));
    const Scene randomized = loadScene(file, {.condition = "randomized"}), unseen = loadScene(file, {.condition = "unseen"});
    EXPECT_TRUE(scene.sensor.name.ends_with("_calibrated")) << scene.sensor.name;
    EXPECT_TRUE(randomized.sensor.name.ends_with("_realistic")) << randomized.sensor.name;
    EXPECT_EQ(unseen.sensor.name, "wts0614_unseen");
    for (const Scene* condition : {&randomized, &unseen}) {
      const double least = condition->sensor.readout.gain_spread, most = std::hypot(least, condition->randomization.gain_spread.max);
      EXPECT_GE(least, kLeastScatter);
      EXPECT_LE(most, kMostScatter);
      EXPECT_GT(condition->sensor.readout.press_gain_spread, 0);
      EXPECT_GT(condition->sensor.readout.noise, 0);
      EXPECT_FALSE(condition->sensor.readout.creep.empty());
    }
    EXPECT_GT(unseen.randomization.gain.min, randomized.randomization.gain.max);
    EXPECT_GT(unseen.randomization.gain_spread.min, randomized.randomization.gain_spread.max);
    EXPECT_GT(unseen.randomization.noise.min, randomized.randomization.noise.max);
  }
}

TEST(ShippedSensors, AllLoad) {
  const std::vector<std::filesystem::path> files = yamlFiles(kScenes / "sensors");
  EXPECT_GE(files.size(), 6u);
  for (const std::filesystem::path& file : files) {
    SCOPED_TRACE(file);
    EXPECT_EQ(loadSensor(file).name, file.stem().string());
  }
}

// The writer compared with the reader, for the layouts, laws, spreads and readouts of the shipped sensors.
TEST(ShippedSensors, SensorTextReadsBackAsTheSameSensor) {
  const testing::TemporaryDirectory directory;
  std::vector<Sensor> sensors;
  for (const std::filesystem::path& file : yamlFiles(kScenes / "sensors")) sensors.push_back(loadSensor(file));
  Sensor& odd = sensors.emplace_back(sensors.front());
  odd.name = "on \"#1\"";
  odd.readout.creep = {{.fraction = 0.1, .time = 1}, {.fraction = 0.2, .time = 8}};
  odd.readout.hysteresis_strength = {0.1, 0.2};
  odd.readout.hysteresis_width = {0.3, 0.4};
  odd.readout.taxel_gain.assign(static_cast<std::size_t>(numTaxels(odd)), 1.25);
  odd.readout.curve = {1, 2, 3};
  odd.readout.curve_limit = 5000;
  odd.depth_sampling = DepthSampling::kArea;
  odd.skin.relaxation = {{.fraction = 0.25, .time = 2}};
  Sensor& pieces = sensors.emplace_back(sensors.front());
  pieces.readout.curve = {1};
  pieces.readout.curve_points = {{.force = 0.1, .counts = 1.0 / 3}, {.force = 2, .counts = 4e3}};
  for (const Sensor& sensor : sensors) {
    SCOPED_TRACE(sensor.name);
    const std::filesystem::path file =
        directory.write("first.yaml", sensorText(sensor, {{"", "a head"}, {"readout.trigger", "0.02 (0.01 to 0.03) N: # measured"}}));
    const Sensor again = loadSensor(file);
    EXPECT_TRUE(sensorText(again) == sensorText(sensor));
    EXPECT_EQ(again.depth_sampling, sensor.depth_sampling);
    EXPECT_EQ(again.readout.curve, sensor.readout.curve);
    EXPECT_EQ(again.readout.curve_points, sensor.readout.curve_points);
    EXPECT_EQ(again.readout.curve_limit, sensor.readout.curve_limit);
    EXPECT_EQ(again.readout.creep, sensor.readout.creep);
    EXPECT_EQ(again.readout.taxel_gain, sensor.readout.taxel_gain);
    EXPECT_EQ(again.psf.kernel, sensor.psf.kernel);
    EXPECT_EQ(again.skin.law, sensor.skin.law);
    EXPECT_EQ(again.skin.relaxation, sensor.skin.relaxation);
    EXPECT_EQ(taxelPositions(again), taxelPositions(sensor));
  }
}

TEST(ShippedSensors, RealisticVariantsHaveTheScatterOfRealArraysAndNothingElse) {
  int num_variants = 0;
  for (const std::filesystem::path& file : yamlFiles(kScenes / "sensors")) {
    const std::string name = file.stem().string();
    const std::size_t end = name.find("_realistic");
    if (end == std::string::npos) continue;
    SCOPED_TRACE(file);
    ++num_variants;
    const Sensor base = loadSensor(kScenes / "sensors" / (name.substr(0, end) + ".yaml"));
    const Sensor variant = loadSensor(file);
    EXPECT_EQ(taxelPositions(variant), taxelPositions(base));
    EXPECT_EQ(variant.skin.law, base.skin.law);
    EXPECT_EQ(variant.psf.kernel, base.psf.kernel);
    EXPECT_EQ(variant.psf.sigma, base.psf.sigma);
    EXPECT_EQ(variant.depth_sampling, base.depth_sampling);
    EXPECT_EQ(variant.frame_rate, base.frame_rate);
    EXPECT_EQ(variant.readout.curve, base.readout.curve);
    EXPECT_GE(variant.readout.gain_spread, kLeastScatter);
    EXPECT_LE(variant.readout.gain_spread, kMostScatter);
    EXPECT_GT(variant.readout.press_gain_spread, 0);
    EXPECT_GT(variant.readout.noise, 0);
    EXPECT_GE(variant.readout.trigger, base.readout.trigger);
  }
  EXPECT_EQ(num_variants, 7);
}

// A calibration removes the scatter of gains between taxels, and nothing else of what makes an array real.
TEST(ShippedSensors, CalibratedVariantDiffersFromTheRealisticOneInGainsAlone) {
  Sensor calibrated = loadSensor(kScenes / "sensors/wts0614_soft_cover_calibrated.yaml");
  const Sensor realistic = loadSensor(kScenes / "sensors/wts0614_soft_cover_realistic.yaml");
  // Repeated presses of real fingers, per taxel (docs/reference/measurements.md).
  EXPECT_EQ(calibrated.readout.gain_spread, 0.04);
  calibrated.name = realistic.name;
  calibrated.readout.gain_spread = realistic.readout.gain_spread;
  EXPECT_EQ(sensorText(calibrated), sensorText(realistic));
}

TEST(ShippedSensors, WeissArrayHasThePapersNumbers) {
  const Sensor sensor = loadSensor(kScenes / "sensors/wts0614_soft_cover.yaml");
  EXPECT_EQ(numTaxels(sensor), 84);
  EXPECT_EQ(sensor.patches[0].pitch[0], 0.0034);
  // 2 N/mm over one taxel, rounded to three digits.
  constexpr double kThreeDigits = 0.5e6;
  EXPECT_NEAR(std::get<Winkler>(sensor.skin.law).normal_contact_stiffness, 2000 / (0.0034 * 0.0034), kThreeDigits);
  const Sensor pin = loadSensor(kScenes / "sensors/wts0614_pin.yaml");
  // The paper's linear range: 0 counts at 0.2 N, 3840 at 1.8 N.
  constexpr double kRounding = 1e-12;
  EXPECT_NEAR(nominalForce(pin.readout, 3840), 1.8, kRounding);
  EXPECT_EQ(pin.readout.trigger, 0.2);
}

TEST(ShippedSensors, EveryNumberHasItsSource) {
  for (const std::filesystem::path& file : yamlFiles(kScenes / "sensors")) {
    std::ifstream stream(file);
    std::string line;
    for (int number = 1; std::getline(stream, line); ++number) {
      const std::string code = line.substr(0, line.find('#'));
      // One comment above a list of taxels states the source of all.
      if (code.starts_with("  - {position")) continue;
      const bool is_setting =
          code.starts_with("taxels:") || (code.find_first_of("0123456789") != std::string::npos && !code.starts_with("format_version") &&
                                          code.find("name:") == std::string::npos);
      if (!is_setting) continue;
      const std::string comment = line.size() > code.size() ? line.substr(code.size()) : "";
      const bool sourced = comment.find("assumption") != std::string::npos || comment.find("paper") != std::string::npos ||
                           comment.find("full scale") != std::string::npos || comment.find("source: ") != std::string::npos;
      EXPECT_TRUE(sourced) << file << ":" << number << ": " << line;
    }
  }
}

}  // namespace
}  // namespace taxelsim
