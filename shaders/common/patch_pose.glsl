// Where a patch is on the sensor. In: patches (shared/model.h).

// Patch from sensor.
Affine patchPose(uint patch_number) {
  return Affine(patchRecord(patch_number).row0, patchRecord(patch_number).row1, patchRecord(patch_number).row2);
}

// A vector in P, and the origin of P, in S.
vec3 toSensor(Affine X_PS, vec3 v) { return X_PS.row0.xyz * v.x + X_PS.row1.xyz * v.y + X_PS.row2.xyz * v.z; }
vec3 originInSensor(Affine X_PS) { return -toSensor(X_PS, vec3(X_PS.row0.w, X_PS.row1.w, X_PS.row2.w)); }
