#include "reference/psf.h"

#include <cmath>
#include <vector>

#include "base/vector3.h"
#include "sensor/skin.h"

namespace taxelsim::reference {
namespace {

// Calls visit(source, taxel, weight, divisor) for all pairs within reach along the skin.
template <typename Function>
void forEachWeightAlongSkin(const Sensor& sensor, Function visit) {
  const std::vector<Vector3> positions = taxelPositions(sensor), normals = taxelNormals(sensor);
  std::vector<double> weights(positions.size());
  for (std::size_t source = 0; source < positions.size(); ++source) {
    double total_weight = 0;
    for (std::size_t t = 0; t < weights.size(); ++t) {
      weights[t] = skinWeight(sensor.psf, skinDistance(positions[source], normals[source], positions[t], normals[t]));
      total_weight += weights[t];
    }
    const double divisor = sensor.psf.normalization == Psf::Normalization::kPerSource ? total_weight : 1;
    for (std::size_t t = 0; t < weights.size(); ++t) {
      if (weights[t] > 0) visit(source, t, weights[t], divisor);
    }
  }
}

// Calls visit(source, taxel, weight, divisor) for all pairs under the kernel, patch by patch.
template <typename Function>
void forEachWeightInPatches(const Sensor& sensor, Function visit) {
  const Psf& psf = sensor.psf;
  const int half = psf.size / 2;
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
            if (inside(i + a, j + b)) visit(indexOf(i, j), indexOf(i + a, j + b), weight(a, b), divisor);
          }
        }
      }
    }
    first_taxel += static_cast<std::size_t>(patch.num_rows) * patch.num_cols;
  }
}

template <typename Function>
void forEachWeight(const Sensor& sensor, Function visit) {
  if (sensor.psf.sigma > 0) {
    forEachWeightAlongSkin(sensor, visit);
  } else {
    forEachWeightInPatches(sensor, visit);
  }
}

// Parallel transport of the tangential vector v_S from a point with normal n to one with normal m, by the shortest rotation.
Vector3 parallelTransport(const Vector3& v_S, const Vector3& n, const Vector3& m) {
  const Vector3 axis = cross(n, m);
  const double sine = length(axis);
  return sine > 0 ? rotate(axisAngle(axis, std::atan2(sine, dot(n, m))), v_S) : v_S;
}

std::vector<Shear> spreadShearAlongSkin(const Sensor& sensor, std::span<const Shear> taxel_shear) {
  std::vector<Quaternion> R_SP;
  for (const GridPatch& patch : sensor.patches) {
    R_SP.insert(R_SP.end(), static_cast<std::size_t>(patch.num_rows * patch.num_cols), patch.X_SP.rotation);
  }
  const std::vector<Vector3> normals = taxelNormals(sensor);
  std::vector<Shear> image(taxel_shear.size(), {0, 0});
  forEachWeightAlongSkin(sensor, [&](std::size_t source, std::size_t t, double weight, double divisor) {
    const double share = weight / divisor;
    const Vector3 shear_S = rotate(R_SP[source], {taxel_shear[source][0], taxel_shear[source][1], 0});
    const Vector3 shear_P = rotate(inverse({{0, 0, 0}, R_SP[t]}).rotation, parallelTransport(shear_S, normals[source], normals[t]));
    for (std::size_t axis = 0; axis < 2; ++axis) image[t][axis] += share * shear_P[axis];
  });
  return image;
}

}  // namespace

std::vector<Share> spreadMatrix(const Sensor& sensor) {
  std::vector<Share> shares;
  forEachWeight(sensor, [&](std::size_t source, std::size_t taxel, double weight, double divisor) {
    shares.push_back({source, taxel, weight / divisor});
  });
  return shares;
}

std::vector<double> spread(const Sensor& sensor, std::span<const double> taxel_force) {
  std::vector<double> image(taxel_force.size(), 0);
  forEachWeight(sensor, [&](std::size_t source, std::size_t taxel, double weight, double divisor) {
    image[taxel] += taxel_force[source] * weight / divisor;
  });
  return image;
}

std::vector<Shear> spreadShear(const Sensor& sensor, std::span<const Shear> taxel_shear) {
  if (sensor.psf.sigma > 0) {
    return spreadShearAlongSkin(sensor, taxel_shear);
  }
  std::vector<Shear> result(taxel_shear.size());
  for (std::size_t axis = 0; axis < 2; ++axis) {
    std::vector<double> component;
    for (const Shear& force : taxel_shear) component.push_back(force[axis]);
    const std::vector<double> image = spread(sensor, component);
    for (std::size_t t = 0; t < image.size(); ++t) result[t][axis] = image[t];
  }
  return result;
}

}  // namespace taxelsim::reference
