#include "geometry/outward.h"

#include <algorithm>
#include <limits>
#include <tuple>
#include <utility>

#include "base/vector3.h"
#include "geometry/enclosed.h"
#include "geometry/weld.h"

namespace taxelsim {
namespace {

constexpr std::uint32_t kNone = std::numeric_limits<std::uint32_t>::max();

// Half-edge h runs from corner h % 3 of triangle h / 3 to the next corner.
std::pair<std::uint32_t, std::uint32_t> endsOf(const Mesh& mesh, std::uint32_t h) {
  const auto& triangle = mesh.triangles[h / 3];
  return {triangle[h % 3], triangle[(h + 1) % 3]};
}

bool isAscending(const Mesh& mesh, std::uint32_t h) {
  const auto [from, to] = endsOf(mesh, h);
  return from < to;
}

// The other half-edge along the same edge, in either direction, for each half-edge. Empty unless every edge has exactly two.
std::vector<std::uint32_t> twinsOf(const Mesh& mesh) {
  struct Edge {
    std::uint32_t low, high, half_edge;
    bool isAlong(const Edge& other) const { return low == other.low && high == other.high; }
  };
  const auto num_half_edges = static_cast<std::uint32_t>(3 * mesh.triangles.size());
  std::vector<Edge> edges;
  edges.reserve(num_half_edges);
  for (std::uint32_t h = 0; h < num_half_edges; ++h) {
    const auto [low, high] = std::minmax({endsOf(mesh, h).first, endsOf(mesh, h).second});
    edges.push_back({low, high, h});
  }
  std::sort(edges.begin(), edges.end(), [](const Edge& a, const Edge& b) { return std::tie(a.low, a.high) < std::tie(b.low, b.high); });
  std::vector<std::uint32_t> twins(num_half_edges);
  for (std::size_t n = 0; n < edges.size(); n += 2) {
    if (n + 1 == edges.size() || !edges[n].isAlong(edges[n + 1])) return {};
    if (n + 2 < edges.size() && edges[n].isAlong(edges[n + 2])) return {};
    twins[edges[n].half_edge] = edges[n + 1].half_edge;
    twins[edges[n + 1].half_edge] = edges[n].half_edge;
  }
  return twins;
}

struct Orientation {
  std::vector<std::uint32_t> component_of;  // (num_triangles)
  std::vector<bool> is_flipped;             // (num_triangles), against the first triangle of the component
  std::uint32_t num_components = 0;
};

// Flood fill over edges, so that the two triangles at every edge run along it in opposite directions. Returns nothing if they cannot.
std::optional<Orientation> orient(const Mesh& mesh, const std::vector<std::uint32_t>& twins) {
  const auto num_triangles = static_cast<std::uint32_t>(mesh.triangles.size());
  Orientation result{std::vector<std::uint32_t>(num_triangles, kNone), std::vector<bool>(num_triangles)};
  std::vector<std::uint32_t> pending;
  for (std::uint32_t seed = 0; seed < num_triangles; ++seed) {
    if (result.component_of[seed] != kNone) continue;
    result.component_of[seed] = result.num_components;
    pending.push_back(seed);
    while (!pending.empty()) {
      const std::uint32_t t = pending.back();
      pending.pop_back();
      for (std::uint32_t h = 3 * t; h < 3 * t + 3; ++h) {
        const std::uint32_t neighbour = twins[h] / 3;
        const bool runs_alike = isAscending(mesh, h) == isAscending(mesh, twins[h]);
        const bool flip = result.is_flipped[t] != runs_alike;
        if (result.component_of[neighbour] == kNone) {
          result.component_of[neighbour] = result.num_components;
          result.is_flipped[neighbour] = flip;
          pending.push_back(neighbour);
        } else if (result.is_flipped[neighbour] != flip) {
          return std::nullopt;
        }
      }
    }
    ++result.num_components;
  }
  return result;
}

// Six times the signed volume of each component. Tetrahedra start at a vertex of the component, which keeps them small.
std::vector<double> signedVolumes(const Mesh& mesh, const Orientation& orientation) {
  std::vector<double> volumes(orientation.num_components, 0);
  std::vector<std::uint32_t> apex(orientation.num_components, kNone);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const std::uint32_t component = orientation.component_of[t];
    if (apex[component] == kNone) apex[component] = mesh.triangles[t][0];
    const auto fromApex = [&](std::size_t corner) {
      const auto &p = mesh.vertices[mesh.triangles[t][corner]], &o = mesh.vertices[apex[component]];
      return subtract({p[0], p[1], p[2]}, {o[0], o[1], o[2]});
    };
    const double volume = dot(fromApex(0), cross(fromApex(1), fromApex(2)));
    volumes[component] += orientation.is_flipped[t] ? -volume : volume;
  }
  return volumes;
}

}  // namespace

std::optional<Mesh> outwardMesh(const Mesh& mesh) {
  Mesh outward = weld(mesh);
  const std::vector<std::uint32_t> twins = twinsOf(outward);
  if (twins.empty()) return std::nullopt;
  const std::optional<Orientation> orientation = orient(outward, twins);
  if (!orientation) return std::nullopt;
  const std::vector<double> volumes = signedVolumes(outward, *orientation);
  for (std::size_t t = 0; t < outward.triangles.size(); ++t) {
    auto& [a, b, c] = outward.triangles[t];
    if (orientation->is_flipped[t] != (volumes[orientation->component_of[t]] < 0)) std::swap(b, c);
  }
  const std::vector<bool> enclosed = enclosedComponents(outward, orientation->component_of, orientation->num_components);
  std::size_t kept = 0;
  for (std::size_t t = 0; t < outward.triangles.size(); ++t) {
    if (!enclosed[orientation->component_of[t]]) outward.triangles[kept++] = outward.triangles[t];
  }
  outward.triangles.resize(kept);
  return outward;
}

}  // namespace taxelsim
