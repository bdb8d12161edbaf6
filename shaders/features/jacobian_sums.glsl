// Sums over the taxels of a part (features/jacobian_parts.glsl) or the tiles of its instance, in a fixed order. `middle`: the point of the
// moments, in C, m; `k`: a coordinate of the sensor's twist. Reference: src/reference/tactile_jacobian.cpp.
//
// The moments of a part are sums over its taxels t of a weight of t times the changes of the contact forces that spread to t. The kernel of
// a grid is applied to the weights rather than to the changes: one kernel serves six coordinates of the twist.

// Kind of sums over the taxels of a part.
const uint kSumsFirst = 0u;   // force, first moments (3)
const uint kSumsSecond = 1u;  // second moments (3) about a point
const uint kSumsWrench = 2u;  // derivatives of the wrench (6), over tiles

// Derivatives of force, first (3) and second (3) moments about a point by the coordinates of the twist.
struct Changes {
  PartSums by[6];
};

Changes noChanges() { return Changes(PartSums[6](noSums(), noSums(), noSums(), noSums(), noSums(), noSums())); }

void addSecond(float weight, vec3 p, uint first, inout PartSums sums) {
  sums.s[first] += weight * p.x * p.x;
  sums.s[first + 1] += weight * p.x * p.y;
  sums.s[first + 2] += weight * p.y * p.y;
}

void addFirst(float weight, vec3 p, inout PartSums sums) {
  sums.s[0] += weight;
  sums.s[1] += weight * p.x;
  sums.s[2] += weight * p.y;
  if (NUM_ROWS == 0) sums.s[3] += weight * p.z;  // 0 on a grid
}

void addTaxel(uint kind, Part part, uint t, vec3 middle, inout PartSums sums) {
  float reading = readingOf(part, t).x;
  vec3 p = positionOf(part, t) - middle;
  if (kind == kSumsSecond) {
    addSecond(reading, p, 0, sums);
  } else {
    addFirst(reading, p, sums);
  }
}

void addTile(Part part, uint tile, uint k, inout PartSums sums) {
  uint first = (part.instance * NUM_TILES + tile) * kNumWrenchJacobian + k;
  for (uint c = 0; c < 6; ++c) sums.s[c] += wrench_jacobian[first + 6 * c];
}

// Adds `weight` times the derivatives by the spread force of taxel t, which is at `p` from the point of the moments.
void addMoments(Part part, uint t, float weight, vec3 p, inout PartSums moments) {
  if (!CLEAN) weight *= readingOf(part, t).y;
  addFirst(weight, p, moments);
  addSecond(weight, p, 4, moments);
}

// Adds those by the force of the taxel at an offset of rows and columns from taxel t, which is `at`; with the weight 0 where there is none.
// No branch (driver/README.md).
void addReceiver(Part part, uint t, ivec2 at, int a, int b, vec3 middle, inout PartSums moments) {
  ivec2 receiver = at + ivec2(a, b);
  bool exists = all(lessThan(uvec2(receiver), uvec2(NUM_ROWS, NUM_COLS)));  // wraps to large numbers outside
  uint number = exists ? uint(receiver.x) * NUM_COLS + uint(receiver.y) : t;
  addMoments(part, number, exists ? kernelAt(a, b) : 0.0, positionInGrid(part, vec2(receiver)) - middle, moments);
}

// Derivatives of the sums by the contact force of taxel t; of a sensor that is not a grid, by its spread force.
PartSums momentsBy(Part part, uint t, vec3 middle) {
  PartSums moments = noSums();
  if (NUM_ROWS == 0) {
    addMoments(part, t, 1.0, positionOf(part, t) - middle, moments);
    return moments;
  }
  ivec2 at = ivec2(cellNumbered(t, NUM_COLS));
  if (KERNEL == 3) {
    [[unroll]] for (int n = 0; n < 9; ++n) addReceiver(part, t, at, n / 3 - 1, n % 3 - 1, middle, moments);
    return moments;
  }
  const int kRadius = int(KERNEL) / 2;
  for (int a = -kRadius; a <= kRadius; ++a) {
    for (int b = -kRadius; b <= kRadius; ++b) addReceiver(part, t, at, a, b, middle, moments);
  }
  return moments;
}

void addChanges(Part part, uint t, vec3 middle, inout Changes changes) {
  PartSums moments = momentsBy(part, t, middle);
  for (uint k = 0; k < 6; ++k) {
    float change =
        NUM_ROWS == 0 ? spreadChange(part.instance, t, k) : floatOfFours(TaxelJacobian, (part.instance * 6 + k) * NUM_TAXELS + t);
    for (uint s = 0; s < kMostSums; ++s) {
      if (NUM_ROWS == 0 || s != 3) changes.by[k].s[s] += change * moments.s[s];
    }
  }
}

// Sums of one kind over all taxels of the part, or all tiles of the instance.
PartSums sumPart(uint kind, Part part, vec3 middle, uint k) {
  uint first = kind == kSumsWrench ? 0 : part.first, end = kind == kSumsWrench ? NUM_TILES : part.end;
  PartSums total = noSums();
  for (uint v = gl_LocalInvocationIndex % TEAM; v < LANES; v += TEAM) {
    PartSums sums = noSums();
    uint t = first + v;
    for (; t < end; t += LANES) {
      if (kind == kSumsWrench) {
        addTile(part, t, k, sums);
      } else {
        addTaxel(kind, part, t, middle, sums);
      }
    }
    checkLoop(t < end);
    addTeam(sums, v, total);
  }
  return total;
}

Changes sumChanges(Part part, vec3 middle) {
  Changes total = noChanges();
  for (uint v = gl_LocalInvocationIndex % TEAM; v < LANES; v += TEAM) {
    Changes changes = noChanges();
    uint t = part.first + v;
    for (; t < part.end; t += LANES) addChanges(part, t, middle, changes);
    checkLoop(t < part.end);
    for (uint k = 0; k < 6; ++k) addTeam(changes.by[k], v, total.by[k]);
  }
  return total;
}

// ---- derivatives of total force, centre of pressure and edge angle from those of the moments ----

// Derivatives of the features of a row by one coordinate of the twist, per m or rad.
struct Change {
  float force, angle;
  vec3 center;  // in C
};

Change noChange() { return Change(0.0, 0.0, vec3(0)); }

// From the derivatives of force and of moments about the centre of pressure: mean and second moments are quotients, the angle is 1/2
// atan2(2 xy, xx - yy). `force`: N; `second`: central second moments, m^2.
Change changeOf(PartSums sums, float force, vec3 second, Axes axes) {
  Change change = Change(sums.s[0], 0.0, vec3(sums.s[1], sums.s[2], sums.s[3]) / force);
  vec3 moments = (vec3(sums.s[4], sums.s[5], sums.s[6]) - second * sums.s[0]) / force;
  float difference = axes.large - axes.small;
  if (axes.confidence > 0.0) {
    change.angle = ((second.x - second.z) / difference * moments.y - second.y / difference * (moments.x - moments.z)) / difference;
  }
  return change;
}

void writeChange(uint row, uint num_rows, uint k, PlaneRecord plane, Change change) {
  uint center = kJacobianCenterOfPressure * num_rows + 18 * row + k;
  features[center] = dot(plane.X_SC_row0.xyz, change.center);
  features[center + 6] = dot(plane.X_SC_row1.xyz, change.center);
  features[center + 12] = dot(plane.X_SC_row2.xyz, change.center);
  features[kJacobianTotalForce * num_rows + 6 * row + k] = change.force;
  features[kJacobianEdgeAngle * num_rows + 6 * row + k] = change.angle;
}
