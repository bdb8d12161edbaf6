// Direction of an edge from the second moments of the forces under a Gaussian window, whose middle is moved to their centre a few times.
// Reference: src/reference/contact_features.cpp.

const uint kWindowIterations = 4u;
const float kMinWindowShare = 1e-3;  // share of the force; two contacts far apart have no force between them

struct ForceWindow {
  vec3 middle;    // in C, m
  vec3 second;    // central moments under the window before the last move, m^2
  bool is_empty;  // the window has lost the force: no direction
};

ForceWindow windowAt(vec3 middle, float force) { return ForceWindow(middle, vec3(0), force <= 0.0); }

// Moves the window to the centre of the forces under it. `sums`: of kSumsWindow about its middle; `force`: of the part, N.
void moveWindow(PartSums sums, float force, inout ForceWindow window) {
  float weight = sums.s[2];
  window.is_empty = window.is_empty || weight < kMinWindowShare * force;
  if (window.is_empty) return;
  vec2 first = vec2(sums.s[0], sums.s[1]);
  window.second = centralMoments(weight, first, vec3(sums.s[3], sums.s[4], sums.s[5]));
  window.middle.xy += first / weight;
}

Axes axesOf(ForceWindow window) { return axesOf(window.is_empty ? vec3(0) : window.second); }
