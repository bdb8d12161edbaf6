// The record of an object's pose for the next frame: the operations of src/simulation/near_slots.cpp. In: objects, servo_loop.

// Whether all of the object is behind the skin, where it presses on nothing.
bool isBehind(ObjectRecord object, PoseRecord X_SO) {
  vec3 normal = servo_loop.behind.xyz;
  vec3 n_O = X_SO.row0.xyz * normal.x + X_SO.row1.xyz * normal.y + X_SO.row2.xyz * normal.z;
  vec3 p_SO = vec3(X_SO.row0.w, X_SO.row1.w, X_SO.row2.w), c = object.center.xyz, half_size = object.half_size.xyz;
  float center =
      servo_loop.origin.x + (normal.x * p_SO.x + normal.y * p_SO.y + normal.z * p_SO.z) + (n_O.x * c.x + n_O.y * c.y + n_O.z * c.z);
  return center + (abs(n_O.x) * half_size.x + abs(n_O.y) * half_size.y + abs(n_O.z) * half_size.z) < servo_loop.behind.w;
}

PoseRecord poseRecord(uint object, Pose X_SO) {
  Rows rotation = rotationMatrix(normalized(X_SO.rotation));
  PoseRecord record;
  record.row0 = vec4(vec3(rotation.row0), float(X_SO.position.x));
  record.row1 = vec4(vec3(rotation.row1), float(X_SO.position.y));
  record.row2 = vec4(vec3(rotation.row2), float(X_SO.position.z));
  record.object = vec4(float(object), 0.0, 0.0, 0.0);
  if (isBehind(objects[object], record)) record = PoseRecord(vec4(0), vec4(0), vec4(0), vec4(-1, 0, 0, 0));
  return record;
}
