// Two points that represent the covered part of a cell, with VARIATION. They have the mean and the variance of its depth and its polar moment of area. Pressures
// that are not proportional to the depth are summed over both, and each has its own friction: in a cell on the edge of a contact the shallow part slips first.
//
//      deeper ->          The covered part is modelled as a strip on the deeper side of the cell. The mean pressure is exact for exponent 2, and for exponent 3
//   +----+-------+        where depths are distributed evenly, as under a paraboloid; for 1.5 it is 0.3 % low on its edge.
//   |    | o   o |
//   +----+-------+        Twin: src/reference/cell_points.cpp.

const uint kCellPoints = VARIATION ? 2u : 1u;  // of a sample

struct CellPoints {
  float weight[2];      // of the covered part; their sum is 1
  float depth[2];       // m
  vec2 from_middle[2];  // m, in P
};

// `mean`: depth of the covered part, m. `share`: of the cell, covered. `variation`: variationOf(), depth/area/cell_depths.glsl.
CellPoints cellPoints(Tile tile, float mean, float share, uint variation) {
  vec2 deeper = unpackHalf2x16(variation);
  float ratio = length(deeper);
  deeper = ratio > 0.0 ? deeper / ratio : vec2(1, 0);
  CellPoints points;
  float high = ratio > 1.0 ? 1.0 / (1.0 + ratio * ratio) : 0.5;  // depths below 0 have no pressure
  points.weight = float[2](1.0 - high, high);
  points.depth = float[2](mean * max(1.0 - ratio, 0.0), mean * (ratio > 1.0 ? 1.0 + ratio * ratio : 1.0 + ratio));
  float along = length(deeper * tile.spacing), across = length(deeper.yx * tile.spacing);
  float reach = sqrt((share * share * along * along + across * across) * (1.0 / 12.0)), middle = 0.5 * (1.0 - share) * along;
  points.from_middle = vec2[2](deeper * (middle - reach * sqrt(high / (1.0 - high))), deeper * (middle + reach * sqrt((1.0 - high) / high)));
  return points;
}

// Pressure, mean over the cell (Pa), of one of the points, whose depth grows by `rate` (m/s).
float pressureAt(CellPoints points, uint k, float share, float rate) { return share * points.weight[k] * lawPressure(points.depth[k], rate); }

// Pressure, mean over the cell (Pa); the mean depth of the cell grows by `rate`.
float cellPressure(CellPoints points, float share, float rate) {
  float part_rate = rate / share;
  return pressureAt(points, 0, share, part_rate) + pressureAt(points, 1, share, part_rate);
}
