// Exact integrals over the part of a polygon that lies in a cell, the unit square, by Green's theorem: the area, and the moments about the
// corner of the cell, are sums over the directed edges of a counter-clockwise polygon in (u, v).
//
//   v ^    1 +----------+      Between the ends of an edge, clamped to the cell along u, the cell holds the trapezoid under the edge; where
//   the edge is
//     |      |    /|    |      above the cell, a whole column. Edges that go back along u subtract. The sums of both polygons on an edge
//     cancel. |      |  /  |    | |    0 +-----+----+ +------> u

struct EdgeSums {
  vec3 first;   // area, moments along u and v
  vec3 second;  // moments of uu, uv and vv; with VARIATION
};

// Rates dv/du and du/dv of the edge from p to q; finite.
vec2 ratesOf(vec2 p, vec2 q) {
  const float kLargest = 1e30;
  vec2 along = q - p;
  return vec2(along.x != 0.0 ? along.y / along.x : 0.0, along.y != 0.0 ? clamp(along.x / along.y, -kLargest, kLargest) : kLargest);
}

// Subtracts the part of the cell under the edge from p to q from the sums.
void addEdge(vec2 p, vec2 q, vec2 rates, inout EdgeSums sums) {
  float u0 = clamp(p.x, 0.0, 1.0), u1 = clamp(q.x, 0.0, 1.0);
  float v0 = p.y + (u0 - p.x) * rates.x, v1 = q.y + (u1 - q.x) * rates.x;
  float a = clamp(v0, 0.0, 1.0), b = clamp(v1, 0.0, 1.0);
  // Where the edge enters and leaves 0 <= v <= 1.
  float low = min(u0, u1), high = max(u0, u1);
  float ua = clamp(u0 + (a - v0) * rates.y, low, high), ub = clamp(u1 + (b - v1) * rates.y, low, high);
  float width = ub - ua;
  vec2 before = v0 > 1.0 ? vec2(ua - u0, 0.5 * (ua * ua - u0 * u0)) : vec2(0),
       after = v1 > 1.0 ? vec2(u1 - ub, 0.5 * (u1 * u1 - ub * ub)) : vec2(0);
  sums.first.x -= 0.5 * width * (a + b) + before.x + after.x;
  sums.first.y -= width * (ua * (2.0 * a + b) + ub * (a + 2.0 * b)) * (1.0 / 6.0) + before.y + after.y;
  sums.first.z -= width * (a * a + a * b + b * b) * (1.0 / 6.0) + 0.5 * (before.x + after.x);
  if (!VARIATION) return;
  float columns = (v0 > 1.0 ? ua * ua * ua - u0 * u0 * u0 : 0.0) + (v1 > 1.0 ? u1 * u1 * u1 - ub * ub * ub : 0.0);
  sums.second.x -=
      width * (ua * ua * (3.0 * a + b) + 2.0 * ua * ub * (a + b) + ub * ub * (a + 3.0 * b)) * (1.0 / 12.0) + columns * (1.0 / 3.0);
  sums.second.y -= width * (ua * (3.0 * a * a + 2.0 * a * b + b * b) + ub * (a * a + 2.0 * a * b + 3.0 * b * b)) * (1.0 / 24.0) +
                   0.5 * (before.y + after.y);
  sums.second.z -= width * (a + b) * (a * a + b * b) * (1.0 / 12.0) + (before.x + after.x) * (1.0 / 3.0);
}
