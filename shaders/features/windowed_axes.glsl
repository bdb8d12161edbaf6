// Direction of an edge from the second moments of the forces under a Gaussian window, whose middle is moved to their centre a few times. Twin:
// src/reference/contact_features.cpp.

const uint kWindowIterations = 4u;
const float kMinWindowShare = 1e-3;  // of the force; two contacts far apart have no force between them

// Axes of second moments. `middle`: where the window starts, in C, m; `force`: of the part, N.
Axes windowedAxes(Part part, vec3 middle, float force) {
  vec3 second = vec3(0);
  bool is_empty = force <= 0.0;
  for (uint n = 0; n < kWindowIterations; ++n) {
    PartSums sums = sumPart(kSumsWindow, part, middle, 0.0);
    float weight = sums.s[2];
    is_empty = is_empty || weight < kMinWindowShare * force;
    if (is_empty) continue;
    vec2 first = vec2(sums.s[0], sums.s[1]);
    second = centralMoments(weight, first, vec3(sums.s[3], sums.s[4], sums.s[5]));
    middle.xy += first / weight;
  }
  if (is_empty) second = vec3(0);
  return axesOf(second);
}
