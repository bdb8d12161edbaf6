#include <algorithm>

#include "taxelsim/sensor.h"

namespace taxelsim {

int numTaxels(const Sensor& sensor) {
  int count = 0;
  for (const GridPatch& patch : sensor.patches) count += patch.num_rows * patch.num_cols;
  return count;
}

std::vector<Vector3> taxelPositions(const Sensor& sensor) {
  std::vector<Vector3> positions;
  positions.reserve(static_cast<std::size_t>(numTaxels(sensor)));
  for (const GridPatch& patch : sensor.patches) {
    for (int i = 0; i < patch.num_rows; ++i) {
      for (int j = 0; j < patch.num_cols; ++j) {
        const double x = (i - 0.5 * (patch.num_rows - 1)) * patch.pitch[0];
        const double y = (j - 0.5 * (patch.num_cols - 1)) * patch.pitch[1];
        positions.push_back(patch.X_SP * Vector3{x, y, 0});
      }
    }
  }
  return positions;
}

// Grids lie centred on their patch frames, so it is the mean of the patch origins, weighted by size.
Vector3 arrayMiddle(const Sensor& sensor) {
  Vector3 middle{0, 0, 0};
  for (const GridPatch& patch : sensor.patches) {
    const double part = static_cast<double>(patch.num_rows) * patch.num_cols / numTaxels(sensor);
    for (std::size_t k = 0; k < 3; ++k) middle[k] += part * patch.X_SP.position[k];
  }
  return middle;
}

bool isTaxelList(const Sensor& sensor) {
  return sensor.patches.size() > 1 && std::all_of(sensor.patches.begin(), sensor.patches.end(),
                                                  [](const GridPatch& patch) { return patch.num_rows == 1 && patch.num_cols == 1; });
}

std::vector<Vector3> taxelNormals(const Sensor& sensor) {
  std::vector<Vector3> normals;
  normals.reserve(static_cast<std::size_t>(numTaxels(sensor)));
  for (const GridPatch& patch : sensor.patches) {
    const auto count = static_cast<std::size_t>(patch.num_rows * patch.num_cols);
    normals.insert(normals.end(), count, rotate(patch.X_SP.rotation, {0, 0, 1}));
  }
  return normals;
}

}  // namespace taxelsim
