// Readouts fitted to recordings of real single taxels, converted by scripts/convert_recordings.py: resistive foil under a 6 mm
// tip (TAMS), Velostat under a robot.
#include "reference/readout.h"
#include "support/temporary_directory.h"
#include "support/test.h"
#include "taxelsim/characterize.h"

namespace taxelsim::testing {
namespace {

struct Recording {
  const char* name;
  double most_rms;  // of the largest output: misfit of the readout model, measured and rounded up (docs/notes/validation.md)
};

// Without pike1_force_1, whose baseline drifts by more than the response.
constexpr std::array<Recording, 4> kRecordings{
    {{"tams_nosil", 0.025}, {"tams_thinsil", 0.025}, {"pike1_force_10", 0.055}, {"pike1_force_40", 0.055}}};

// A fitted polynomial of degree 5 may turn down beyond the forces of the fit: more force never reads less there.
void expectMonotone(const Readout& readout, double last) {
  double before = 0;
  for (double force = 0; force <= last; force += last / 1000) {
    const double counts = std::min<double>(reference::analogueOutput(readout, force, 1, readout.trigger, 0), readout.saturation);
    EXPECT_GE(counts, before) << force << " N";
    before = std::max(0.0, counts);
  }
}

TEST(SingleTaxelRecordings, AreFittedWithinAFewPercent) {
  const TemporaryDirectory directory;
  const std::string command =
      "python3 -B " TAXELSIM_SOURCE_DIR "/scripts/convert_recordings.py " TAXELSIM_REAL_DATA " " + directory.path().string();
  ASSERT_EQ(std::system(command.c_str()), 0);
  for (const Recording& recording : kRecordings) {
    std::vector<Measurement> measurements{loadMeasurement(directory / (std::string(recording.name) + ".yaml"))};
    auto& curve = std::get<ForceCurve>(measurements.front().data);
    const double largest = *std::max_element(curve.counts.begin(), curve.counts.end());
    const Characterization result = characterize(measurements);
    const FitQuality& quality = result.fits.front();
    std::printf("%-16s rms %.1f of %.0f counts, %zu of %zu rows outliers\n", recording.name, quality.rms, largest, quality.num_outliers,
                quality.num_rows);
    EXPECT_LT(quality.rms / largest, recording.most_rms) << recording.name;
    EXPECT_LT(quality.num_outliers, quality.num_rows / 5) << recording.name;
    curve.curve_degree = kMaxCurveDegree;
    expectMonotone(characterize(measurements).sensor.readout, 3 * *std::max_element(curve.force.begin(), curve.force.end()));
  }
}

}  // namespace
}  // namespace taxelsim::testing
