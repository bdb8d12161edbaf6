// A triangle mesh in packs of sixteen triangles. A hierarchy of boxes, sixteen at once, culls packs that do not reach the skin or hold no
// sample. The triangles of the remaining packs are set up sixteen at once and rastered into a tile of depths.
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
    std::vector<Floats> tile;           // m, (num_taxels x 16): height of the lowest surface below the skin's
    std::vector<std::uint32_t> packs;   // packs that may touch
    std::vector<std::uint32_t> groups;  // boxes of the level above
  };
  Scratch scratch(const TaxelStage& stage) const;

  // Stages 1 and 2: writes the forces of all touched taxels and returns their range.
  TaxelRange press(const SampleView& view, const TaxelStage& stage, Scratch& scratch, TaxelStage::Scratch& taxels) const;

 private:
  struct Pack {
    Floats x[3], y[3], z[3];  // corners in O, m
  };
  // Sixteen boxes: centres and half lengths.
  struct Boxes {
    Floats x, y, z, half_x, half_y, half_z;
  };

  void addBoxes(std::vector<Boxes>& level, const std::vector<std::array<float, 6>>& boxes) const;
  TaxelRange cull(const SampleView& view, Scratch& scratch) const;

  std::vector<Pack> packs_;
  std::vector<std::vector<Boxes>> levels_;  // level 0: boxes of packs; each box of a level covers sixteen of the level below
};

}  // namespace taxelsim::bench
