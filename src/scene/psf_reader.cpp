#include "scene/psf_reader.h"

#include <optional>
#include <string>
#include <vector>

namespace taxelsim {
namespace {

int readKernelSize(const YamlNode& node) {
  const std::uint64_t size = node.integer(1, kMaxKernelSize);
  if (size % 2 == 0) node.refuse("an odd whole number from 1 to " + std::to_string(kMaxKernelSize));
  return static_cast<int>(size);
}

std::vector<double> readKernel(const YamlNode& node, const Allowed& allowed, Canonical& canonical) {
  const std::string what = "a square list of rows of weights, their number odd and at most " + std::to_string(kMaxKernelSize);
  const std::vector<YamlNode> rows = node.items(what);
  if (rows.size() % 2 == 0 || rows.size() > static_cast<std::size_t>(kMaxKernelSize)) node.refuse(what);
  std::vector<double> kernel;
  std::string text;
  double sum = 0;
  for (const YamlNode& row : rows) {
    const std::vector<double> weights = row.numbers(allowed, rows.size());
    kernel.insert(kernel.end(), weights.begin(), weights.end());
    for (const double weight : weights) sum += weight;
    text += (text.empty() ? "" : ", ") + canonicalList(weights);
  }
  if (sum <= 0) node.fail("the weights sum to 0: at least one must be > 0");
  canonical.line("kernel", "[" + text + "]");
  return kernel;
}

}  // namespace

Psf readPsf(const YamlMap& sensor) {
  const YamlMap map(sensor, "psf");
  Canonical& canonical = map.canonical();
  const std::optional<YamlNode> kernel = map.find("kernel"), skin_gaussian = map.find("skin_gaussian");
  Psf psf;
  map.rejectBoth("skin_gaussian", "gaussian");
  map.rejectBoth("kernel", "skin_gaussian");
  map.rejectBoth("kernel", "gaussian");
  if (skin_gaussian) {
    const YamlMap gaussian(map, "skin_gaussian");
    psf.sigma = gaussian.number("sigma");
    psf.reach = gaussian.number("reach", gaussian.allowedOf("reach"), 3 * psf.sigma);
  } else if (map.has("gaussian")) {
    const YamlMap gaussian(map, "gaussian");
    const double sigma = gaussian.number("sigma");
    const int size = readKernelSize(gaussian.require("size", "an odd whole number from 1 to " + std::to_string(kMaxKernelSize)));
    canonical.line("size", std::to_string(size));
    psf = gaussianPsf(sigma, size);
  } else if (kernel) {
    psf.kernel = readKernel(*kernel, map.allowedOf("kernel"), canonical);
    psf.size = static_cast<int>(kernel->items("").size());
  } else {
    canonical.line("kernel", "[[1]]");
  }
  psf.normalization = map.choice<Psf::Normalization>("normalization");
  return psf;
}

}  // namespace taxelsim
