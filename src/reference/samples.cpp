#include "reference/samples.h"

namespace taxelsim::reference {

std::vector<Sample> samplesOf(const Sensor& sensor) {
  const int s = sensor.samples_per_taxel;
  std::vector<Sample> samples;
  int taxel = 0;
  for (int p = 0; p < static_cast<int>(sensor.patches.size()); ++p) {
    const GridPatch& patch = sensor.patches[p];
    const double area = patch.pitch[0] * patch.pitch[1] / (s * s);
    for (int i = 0; i < patch.num_rows; ++i) {
      for (int j = 0; j < patch.num_cols; ++j, ++taxel) {
        const double x = (i - (patch.num_rows - 1) / 2.0) * patch.pitch[0];
        const double y = (j - (patch.num_cols - 1) / 2.0) * patch.pitch[1];
        for (int a = 0; a < s; ++a) {
          for (int b = 0; b < s; ++b) {
            samples.push_back(
                {p, taxel, {x + ((a + 0.5) / s - 0.5) * patch.pitch[0], y + ((b + 0.5) / s - 0.5) * patch.pitch[1], 0}, area});
          }
        }
      }
    }
  }
  return samples;
}

}  // namespace taxelsim::reference
