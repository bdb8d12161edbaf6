// Initial shift and pressures of an elastic layer's solver (elastic_layer/solver.glsl): the pressures of the frame before where they still
// fit, else pressures in proportion to the overlap, on a half-space to what exceeds kBeyondContact.

const float kLeastShift = 1e-6;  // thicknesses past first touch that a load needs at least
// Share of the deepest overlap up to which nodes of a half-space are taken to be out of contact at first. Under a sphere contact ends at
// half of it, under a cylinder higher (Hertz); 0.4 takes the fewest iterations under ellipsoids and fewer than 0 under a cylinder.
const float kBeyondContact = 0.4;

// First guess of the shift (thicknesses) of an instance that is driven by load: the shift at which independent springs, as soft as
// kSoftness cells, carry the load. Newton's method from full depth.
float initialShift(Window window, Drive drive) {
  const float kSoftness = 4.0;
  const uint kNewtonIterations = 6;
  float shift = 1.0;
  for (uint iteration = 0; iteration < kNewtonIterations; ++iteration) {
    uint v = gl_LocalInvocationIndex;
    if (v < window.num_parts) do {
        vec2 sums = vec2(0);
        uint k = v;
        do {
          if (k < window.num_strips) {
            vec4 target = readStrip(window, kLayerTarget, stripAt(window, k));
            vec4 pressed = whereAbove(target, -shift);
            sums += vec2(sumOf(pressed * (target + shift)), sumOf(pressed));
          }
          k += LANES;
        } while (k - v < window.num_strips);
        checkLoop(k < window.num_strips);
        setPartial(v, vec4(sums, 0, 0));
        v += WORKGROUP;
      } while (WORKGROUP < LANES && v < window.num_parts);
    vec2 sums = sumOfPartials(window.num_parts).xy;
    shift = clamp(shift - (sums.x - kSoftness * drive.pressure_sum) / max(sums.y, 1.0), kLeastShift - drive.deepest, 1.0);
  }
  return shift;
}

// Work of the pressures `p` along the targets, without the nodes that cannot be touched.
float workOf(vec4 p, vec4 target) { return dot(p, max(target, -2.0 - REACH)); }

// Whether the pressures of the frame before fit the new targets. Clears those at nodes that cannot be touched.
bool previousPressuresFit(Window window, float shift, Drive drive) {
  uint v = gl_LocalInvocationIndex;
  if (v < window.num_parts) do {
      vec2 sums = vec2(0);
      uint k = v;
      do {
        if (k < window.num_strips) {
          uvec2 at = stripAt(window, k);
          vec4 target = readStrip(window, kLayerTarget, at);
          vec4 p = readStrip(window, kLayerPressure, at) * whereAbove(target, kNoTarget);
          writeStrip(window, kLayerPressure, at, p);
          sums += vec2(workOf(p, target), sumOf(p));
        }
        k += LANES;
      } while (k - v < window.num_strips);
      checkLoop(k < window.num_strips);
      setPartial(v, vec4(sums, 0, 0));
      v += WORKGROUP;
    } while (WORKGROUP < LANES && v < window.num_parts);
  vec2 work = sumOfPartials(window.num_parts).xy;
  const float kFitting = 0.25;  // mean overlap under the old pressures, as a share of the deepest node's
  return work.y > 0.0 && work.x + shift * work.y > kFitting * (drive.deepest + shift) * work.y;
}

// Computes the displacements (kLayerProduct) under the pressures; returns the sums over the window of pressure times target, pressure times
// displacement, and pressure.
vec4 displaceByPressures(Window window) {
  uint v = gl_LocalInvocationIndex;
  if (v < window.num_parts) do {
      vec4 sums = vec4(0);
      uint k = v;
      do {
        if (k < window.num_strips) {
          uvec2 at = stripAt(window, k);
          vec4 p = readStrip(window, kLayerPressure, at), displacement = displacementAt(window, at, kLayerPressure);
          writeStrip(window, kLayerProduct, at, displacement);
          sums += vec4(workOf(p, readStrip(window, kLayerTarget, at)), dot(p, displacement), sumOf(p), 0);
        }
        k += LANES;
      } while (k - v < window.num_strips);
      checkLoop(k < window.num_strips);
      setPartial(v, sums);
      v += WORKGROUP;
    } while (WORKGROUP < LANES && v < window.num_parts);
  return sumOfPartials(window.num_parts);
}

// Sets the pressures, the residual and `found` that the solver starts from, found.shift given. Pressures are scaled so that they carry the
// load, or, without a load, so that the quadratic energy along them is least.
void initializePressures(Window window, Drive drive, inout Solution found) {
  float shift = found.shift;
  bool warm = previousPressuresFit(window, shift, drive);
  float above = shift - (IMAGE_DEPTH == 0.0 ? kBeyondContact * (drive.deepest + shift) : 0.0);
  clearSources();
  uint v = gl_LocalInvocationIndex;
  if (v < window.num_parts) do {
      uint k = v;
      do {
        if (k < window.num_strips) {
          uvec2 at = stripAt(window, k);
          vec4 target = readStrip(window, kLayerTarget, at);
          vec4 p = readStrip(window, kLayerPressure, at);
          if (!warm) p = weighted(window, at, max(target + above, 0.0));
          writeStrip(window, kLayerPressure, at, p);
          writeStrip(window, kLayerDirection, at, vec4(0));
          if (largestOf(p) > 0.0) addSource(at);
        }
        k += LANES;
      } while (k - v < window.num_strips);
      checkLoop(k < window.num_strips);
      v += WORKGROUP;
    } while (WORKGROUP < LANES && v < window.num_parts);
  workgroupBarrierWithBuffers();
  vec4 sums = displaceByPressures(window);
  float factor = LOADS && drive.by_load ? drive.pressure_sum / max(sums.z, 1e-30) : max(sums.x, 0.0) / max(sums.y, 1e-30);
  v = gl_LocalInvocationIndex;
  if (v < window.num_parts) do {
      vec4 residuals = vec4(0);
      uint k = v;
      do {
        if (k < window.num_strips) {
          uvec2 at = stripAt(window, k);
          vec4 p = readStrip(window, kLayerPressure, at) * factor;
          vec4 residual = readStrip(window, kLayerProduct, at) * factor - readStrip(window, kLayerTarget, at);
          writeStrip(window, kLayerPressure, at, p);
          writeStrip(window, kLayerResidual, at, residual);
          residuals += residualSums(window, at, p, residual - shift);
        }
        k += LANES;
      } while (k - v < window.num_strips);
      checkLoop(k < window.num_strips);
      setPartial(v, residuals);
      v += WORKGROUP;
    } while (WORKGROUP < LANES && v < window.num_parts);
  updateSolution(window, drive, found);
}
