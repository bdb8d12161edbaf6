// Two points that represent the covered part of a cell, with VARIATION. They have the mean and the variance of its depth and its polar
// moment of area. Pressures that are not proportional to the depth are summed over both, and each has its own friction: in a cell on the
// edge of a contact the shallow part slips first.
//
//      deeper ->        The covered part is modelled as a strip on the deeper side of the cell. The points lie on a diagonal of the strip:
//      towards the deeper
//   +----+-------+      side as far apart as its depths, so that pressure acts where that of the strip does, and across that side as far as
//   its width is. Of |    |     o |      two points that differ in depth only one would slip too far from the middle of the cell and the
//   other too near. |    | o     | +----+-------+      The mean pressure is exact for exponent 2, and for exponent 3 where depths are
//   distributed evenly, as under a paraboloid; for 1.5 it is
//                       0.3 % low on its edge. Twin: src/reference/cell_points.cpp.

const uint kCellPoints = VARIATION ? 2u : 1u;  // of a sample

struct CellPoints {
  float weight[2];      // of the covered part; their sum is 1
  float depth[2];       // m
  vec2 from_middle[2];  // m, in P
};

// Part of what is covered that the deeper point has, at most; less where the shallower one would be above the skin. On evenly distributed
// depths from 0 to D, of which those up to t D slip, friction is the mean t - t^2/2 of the smaller of two tractions. With 0.6 the largest
// errors of two points, at t = 0.15, 0.4 and 0.74, are 7 to 8 %; with 0.5 friction is 11.8 % too large at t = 0.21, while an edge begins to
// slip. Other exponents need equal parts for their mean pressure.
float mostDeep() { return EXPONENT == 1.0 ? 0.6 : 0.5; }

// `mean`: depth of the covered part, m. `share`: of the cell, covered. `variation`: variationOf(), depth/area/cell_depths.glsl.
CellPoints cellPoints(Tile tile, float mean, float share, uint variation) {
  vec2 deeper = unpackHalf2x16(variation);
  float ratio = length(deeper);
  deeper = ratio > 0.0 ? deeper / ratio : vec2(1, 0);
  float deep = min(mostDeep(), 1.0 / (1.0 + ratio * ratio));
  // From the mean to each point, in standard deviations, of the depth and of places.
  float above = sqrt(deep / (1.0 - deep)), below = 1.0 / above;
  CellPoints points;
  points.weight = float[2](1.0 - deep, deep);
  points.depth = float[2](mean * max(1.0 - ratio * above, 0.0), mean * (1.0 + ratio * below));
  float along = length(deeper * tile.spacing), across = length(deeper.yx * tile.spacing);
  vec2 width = (share * along * deeper + across * vec2(-deeper.y, deeper.x)) * inversesqrt(12.0);  // standard deviations
  vec2 middle = 0.5 * (1.0 - share) * along * deeper;
  points.from_middle = vec2[2](middle - above * width, middle + below * width);
  return points;
}

// Pressure, mean over the cell (Pa), of one of the points, whose depth grows by `rate` (m/s).
float pressureAt(CellPoints points, uint k, float share, float rate) {
  return share * points.weight[k] * lawPressure(points.depth[k], rate);
}

// Pressure, mean over the cell (Pa); the mean depth of the cell grows by `rate`.
float cellPressure(CellPoints points, float share, float rate) {
  float part_rate = rate / share;
  return pressureAt(points, 0, share, part_rate) + pressureAt(points, 1, share, part_rate);
}
