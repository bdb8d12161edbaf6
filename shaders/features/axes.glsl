// Principal axes of second moments (paper eq. 3, with the quadrant kept). Reference: src/reference/features.cpp.

const float kPi = 3.14159265358979;
// m^2; an image whose eigenvalues differ by less than (1 um)^2 has no direction.
const float kNoDirection = 1e-12;

// atan2 to 2e-7 rad, by a series, since Vulkan permits errors of 4096 units in the last place. 0 for (0, 0); pi, not -pi, for y = +-0, x <
// 0.
float angleOf(float y, float x) {
  float large = max(abs(x), abs(y));
  if (large == 0.0) return 0.0;
  float t = min(abs(x), abs(y)) / large;
  // One halving, atan t = 2 atan(t / (1 + sqrt(1 + t^2))), leaves at most 0.4142, where nine terms of the series suffice.
  float s = t / (1.0 + sqrt(1.0 + t * t));
  float q = s * s;
  float sum = 0.0;
  for (int n = 8; n >= 0; --n) sum = 1.0 / float(2 * n + 1) - q * sum;
  float angle = 2.0 * s * sum;
  if (abs(y) > abs(x)) angle = 0.5 * kPi - angle;
  if (x < 0.0) angle = kPi - angle;
  return y < 0.0 ? -angle : angle;
}

// Eigenvalues, larger first, and direction of the larger one; angle and confidence are 0 where the eigenvalues are equal (kNoDirection).
struct Axes {
  float large, small;
  float angle;       // rad in (-pi/2, pi/2]
  float confidence;  // 0 to 1
};

// `second`: xx, xy, yy, m^2.
Axes axesOf(vec3 second) {
  float middle = 0.5 * (second.x + second.z);
  float radius = length(vec2(0.5 * (second.x - second.z), second.y));
  Axes axes = Axes(middle + radius, max(middle - radius, 0.0), 0.0, 0.0);
  if (axes.large - axes.small > kNoDirection) {
    axes.angle = 0.5 * angleOf(2.0 * second.y, second.x - second.z);
    axes.confidence = (axes.large - axes.small) / (axes.large + axes.small);
  }
  return axes;
}
