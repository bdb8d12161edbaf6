// Triangle mesh of a patch's undeformed skin surface: the form in which Kappassov, Corrales and Perdereau, AIM 2020, give the sensor to the
// collision detection of a physics engine. Used by benchmarks and tests.
#pragma once

#include <cstdint>

#include "taxelsim/object.h"
#include "taxelsim/sensor.h"

namespace taxelsim::reference {

// Regular grid in the plane z = 0 of P: cells_per_taxel x cells_per_taxel cells per taxel (cells_per_taxel >= 1), two triangles per cell.
inline Mesh skinMesh(const GridPatch& patch, int cells_per_taxel) {
  const int rows = patch.num_rows * cells_per_taxel, cols = patch.num_cols * cells_per_taxel;
  Mesh mesh;
  for (int i = 0; i <= rows; ++i) {
    for (int j = 0; j <= cols; ++j) {
      mesh.vertices.push_back({static_cast<float>((i - rows / 2.0) * patch.pitch[0] / cells_per_taxel),
                               static_cast<float>((j - cols / 2.0) * patch.pitch[1] / cells_per_taxel), 0});
    }
  }
  const auto vertex = [&](int i, int j) { return static_cast<std::uint32_t>(i * (cols + 1) + j); };
  for (int i = 0; i < rows; ++i) {
    for (int j = 0; j < cols; ++j) {
      mesh.triangles.push_back({vertex(i, j), vertex(i + 1, j), vertex(i + 1, j + 1)});
      mesh.triangles.push_back({vertex(i, j), vertex(i + 1, j + 1), vertex(i, j + 1)});
    }
  }
  return mesh;
}

}  // namespace taxelsim::reference
