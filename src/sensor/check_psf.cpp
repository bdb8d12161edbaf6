// Checks of the point spread function.
#include <algorithm>
#include <vector>

#include "sensor/checks.h"
#include "sensor/skin.h"

namespace taxelsim {

double kernelSum(const Psf& psf) {
  double sum = 0;
  for (const double weight : psf.kernel) sum += weight;
  return sum;
}

namespace {

// Every taxel must send some of its force to a taxel of its own patch, or the normalization per source divides by zero.
void checkReach(const Psf& psf, const GridPatch& patch) {
  const int reach = psf.size / 2;
  for (int i = 0; i < patch.num_rows; ++i) {
    for (int j = 0; j < patch.num_cols; ++j) {
      double sum = 0;
      for (int a = std::max(-reach, -i); a <= std::min(reach, patch.num_rows - 1 - i); ++a) {
        for (int b = std::max(-reach, -j); b <= std::min(reach, patch.num_cols - 1 - j); ++b) {
          sum += psf.kernel[static_cast<std::size_t>((a + reach) * psf.size + b + reach)];
        }
      }
      if (!(sum > 0)) {
        failField("psf.kernel",
                  "a kernel that sends all force of taxel (" + std::to_string(i) + ", " + std::to_string(j) + ") off its patch",
                  "with normalization per source, some weight inside; a middle > 0 always has it");
      }
    }
  }
}

void checkSpreadByDistance(const Sensor& sensor) {
  const Psf& psf = sensor.psf;
  checkNumber("psf.sigma", psf.sigma, Allowed::above(0, "m"));
  checkNumber("psf.reach", psf.reach, Allowed::atLeast(0, "m"));
  if (psf.size != 1 || psf.kernel != std::vector<double>{1}) failField("psf.sigma", "a value together with `kernel`", "only one of them");
  skinNeighbours(sensor);  // refuses a reach over too many taxels
}

}  // namespace

void checkPsf(const Sensor& sensor) {
  const Psf& psf = sensor.psf;
  if (psf.sigma != 0 || psf.reach != 0) return checkSpreadByDistance(sensor);
  if (psf.size < 1 || psf.size > kMaxKernelSize || psf.size % 2 == 0) {
    failField("psf.size", std::to_string(psf.size), "taxels per side, odd, 1 to " + std::to_string(kMaxKernelSize));
  }
  const std::size_t num_weights = static_cast<std::size_t>(psf.size) * static_cast<std::size_t>(psf.size);
  if (psf.kernel.size() != num_weights) {
    failField("psf.kernel", std::to_string(psf.kernel.size()) + " weights", std::to_string(num_weights) + ", size x size");
  }
  for (std::size_t i = 0; i < psf.kernel.size(); ++i) checkNumber(elementOf("psf.kernel", i), psf.kernel[i], Allowed::atLeast(0, ""));
  checkNumber("psf.kernel", kernelSum(psf), Allowed::above(0, "as the sum of weights"));
  if (psf.normalization == Psf::Normalization::kPerSource && !(psf.kernel[num_weights / 2] > 0)) {
    for (const GridPatch& patch : sensor.patches) checkReach(psf, patch);
  }
}

}  // namespace taxelsim
