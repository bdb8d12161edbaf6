// Restores the error bound of a simplified mesh: where the two surfaces are farther apart than allowed, inserts vertices of the original or
// flips edges, until HausdorffBound proves the bound in both directions. The number of triangles never decreases.
//
// One round:
//   1. find violations: distances of the original's vertices (cheap), and only if all are within the bound, the proof for all triangles
//   2. sort the violating triangles by distance, largest first
//   3. for each, if no neighbour has changed it in this round:
//      insert the missing vertex at the nearest edge, in all triangles that share the edge, else inside the triangle;
//      where no vertex is missing, the triangulations differ: flip the nearest edge
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "geometry/hausdorff_bound.h"
#include "geometry/triangle_tree.h"
#include "taxelsim/object.h"

namespace taxelsim {

class SimplificationRepair {
 public:
  using Triangle = std::array<std::uint32_t, 3>;  // vertices of the original

  // `original` must outlive this object. `max_error` in m.
  SimplificationRepair(const Mesh& original, double max_error);

  // Changes `triangles` until their two-sided Hausdorff distance to the original is at most max_error. Returns nothing if that takes more
  // than `max_triangles` or 20 rounds, or if the budget is exhausted. Edges with a single triangle are kept.
  std::optional<std::vector<Triangle>> run(std::vector<Triangle> triangles, std::size_t max_triangles);

  // True once all calls together have used up the budget of operations; later calls of run() then fail.
  bool isExhausted() const { return budget_.isExhausted(); }

 private:
  // The worst point at which a triangle of the simplified mesh violates the bound, in either direction.
  struct Violation {
    double distance = 0;                  // m; 0: none
    std::optional<std::uint32_t> vertex;  // vertex of the original to insert; none where the simplified mesh has all those nearby
    Vector3 point{0, 0, 0};
  };
  struct Edge {
    std::uint32_t low;  // vertices, low < high
    std::uint32_t high;
    std::uint32_t triangle;

    Edge(std::uint32_t a, std::uint32_t b, std::uint32_t index) : low(std::min(a, b)), high(std::max(a, b)), triangle(index) {}
  };

  void findViolationsAtVertices(const TriangleTree& tree);
  void findViolationsOfTriangles(const TriangleTree& tree);
  void addViolation(std::uint32_t triangle, const Triangle& nearest_original, const Vector3& point);

  bool repairViolations();
  bool insertVertex(std::uint32_t triangle);
  bool flipEdge(std::uint32_t triangle);
  void replace(std::uint32_t triangle, std::span<const Triangle> parts);

  std::array<Edge, 3> edgesOf(std::uint32_t triangle) const;
  std::span<const Edge> edgesEqualTo(const Edge& edge) const;
  std::array<Triangle, 2> splitAtEdge(const Edge& edge, std::uint32_t vertex) const;
  static std::uint32_t cornerOpposite(const Edge& edge, const Triangle& triangle);
  static bool isBefore(const Edge& a, const Edge& b);
  double squaredDistanceTo(const Edge& edge, const Vector3& point) const;
  bool hasArea(const Triangle& triangle) const;
  Vector3 positionOf(std::uint32_t vertex) const;

  const Mesh& original_;
  TriangleTree original_tree_;
  std::vector<std::uint32_t> vertices_;  // those of the original that a triangle uses
  double max_error_;
  SearchBudget budget_;

  Mesh simplified_;              // all vertices of the original
  std::vector<bool> is_used_;    // (num_vertices): in the simplified mesh
  std::vector<bool> is_proven_;  // (num_triangles of simplified_): proven to be within the bound of the original

  // State of one round. Violations and edges refer to the simplified mesh at its start.
  std::vector<Violation> violations_;  // (num_triangles)
  bool has_violations_ = false;
  std::vector<Edge> edges_;       // three per triangle, sorted, so that equal edges of different triangles are adjacent
  std::vector<bool> is_changed_;  // (num_triangles)
};

}  // namespace taxelsim
