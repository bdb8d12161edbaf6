// Derivatives of total force, centre of pressure and edge angle from those of the moments. Layout: shared/features.h. Reference:
// src/reference/tactile_jacobian.cpp.

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
