// Features of an instance that the image pass writes: moments of the measured and of the clean image, and what the contact pass has left of
// wrench, depth and load. Layout: shared/features.h. Reference: src/reference/features.cpp.

// A tile that nothing reached has the forces 0, one whose forces vanished -0. Compared as bits, since drivers leave out additions of 0.
float unsignedZero(float x) { return (floatBitsToUint(x) << 1) == 0 ? 0.0 : x; }

// Wrench (N, N m, in S), share of samples at full depth, offset (m) and success of the load search.
void writeContactResults(Instance instance, uint num_instances) {
  vec4 force = vec4(0), torque = vec4(0);
  for (uint t = 0; t < NUM_TILES; ++t) {
    force += tileResult(instance.number * NUM_TILES + t).force;
    torque += tileResult(instance.number * NUM_TILES + t).torque;
  }
  vec4 bracket = vec4(0, 0, 0, kLoadCarried);
  if ((instance.keys.w & kFlagLoadDriven) != 0) {
    bracket = loads[instance.number].bracket;
    bracket.x += loads[instance.number].forces.z;
  }
  uint wrench = kFeatureContactWrench * num_instances + 6 * instance.number;
  features[wrench] = unsignedZero(force.x);
  features[wrench + 1] = unsignedZero(force.y);
  features[wrench + 2] = unsignedZero(force.z);
  features[wrench + 3] = unsignedZero(torque.x);
  features[wrench + 4] = unsignedZero(torque.y);
  features[wrench + 5] = unsignedZero(torque.z);
  features[kFeatureOverPenetration * num_instances + instance.number] = force.w / float(NUM_TAXELS * SAMPLES * SAMPLES);
  features[kFeatureLoadOffset * num_instances + instance.number] = bracket.x;
  features[kFeatureLoadReached * num_instances + instance.number] = bracket.w == kLoadCarried ? 1.0 : 0.0;
}

// `start`: features before this image's block. `s`: the sums of features/image_sums.glsl.
void writeImageFeatures(uint start, Instance instance, uint num_instances, float s[kSumsPerImage]) {
  Moments moments = Moments(s[0], vec3(s[1], s[2], s[3]), vec3(s[4], s[5], s[6]), s[kPeak], s[7]);
  vec3 middle = vec3(0);
  if (kOnePatch) middle.xy = (vec2(instance.origin) - 0.5 * vec2(int(NUM_ROWS) - 1, int(NUM_COLS) - 1)) * vec2(PITCH_X, PITCH_Y);
  writeMoments(start, instance.number, num_instances, moments, middle, sensor.X_SC_row0, sensor.X_SC_row1, sensor.X_SC_row2);
}
