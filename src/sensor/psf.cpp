#include <cmath>
#include <string>

#include "base/text.h"
#include "taxelsim/error.h"
#include "taxelsim/sensor.h"

namespace taxelsim {
namespace {

constexpr double kPi = 3.14159265358979323846;

}  // namespace

Psf gaussianPsf(double sigma, int size, Psf::Normalization normalization) {
  if (size < 1 || size > kMaxKernelSize || size % 2 == 0) {
    throw Error("psf.size", std::to_string(size) + " is not allowed: taxels per side, odd, 1 to " + std::to_string(kMaxKernelSize));
  }
  const double density = 1 / (2 * kPi * sigma * sigma);
  if (!(std::isfinite(sigma) && sigma > 0 && std::isfinite(density) && density > 0)) {
    throw Error("psf.sigma", numberText(sigma) + " is not allowed: taxels, > 0");
  }

  Psf psf;
  psf.size = size;
  psf.normalization = normalization;
  psf.kernel.clear();
  const int reach = size / 2;
  for (int a = -reach; a <= reach; ++a) {
    for (int b = -reach; b <= reach; ++b) psf.kernel.push_back(density * std::exp(-(a * a + b * b) / (2 * sigma * sigma)));
  }
  return psf;
}

}  // namespace taxelsim
