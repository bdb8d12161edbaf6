// How the covered parts of cells, and with them the compliances of their nodes, change under a rigid motion of the objects. Reference:
// src/reference/layer_cell_rates.cpp, with the derivation.
//
//   A ds/dt = -sum over the sides of int u n dl,    A d(s c)/dt = s A u - sum over the sides of int r u n dl
//
// over the covered part of the sides of a cell: in a cell that an edge cuts, the part behind the straight line with the covered share s on
// one side, across the direction to the centroid c. Two cells give the side between them the mean of their intervals, unless one of the
// cells is whole or empty.

struct CellRate {
  float covered;  // per unit of the motion
  vec2 center;    // velocity of the centroid, m per unit
};

const uint kCoveredRate = kLayerTarget, kCentroidRateX = kLayerDirection,
           kCentroidRateY = kLayerProduct;  // arrays of the rates of the window's cells

// 0 outside the window.
CellRate storedRate(Window window, uvec2 node) {
  if (!isInWindow(window, node)) return CellRate(0.0, vec2(0));
  uint start = window.layer_start;
  return CellRate(valueAt(start, kCoveredRate, node), vec2(valueAt(start, kCentroidRateX, node), valueAt(start, kCentroidRateY, node)));
}

struct CellLine {
  bool is_cut;
  float whole;  // share of every side that is covered, of a cell that is not cut
  vec2 normal;  // its components add up to 1
  float offset;
};

CellLine lineAt(Surface surface, uvec2 node) {
  if (!isReached(surface, node)) return CellLine(false, 0.0, vec2(1, 0), 0.0);
  NodeCell cell = cellAt(surface, node);
  vec2 center = cell.center / nodeSpacing();
  float size = abs(center.x) + abs(center.y);
  if (cell.covered == 0.0 || cell.edge == 0.0 || size == 0.0) return CellLine(false, cell.covered > 0.0 ? 1.0 : 0.0, vec2(1, 0), 0.0);
  vec2 normal = -center / size;
  return CellLine(true, 0.0, normal, lineOffset(cell.covered, normal));
}

vec2 sidePoint(uint side, float along) {
  float across = (side & 1u) == 0 ? -0.5 : 0.5;
  return side < 2 ? vec2(across, along) : vec2(along, across);
}

// Length, and moment about the middle, of the covered part of a cell's side at x = -0.5, x = 0.5, y = -0.5 or y = 0.5.
vec2 coveredOf(CellLine line, uint side) {
  if (!line.is_cut) return vec2(line.whole, 0);
  vec2 ends =
      line.offset - vec2(dot(line.normal, sidePoint(side, -0.5)), dot(line.normal, sidePoint(side, 0.5)));  // how far behind the line
  bvec2 behind = greaterThanEqual(ends, vec2(0));
  if (behind.x == behind.y) return vec2(behind.x ? 1.0 : 0.0, 0);
  float crossing = ends.x / (ends.x - ends.y) - 0.5, moment = 0.5 * (crossing * crossing - 0.25);
  return behind.x ? vec2(0.5 + crossing, moment) : vec2(0.5 - crossing, -moment);
}

// Covered part of the side between a cell and the next one, as coveredOf(). Outside of the grid the next one is like the cell.
vec2 sharedSide(Surface surface, CellLine own, uvec2 next_node, uint side) {
  vec2 part = coveredOf(own, side);
  if (any(greaterThanEqual(next_node, uvec2(NODE_ROWS, NODE_COLS)))) return part;  // -1 wraps to a large number
  CellLine next = lineAt(surface, next_node);
  return next.is_cut ? 0.5 * (part + coveredOf(next, side ^ 1u)) : vec2(next.whole, 0);
}

// Rate of a cell under the motion v, w of the objects, in P; `depth`: of the covered part, m.
CellRate cellRate(Surface surface, uvec2 node, float depth, vec3 v, vec3 w) {
  NodeCell cell = cellAt(surface, node);
  CellLine own = lineAt(surface, node);
  CellRate rate = CellRate(0.0, vec2(0));
  if (!own.is_cut) return rate;
  vec2 spacing = nodeSpacing(), center = cell.center / (cell.edge * spacing), at = nodePosition(node);
  vec2 moment = cell.covered * (v + cross(w, vec3(at + center * spacing, -depth))).xy / spacing;
  for (uint side = 0; side < 4; ++side) {
    int to = (side & 1u) == 0 ? -1 : 1;
    vec2 part = sharedSide(surface, own, uvec2(ivec2(node) + (side < 2 ? ivec2(to, 0) : ivec2(0, to))), side);
    vec2 middle = sidePoint(side, part.x > 0.0 ? part.y / part.x : 0.0);
    vec3 u = v + cross(w, vec3(at + middle * spacing, -depth));
    float flow = float(to) * (side < 2 ? u.x / spacing.x : u.y / spacing.y) * part.x;
    rate.covered -= flow;
    moment -= flow * middle;
  }
  rate.center = (moment - rate.covered * center) / cell.covered * spacing;
  return rate;
}

// Derivatives of mutualCompliance() by r, 1/m^2, and by `shares`, 1/m.
vec2 mutualSlopes(float r, float shares) {
  const float kCloud = 8.0 / (kPi * kPi * kPi * kPi);
  float w2 = kCloud * shares * nodeArea(), w = sqrt(w2), x = r / w, bell = 2.0 / sqrt(kPi) * exp(-x * x);
  float image = inversesqrt(r * r + IMAGE_DEPTH * IMAGE_DEPTH);
  float by_r = x > 1e-2 ? (bell / w - errorFunction(x) / r) / r : 0.0;
  return vec2(by_r + (IMAGE_DEPTH > 0.0 ? r * image * image * image : 0.0), -0.5 * bell / (w * shares));
}

// d ownCompliance / ds.
float ownSlope(float s) {
  float s2 = s * s, s4 = s2 * s2, s8 = s4 * s4;
  return (8.0 * s8 * (CELL_FREE - CELL_DISC) - 0.5 * mix(CELL_DISC, CELL_FREE, s8)) * inversesqrt(s) / s - CELL_BASE;
}

// Rate of the compliance of a node.
float complianceRate(Surface surface, Window window, uvec2 node) {
  NodeCell cell = cellAt(surface, node);
  if (cell.share == 0.0 || valueAt(window.layer_start, kLayerCompliance, node) <= kLeastCompliance - 1.0) return 0.0;
  CellRate rate = storedRate(window, node);
  float own = cell.edge * rate.covered, mutual = 0.0;
  for (uint k = 0; k < 9; ++k) {
    ivec2 step_to = ivec2(k / 3, k % 3) - 1;
    uvec2 at = uvec2(ivec2(node) + step_to);  // -1 wraps to a large number
    if (k == 4 || !isReached(surface, at)) continue;
    NodeCell other = cellAt(surface, at);
    if (other.share == 0.0 || cell.share >= 1.0 && other.share >= 1.0) continue;
    CellRate next = storedRate(window, at);
    vec2 nodes = vec2(step_to) * nodeSpacing(), between = nodes + other.center - cell.center;
    float r = length(between), shares = cell.share + other.share,
          difference = mutualCompliance(between, shares) - mutualCompliance(nodes, 2.0);
    vec2 slopes = mutualSlopes(r, shares), moved = other.edge * next.center - cell.edge * rate.center;
    float by_clouds = slopes.x * dot(between, moved) / max(r, 1e-9) + slopes.y * (own + other.edge * next.covered);
    mutual += sqrt(other.covered) * (by_clouds + 0.5 * difference * (next.covered / other.covered - own / cell.share));
  }
  return ownSlope(cell.share) * own + POINT_COMPLIANCE * mutual * inversesqrt(cell.share);
}
