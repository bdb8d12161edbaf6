// Links that the outline of an object cuts, with area sampling: where between two nodes the surface leaves the object.
//
// In the cell of a node the outline is the straight line with the covered share on one side, across the direction to the centroid of what is covered (as in
// the volume-of-fluid method; W. J. Rider and D. B. Kothe, J. Comput. Phys. 141 (1998) 112). The node is under the object if the line leaves the middle of the
// cell on the covered side. What the two cells of a link have covered of it adds up to the covered share s of the link, where the surface follows the object;
// it falls over the rest, so that the link counts with c = 1 / (1 - s). Where the outline passes a node, s is 0 on one of its sides and 1 on the other: the
// force is continuous in the pose.
//
//        |#########/ . . . |         arms: covered parts of the four half links of a node, in spacings
//     ---|----o###/---o----|---
//        |#######/ .arm = 0|
//
// Where no edge cuts a cell its middle decides, as with points. A smooth surface ends its contact between two nodes, on average a square of h^2 / 12 away from
// the nearer one, h the spacing; there it has bent away from its tangent, so that the node meets it too high. With the curvatures along x and y the difference
// is (xx + yy) h^2 / 48 on average, half of the difference between the middle of a cell and its mean, by which nodes meet a convex surface deeper. Twin: src/reference/foundation_cells.cpp.

const float kBetweenNodes = 0.5;
const float kNearlyWhole = 20.0;  // times the share that is not covered, below 1, is how little a mean says of the middle of a cell
const float kLeastFree = 1.0 / 500.0;  // of 1 / c
const float kLeastBetweenFree = 1.0 / 8.0;  // where the object is over neither node: two stiff links in series would take many sweeps

// What a node meets in its cell.
struct CutCell {
  float height;   // m: of what the object covers of the cell
  bool is_under;  // the object is over the node
  vec4 arms;      // covered parts of the half links along -x, x, -y and y, in widths of half a link; of no use where the height is above the skin
};

// `height`: in the middle of the cell, m; kMiss without a surface.
CutCell cutCell(float height, CellPart part) {
  float edge = part.covered == 0.0 ? 0.0 : part.edge;
  bool is_over = height < kMiss;
  float share = mix(is_over ? 1.0 : 0.0, part.covered, edge), size = abs(part.center.x) + abs(part.center.y);
  vec2 normal = edge > 0.0 && size > 0.0 ? -part.center / size : vec2(1, 0);
  float offset = lineOffset(share, normal), mean = uintBitsToFloat(part.height);
  bool is_under = offset > 0.0;
  if (is_over) {
    float whole = clamp(1.0 - kNearlyWhole * (1.0 - part.covered), 0.0, 1.0);
    height = mix(height - kBetweenNodes * whole * max(mean - height, 0.0), mean, edge);
  } else if (edge > 0.0) {
    height = mean;
  }
  vec4 rise = vec4(-normal.x, normal.x, -normal.y, normal.y), crossing = 2.0 * abs(offset) / max(abs(rise), 1e-6);
  vec4 to_line = mix(vec4(1), min(crossing, 1.0), greaterThan(rise, vec4(0)));       // from under the object
  vec4 from_line = mix(vec4(0), max(1.0 - crossing, 0.0), lessThan(rise, vec4(0)));  // where the node is free
  return CutCell(height, is_under, is_under ? to_line : from_line);
}

// 1 / c of links between nodes with overlaps a and b, of which both cells cover `arms`. `slope`: difference of the overlaps over the length of the link. As with
// points a link is cut where the surface falls by more than a spacing beyond a node that overlaps.
vec4 freeShares(vec4 a, vec4 b, vec4 arms, vec4 slope) {
  bvec4 any = greaterThan(max(a, b), vec4(0)), both = greaterThan(min(a, b), vec4(0));
  vec4 free = max(1.0 - mix(arms, vec4(0.5), both), mix(vec4(kLeastBetweenFree), vec4(kLeastFree), any));
  vec4 steep = mix(vec4(1), clamp(slope - 1.0, 0.0, 1.0), any);
  return max(free / (free + steep * (1.0 - free)), kLeastFree);
}

// Over-relaxation of nodes whose springs and links add up to `diagonal`, and without cuts to `whole`, N/m. Less where a link is cut short: a free node that moves
// too far would lift the node under the object that it hardly differs from.
vec4 relaxationOf(vec4 diagonal, float whole) { return 1.0 + (OVER_RELAXATION - 1.0) * whole / max(diagonal, whole); }
