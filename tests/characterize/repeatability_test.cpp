// Repeated presses of one load: repeatability of a real sensor, the lower limit for a simulator. Recordings of a Weiss matrix
// (SCHUNK SDH-2 finger, P. Kiechle, tactile-sensors): a stamp of 10.5 mm under 200 to 900 g, one letter per load.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "scene/number_table.h"
#include "sensor/example_sensor.h"
#include "taxelsim/compare.h"

namespace taxelsim {
namespace {

constexpr double kAfterTouch = 5;  // s
// A loaded taxel has a standard deviation of 17 counts from frame to frame, the difference of two frames 1.4 times that.
constexpr double kNoise = 17.0 / 4095;  // of full scale
constexpr double kPairNoise = 1.4 * kNoise;

// The 13 rows of the finger are along y of our frame, its columns along x.
Sensor weissMatrix() {
  Sensor sensor = exampleSensor();
  sensor.patches = {{.name = "distal", .num_rows = 6, .num_cols = 13, .pitch = {0.0034, 0.0034}, .X_SP = {}}};
  return sensor;
}

// The image 5 s after contact of each press, by load and number.
std::map<char, std::vector<std::vector<float>>> presses() {
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(TAXELSIM_REAL_DATA) / "weiss_dsa")) {
    if (entry.path().filename().string().starts_with("calib__Room_temperature__")) files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  std::map<char, std::vector<std::vector<float>>> result;
  for (const std::filesystem::path& file : files) {
    const NumberTable table(file);
    const std::vector<std::size_t> columns = table.taxelColumns(weissMatrix(), "m1_r{col}_c{row}");
    Images images{.num_taxels = columns.size(), .time = {}, .counts = {}};
    for (std::size_t row = 0; row < table.numRows(); ++row) {
      images.time.push_back(table.at(row, 0));
      for (const std::size_t column : columns) images.counts.push_back(static_cast<float>(table.at(row, column)));
    }
    const float* const first = &images.counts[rowAfterTouch(images, kAfterTouch) * images.num_taxels];
    result[file.stem().string().rbegin()[1]].emplace_back(first, first + images.num_taxels);
  }
  return result;
}

// Expected ranges, fractions; the later press is the real one. The choice of the frame at 5 s changes every metric by the noise of two
// frames.
TEST(Repeatability, PressesOfOneLoad) {
  struct Bounds {
    double ImageComparison::*measure;
    double low, high, noise;
  };
  // At 200 g, where noise matters most: the largest taxel has 450 counts, all sum to 2500, their squares to 1000^2.
  const std::vector<Bounds> all_bounds{
      {&ImageComparison::median_difference, 0.0040, 0.0204, kPairNoise},
      {&ImageComparison::mean_difference, 0.0071, 0.0207, kPairNoise / 4},  // of 16 taxels
      {&ImageComparison::rms_difference, 0.013, 0.056, 1.4 * 17 / 450 / 8.8},
      {&ImageComparison::relative_l1, 0.03, 0.26, 1.4 * 17 * 4 / 2500},
      {&ImageComparison::cosine, 0.975, 1, 0.22 * 1.4 * 17 / 1000}};  // sin of the angle whose cosine is 0.975
  int num_pairs = 0;
  for (const auto& [load, images] : presses()) {
    for (std::size_t later = 1; later < images.size(); ++later) {
      for (std::size_t earlier = 0; earlier < later; ++earlier, ++num_pairs) {
        const ImageComparison c = compareImages(weissMatrix(), images[later], weissMatrix(), images[earlier]);
        const std::string pair = std::string() + load + std::to_string(earlier + 1) + " as seen by " + load + std::to_string(later + 1);
        printf("%s: M1 %.2f %%, M2 %.2f %%, M3 %.1f %%, M4 %.1f %%, M5 %.4f\n", pair.c_str(), 100 * c.median_difference,
               100 * c.mean_difference, 100 * c.rms_difference, 100 * c.relative_l1, c.cosine);
        for (const Bounds& bounds : all_bounds) {
          EXPECT_GE(c.*bounds.measure, bounds.low - bounds.noise) << pair;
          EXPECT_LE(c.*bounds.measure, bounds.high + bounds.noise) << pair;
        }
      }
    }
  }
  EXPECT_EQ(num_pairs, 10);
}

// A simulator without output, which M1 alone would accept.
TEST(Repeatability, AnAllZeroImage) {
  const std::map<char, std::array<double, 2>> all_bounds{{'A', {0.029, 0.039}}, {'B', {0.05, 0.08}}, {'C', {0.116, 0.116}}};
  const auto all = presses();
  for (const auto& [load, bounds] : all_bounds) {
    for (const std::vector<float>& image : all.at(load)) {
      const ImageComparison c = compareImages(weissMatrix(), image, weissMatrix(), std::vector<float>(image.size(), 0));
      printf("%c: M1 %.2f %%\n", load, 100 * c.median_difference);
      EXPECT_GE(c.median_difference, bounds[0] - kNoise) << load;
      EXPECT_LE(c.median_difference, bounds[1] + kNoise) << load;
      EXPECT_DOUBLE_EQ(c.relative_l1, 1) << load;
    }
  }
}

}  // namespace
}  // namespace taxelsim
