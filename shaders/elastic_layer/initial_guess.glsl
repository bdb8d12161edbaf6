// Initial shift and pressures of an elastic layer's solver (elastic_layer/solver.glsl): the pressures of the frame before where they still
// fit, else pressures in proportion to the overlap, on a half-space to what exceeds kBeyondContact.

const float kLeastShift = 1e-6;  // thicknesses past first touch that a load needs at least
// Share of the deepest overlap up to which nodes of a half-space are taken to be out of contact at first. Under a sphere contact ends at
// half of it, under a cylinder higher (Hertz); 0.4 takes the fewest iterations under ellipsoids and fewer than 0 under a cylinder.
const float kBeyondContact = 0.4;

// Sums over the nodes of a strip that independent springs press at a shift: displacement, number of nodes.
vec2 springSums(Window window, uvec2 at, float shift) {
  vec4 target = readStrip(window, kLayerTarget, at);
  vec4 pressed = whereAbove(target, -shift);
  return vec2(sumOf(pressed * (target + shift)), sumOf(pressed));
}

// First guess of the shift (thicknesses) of an instance that is driven by load: the shift at which independent springs, as soft as
// kSoftness cells, carry the load. Newton's method from full depth.
float initialShift(Window window, Drive drive) {
  const float kSoftness = 4.0;
  const uint kNewtonIterations = 6;
  float shift = 1.0;
  for (uint iteration = 0; iteration < kNewtonIterations; ++iteration) {
    REDUCE_STRIPS(window, vec4(0), sums.xy += springSums(window, at, shift))
    vec2 sums = sumOfPartials(window.num_parts).xy;
    shift = clamp(shift - (sums.x - kSoftness * drive.pressure_sum) / max(sums.y, 1.0), kLeastShift - drive.deepest, 1.0);
  }
  return shift;
}

// Work of the pressures `p` along the targets, without the nodes that cannot be touched.
float workOf(vec4 p, vec4 target) { return dot(p, max(target, -2.0 - REACH)); }

// Clears the pressures of a strip at nodes that cannot be touched. Returns the work and the sum of its pressures.
vec2 keepPressures(Window window, uvec2 at) {
  vec4 target = readStrip(window, kLayerTarget, at);
  vec4 p = readStrip(window, kLayerPressure, at) * whereAbove(target, kNoTarget);
  writeStrip(window, kLayerPressure, at, p);
  return vec2(workOf(p, target), sumOf(p));
}

// Whether the pressures of the frame before fit the new targets. Clears those at nodes that cannot be touched.
bool previousPressuresFit(Window window, float shift, Drive drive) {
  REDUCE_STRIPS(window, vec4(0), sums.xy += keepPressures(window, at))
  vec2 work = sumOfPartials(window.num_parts).xy;
  const float kFitting = 0.25;  // mean overlap under the old pressures, as a share of the deepest node's
  return work.y > 0.0 && work.x + shift * work.y > kFitting * (drive.deepest + shift) * work.y;
}

vec4 displaceByPressures(Window window, uvec2 at) {
  vec4 p = readStrip(window, kLayerPressure, at), displacement = displacementAt(window, at, kLayerPressure);
  writeStrip(window, kLayerProduct, at, displacement);
  return vec4(workOf(p, readStrip(window, kLayerTarget, at)), dot(p, displacement), sumOf(p), 0);
}

// Computes the displacements (kLayerProduct) under the pressures; returns the sums over the window of pressure times target, pressure times
// displacement, and pressure.
vec4 displaceByPressures(Window window) {
  REDUCE_STRIPS(window, vec4(0), sums += displaceByPressures(window, at))
  return sumOfPartials(window.num_parts);
}

// Sets the first pressures of a strip: those of the frame before if `warm`, else in proportion to target + above.
void guessPressures(Window window, uvec2 at, bool warm, float above) {
  vec4 target = readStrip(window, kLayerTarget, at);
  vec4 p = readStrip(window, kLayerPressure, at);
  if (!warm) p = weighted(window, at, max(target + above, 0.0));
  writeStrip(window, kLayerPressure, at, p);
  writeStrip(window, kLayerDirection, at, vec4(0));
  if (largestOf(p) > 0.0) addSource(at);
}

// Multiplies the pressures of a strip by `factor` and stores its residual. Returns its residualSums().
vec4 scalePressures(Window window, uvec2 at, float factor, float shift) {
  vec4 p = readStrip(window, kLayerPressure, at) * factor;
  vec4 residual = readStrip(window, kLayerProduct, at) * factor - readStrip(window, kLayerTarget, at);
  writeStrip(window, kLayerPressure, at, p);
  writeStrip(window, kLayerResidual, at, residual);
  return residualSums(window, at, p, residual - shift);
}

// Sets the pressures, the residual and `found` that the solver starts from, found.shift given. Pressures are scaled so that they carry the
// load, or, without a load, so that the quadratic energy along them is least.
void initializePressures(Window window, Drive drive, inout Solution found) {
  float shift = found.shift;
  bool warm = previousPressuresFit(window, shift, drive);
  float above = shift - (IMAGE_DEPTH == 0.0 ? kBeyondContact * (drive.deepest + shift) : 0.0);
  clearSources();
  FOR_EACH_STRIP(window, guessPressures(window, at, warm, above))
  workgroupBarrierWithBuffers();
  vec4 sums = displaceByPressures(window);
  float factor = LOADS && drive.by_load ? drive.pressure_sum / max(sums.z, 1e-30) : max(sums.x, 0.0) / max(sums.y, 1e-30);
  REDUCE_STRIPS(window, vec4(0), sums += scalePressures(window, at, factor, shift))
  updateSolution(window, drive, found);
}
