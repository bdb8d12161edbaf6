// The motion of an object between two poses: the operations of src/simulation/motions.cpp in the same order, hence the same bits.

const MotionRecord kNoMotion = MotionRecord(vec4(0), vec4(0), vec4(0), vec4(0, -1, 0, 0));

// to from^-1. Terms are paired so that they cancel exactly for an object at rest.
dvec4 rotationBetween(dvec4 from, dvec4 to) {
  double w = from.x, x = from.y, y = from.z, z = from.w, tw = to.x, tx = to.y, ty = to.z, tz = to.w;
  return dvec4(tw * w + tx * x + ty * y + tz * z, (tx * w - tw * x) + (tz * y - ty * z), (ty * w - tw * y) + (tx * z - tz * x),
               (tz * w - tw * z) + (ty * x - tx * y));
}

// Row of R - 1 and of the translation that belongs to it. A displacement is cut so that its product with the stiffness is a float.
vec4 motionRow(dvec3 row, double displacement, dvec3 position) {
  const double kMost = 1e6lf;  // m
  double t = displacement;
  for (uint j = 0; j < 3; ++j) t -= row[j] * position[j];
  return vec4(vec3(row), float(min(max(t, -kMost), kMost)));
}

MotionRecord motionRecord(Pose before, Pose now, bool is_known, uint slot) {
  MotionRecord record = MotionRecord(vec4(0), vec4(0), vec4(0), vec4(0, float(slot), 0, 0));
  if (!is_known) return record;
  dvec4 q = rotationBetween(before.rotation, now.rotation);
  double w = q.x, x = q.y, y = q.z, z = q.w;
  dvec3 p = now.position - before.position;
  record.row0 = motionRow(dvec3(-2.0lf * (y * y + z * z), 2.0lf * (x * y - w * z), 2.0lf * (x * z + w * y)), p.x, before.position);
  record.row1 = motionRow(dvec3(2.0lf * (x * y + w * z), -2.0lf * (x * x + z * z), 2.0lf * (y * z - w * x)), p.y, before.position);
  record.row2 = motionRow(dvec3(2.0lf * (x * z - w * y), 2.0lf * (y * z + w * x), -2.0lf * (x * x + y * y)), p.z, before.position);
  record.known.x = 1.0;
  return record;
}
