// Poses in double precision, and the record of an object's pose: the operations of src/base/pose_inline.h and src/simulation/near_slots.cpp
// in the same order, hence the same bits.
// In: objects.
#ifndef COMMON_POSE_RECORD_GLSL
#define COMMON_POSE_RECORD_GLSL
struct Pose {
  dvec3 position;
  dvec4 rotation;  // quaternion w, x, y, z
};

bool isFinite(double x) { return !(isnan(x) || isinf(x)); }
bool isFinite(dvec3 v) { return isFinite(v.x) && isFinite(v.y) && isFinite(v.z); }
bool isFinite(Pose X) { return isFinite(X.position) && isFinite(X.rotation.x) && isFinite(X.rotation.yzw); }

dvec4 normalized(dvec4 q) { return q / sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w); }

struct Rows {
  dvec3 row0, row1, row2;
};

Rows rotationMatrix(dvec4 q) {
  double w = q.x, x = q.y, y = q.z, z = q.w;
  return Rows(dvec3(1.0lf - 2.0lf * (y * y + z * z), 2.0lf * (x * y - w * z), 2.0lf * (x * z + w * y)),
              dvec3(2.0lf * (x * y + w * z), 1.0lf - 2.0lf * (x * x + z * z), 2.0lf * (y * z - w * x)),
              dvec3(2.0lf * (x * z - w * y), 2.0lf * (y * z + w * x), 1.0lf - 2.0lf * (x * x + y * y)));
}

const PoseRecord kNoPose = PoseRecord(vec4(0), vec4(0), vec4(0), vec4(-1, 0, 0, 0));

// Whether all of the object is behind the skin, where it presses on nothing.
bool isBehind(ObjectRecord object, PoseRecord X_SO, SkinBase base) {
  vec3 normal = base.normal_lowest.xyz;
  vec3 n_O = X_SO.row0.xyz * normal.x + X_SO.row1.xyz * normal.y + X_SO.row2.xyz * normal.z;
  vec3 p_SO = vec3(X_SO.row0.w, X_SO.row1.w, X_SO.row2.w), c = object.center.xyz, half_size = object.half_size.xyz;
  float center = base.origin.x + (normal.x * p_SO.x + normal.y * p_SO.y + normal.z * p_SO.z) + (n_O.x * c.x + n_O.y * c.y + n_O.z * c.z);
  return center + (abs(n_O.x) * half_size.x + abs(n_O.y) * half_size.y + abs(n_O.z) * half_size.z) < base.normal_lowest.w;
}

// The pose of the object in a slot.
PoseRecord poseRecord(uint object, uint slot, Pose X_SO) {
  Rows rotation = rotationMatrix(normalized(X_SO.rotation));
  return PoseRecord(vec4(vec3(rotation.row0), float(X_SO.position.x)), vec4(vec3(rotation.row1), float(X_SO.position.y)),
                    vec4(vec3(rotation.row2), float(X_SO.position.z)), vec4(float(object), float(slot), 0.0, 0.0));
}
#endif
