#include "reference/psf.h"

namespace taxelsim::reference {

std::vector<double> spread(const Sensor& sensor, std::span<const double> taxel_force) {
  const Psf& psf = sensor.psf;
  const int half = psf.size / 2;
  std::vector<double> image(taxel_force.size(), 0);
  std::size_t first_taxel = 0;
  for (const GridPatch& patch : sensor.patches) {
    const auto inside = [&](int i, int j) { return i >= 0 && i < patch.num_rows && j >= 0 && j < patch.num_cols; };
    const auto indexOf = [&](int i, int j) { return first_taxel + static_cast<std::size_t>(i) * patch.num_cols + j; };
    const auto weight = [&](int a, int b) { return psf.kernel[static_cast<std::size_t>(a + half) * psf.size + (b + half)]; };
    for (int i = 0; i < patch.num_rows; ++i) {
      for (int j = 0; j < patch.num_cols; ++j) {
        double total_weight = 0;
        for (int a = -half; a <= half; ++a) {
          for (int b = -half; b <= half; ++b) {
            total_weight += inside(i + a, j + b) ? weight(a, b) : 0;
          }
        }
        const double divisor = psf.normalization == Psf::Normalization::kPerSource ? total_weight : 1;
        if (divisor == 0) {
          continue;
        }
        for (int a = -half; a <= half; ++a) {
          for (int b = -half; b <= half; ++b) {
            if (inside(i + a, j + b)) {
              image[indexOf(i + a, j + b)] += taxel_force[indexOf(i, j)] * weight(a, b) / divisor;
            }
          }
        }
      }
    }
    first_taxel += static_cast<std::size_t>(patch.num_rows) * patch.num_cols;
  }
  return image;
}

}  // namespace taxelsim::reference
