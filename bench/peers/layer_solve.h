// Contact of an elastic layer by conjugate gradients on an active set, for one instance at a time; whoever calls it computes the products
// with the influence matrix A. The equations, the stop and the iteration of shaders/elastic_layer/solver.glsl, after I. A. Polonsky and L.
// M. Keer, Wear 231 (1999) 206, with the residual updated, not computed again: one product per iteration, and a second one where the
// step released or pressed nodes.
//
// Pressures x are those that move their own node by x (m), so that A has ones on its diagonal.
#pragma once

#include <cstddef>
#include <vector>

namespace taxelsim::bench {

// Nodes in rows that are padded, so that a vector may begin at any of them.
struct LayerGrid {
  int num_rows = 0, num_cols = 0;
  int stride = 0;  // from row to row

  LayerGrid(int rows, int cols);
  std::size_t size() const { return static_cast<std::size_t>(num_rows) * static_cast<std::size_t>(stride); }
  std::size_t at(int row, int col) const {
    return static_cast<std::size_t>(row) * static_cast<std::size_t>(stride) + static_cast<std::size_t>(col);
  }
};

inline constexpr float kNoOverlap = -1e3f;  // m, where there is no surface, and in the padding

// When to stop, what may be touched, and where contact is taken to be at first.
struct LayerLimits {
  float tolerance = 0;       // of the residual, as `tolerance` of ElasticLayer
  int max_iterations = 0;    // `iterations` of ElasticLayer
  float reach = 0;           // nodes with an overlap of at most -reach times the deepest are not touched
  float beyond_contact = 0;  // share of the deepest overlap up to which nodes are out of contact at first, without a frame before
};

// Nodes of a row that may be touched: whole vectors from the first one.
struct RowPart {
  int row = 0, first = 0, num_vectors = 0;
};

// Smallest rectangle around the nodes that may be touched.
struct LayerWindow {
  int first_row = 0, end_row = 0, first_col = 0, end_col = 0;

  int numRows() const { return end_row - first_row; }
  int numCols() const { return end_col - first_col; }
};

// Deepest overlap (m), and the parts above -reach times it, which replace those of `parts`.
float partsInReach(const LayerGrid& grid, const float* overlaps, float reach, std::vector<RowPart>& parts, LayerWindow& window);

class LayerSolve {
 public:
  LayerSolve(const LayerGrid& grid, const LayerLimits& limits);

  // Begins with the signed overlaps (m), padded, and from the pressures of the frame before where they fit; `pressures` becomes the
  // solution. Returns whether a product is needed: A input() over parts(), written to product(). Both padded. What lies outside of the
  // parts does not matter.
  bool begin(const float* overlaps, float* pressures, bool cold);
  // Goes on with the product; returns whether another one is needed.
  bool advance();

  const float* input() const { return input_; }
  float* product() { return product_.data(); }
  const std::vector<RowPart>& parts() const { return parts_; }
  const LayerWindow& window() const { return window_; }
  int iterations() const { return iteration_; }
  float residual() const { return residual_; }

 private:
  enum class Stage { kGuess, kDirection, kCorrection };

  bool fits(float deepest) const;
  void scaleGuess();
  bool takeStep();
  void correct();
  bool check();

  LayerGrid grid_;
  LayerLimits limits_;
  std::vector<float> overlap_, r_, t_, change_, product_;
  std::vector<RowPart> parts_;
  LayerWindow window_;
  float* x_ = nullptr;
  const float* input_ = nullptr;
  Stage stage_ = Stage::kGuess;
  float deepest_ = 0, residual_ = 0;
  float slope_ = 0;   // sum of r times t
  float before_ = 0;  // sum of r^2 before the step; 0 restarts the directions
  int iteration_ = 0;
};

}  // namespace taxelsim::bench
