// A triangle mesh in packs of sixteen triangles, and the skin's samples under it: packs that neither reach the skin nor hold a sample are
// left out by their boxes, sixteen boxes at once and level by level; of the others sixteen triangles are set up at once, and their samples
// written into a tile of depths.
#pragma once

#include <cstdint>
#include <vector>

#include "peers/sample_view.h"
#include "taxelsim/object.h"

namespace taxelsim::bench {

class VectorMesh {
 public:
  explicit VectorMesh(const Mesh& mesh);

  struct Scratch {
    std::vector<Floats> tile;           // (num_taxels): height of the lowest surface under the skin's, m
    std::vector<std::uint32_t> packs;   // that may touch
    std::vector<std::uint32_t> groups;  // of a level above
  };
  Scratch scratch(const TaxelStage& stage) const;

  // Stages 1 and 2: forces of all taxels that are touched; the rows in which they lie.
  TaxelRange press(const SampleView& view, const TaxelStage& stage, Scratch& scratch, TaxelStage::Scratch& taxels) const;

 private:
  struct Pack {
    Floats x[3], y[3], z[3];  // corners in O, m
  };
  // Sixteen boxes: middles and half lengths.
  struct Boxes {
    Floats x, y, z, half_x, half_y, half_z;
  };

  void addBoxes(std::vector<Boxes>& level, const std::vector<std::array<float, 6>>& boxes) const;
  TaxelRange cull(const SampleView& view, Scratch& scratch) const;

  std::vector<Pack> packs_;
  std::vector<std::vector<Boxes>> levels_;  // of packs first; each level's boxes are sixteen of the one before
};

}  // namespace taxelsim::bench
