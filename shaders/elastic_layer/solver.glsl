// Conjugate gradients for the pressures of an elastic layer in contact: A p = d where p > 0, A p >= d where p = 0 (Polonsky and Keer, Wear
// 231 (1999) 206). The active set, the nodes in contact, changes in every step. Units are thicknesses: A has ones on its diagonal.
// Reference: src/reference/elastic_layer.cpp.
//
//   r = A p - target - shift   kLayerResidual holds A p - target
//   t                          kLayerDirection
//   q = A t                    kLayerProduct
//
// With area sampling A has compliances on its diagonal, which are larger where little of a cell is covered. Residuals are then divided by
// them: in directions, and as weights of the sums of r, r^2 and the number of nodes. All is as without where the compliance is 1.
//
// With a load the shift is an unknown: it takes up the mean of r over the nodes in contact, and pressures are scaled to the load after
// every step.

struct Solution {
  float shift;             // thicknesses
  float squared_residual;  // sum of r^2 over the nodes in contact
  float num_pressed;       // nodes in contact, weighted
  float error;  // root mean square over the nodes in contact of r there and of penetrations elsewhere; as a share of the deepest overlap
};

// How an instance is driven.
struct Drive {
  float deepest;  // target of the deepest node, thicknesses
  bool by_load;
  float pressure_sum;  // required by the load, if by_load
};

// Over the nodes of a strip in contact: r, its square, their number; squares of penetrations elsewhere.
vec4 residualSums(Window window, uvec2 at, vec4 p, vec4 residual) {
  vec4 pressed = whereAbove(p, 0.0);
  vec4 inside = residual * pressed;
  vec4 outside = min(residual, 0.0) * (1.0 - pressed);
  vec4 step_inside = weighted(window, at, inside);
  return vec4(sumOf(step_inside), dot(inside, step_inside), sumOf(weighted(window, at, pressed)),
              dot(outside, weighted(window, at, outside)));
}

// Updates all of `found` from the partial sums of residualSums(): with a load the shift too.
void updateSolution(Window window, Drive drive, inout Solution found) {
  vec4 sums = sumOfPartials(window.num_parts);
  float number = max(sums.z, 1.0);
  float mean = LOADS && drive.by_load ? sums.x / number : 0.0;
  found.num_pressed = sums.z;
  found.error = sqrt((sums.y + sums.w) / number) / max(drive.deepest + found.shift, 1e-30);
  found.squared_residual = max(sums.y - mean * sums.x, 0.0);
  found.shift += mean;
}

// Updates the residual of a strip by the displacement of kLayerProduct. Returns its residualSums().
vec4 updateResidual(Window window, uvec2 at, float factor, float shift) {
  vec4 p = readStrip(window, kLayerPressure, at);
  vec4 residual = readStrip(window, kLayerResidual, at) + displacementAt(window, at, kLayerProduct);
  if (LOADS) {
    vec4 target = readStrip(window, kLayerTarget, at);
    p *= factor;
    // Unchanged for a factor of 1: an instance that is driven by its pose must not depend on others of the batch that are driven by load.
    if (factor != 1.0) residual = (residual + target) * factor - target;
    writeStrip(window, kLayerPressure, at, p);
  }
  writeStrip(window, kLayerResidual, at, residual);
  return residualSums(window, at, p, residual - shift);
}

// Updates the residual by the displacements of kLayerProduct over the sources. With a load, multiplies pressures and displacements by
// `factor` and updates the shift. Updates all of `found`.
void updateResidual(Window window, Drive drive, float factor, inout Solution found) {
  REDUCE_STRIPS(window, vec4(0), sums += updateResidual(window, at, factor, found.shift))
  updateSolution(window, drive, found);
}

// Updates the search direction of a strip. Returns the sum of r times t.
float updateDirection(Window window, uvec2 at, float shift, float beta) {
  vec4 pressed = whereAbove(readStrip(window, kLayerPressure, at), 0.0);
  if (sumOf(pressed) > 0.0) addSource(at);
  vec4 residual = pressed * (readStrip(window, kLayerResidual, at) - shift);
  vec4 t = weighted(window, at, residual) + pressed * readStrip(window, kLayerDirection, at) * beta;
  writeStrip(window, kLayerDirection, at, t);
  return dot(residual, t);
}

// Search direction t = r + beta t over the nodes in contact, which become the sources. Leaves the sum of r times t in the x component of
// the partial sums.
void updateDirection(Window window, float shift, float beta) {
  REDUCE_STRIPS(window, vec4(0), sums.x += updateDirection(window, at, shift, beta))
}

// Applies A to the direction of a strip: q = A t. Adds q times t to sums.y, and for a load, over the nodes in contact, q and t to sums.zw.
void applyToDirection(Window window, uvec2 at, bool by_load, inout vec4 sums) {
  vec4 q = displacementAt(window, at, kLayerDirection);
  writeStrip(window, kLayerProduct, at, q);
  vec4 t = readStrip(window, kLayerDirection, at);
  sums.y += dot(q, t);
  if (LOADS && by_load) {
    sums.z += sumOf(weighted(window, at, q * whereAbove(readStrip(window, kLayerPressure, at), 0.0)));
    sums.w += sumOf(t);
  }
}

// Applies A to the direction over the window. Returns the step length (r t) / (t q), from the sums that updateDirection() left.
float applyToDirection(Window window, Drive drive, float num_pressed) {
  REDUCE_STRIPS(window, vec4(partialAt(part).x, 0, 0, 0), applyToDirection(window, at, drive.by_load, sums))
  vec4 sums = sumOfPartials(window.num_parts);
  // With a free shift, the mean of q does not count.
  float curvature = LOADS && drive.by_load ? sums.y - sums.z * sums.w / max(num_pressed, 1.0) : sums.y;
  return curvature > 0.0 ? max(sums.x / curvature, 0.0) : 0.0;
}

// Takes the step of a strip. Returns the sum of its pressures, and the sum of residuals of the nodes that it presses.
vec2 takeStep(Window window, uvec2 at, float shift, float step_length, float press) {
  vec4 unshifted = readStrip(window, kLayerResidual, at), residual = unshifted - shift;
  vec4 plain = readStrip(window, kLayerPressure, at) - readStrip(window, kLayerDirection, at) * step_length;
  vec4 entering = (1.0 - whereAbove(plain, 0.0)) * max(-residual, 0.0);
  entering = weighted(window, at, entering);
  vec4 p = max(plain, 0.0) + press * entering;
  vec4 change = p - plain;
  if (largestOf(change) > 0.0) addSource(at);
  writeStrip(window, kLayerPressure, at, p);
  writeStrip(window, kLayerResidual, at, unshifted - readStrip(window, kLayerProduct, at) * step_length);
  writeStrip(window, kLayerProduct, at, change);
  return vec2(sumOf(p), sumOf(entering));
}

// Takes the step p - step_length t, releases nodes that it would pull, and presses nodes that are penetrated. Leaves in kLayerProduct the
// difference of the pressures from the plain step; the strips where it is positive become sources. Returns the sum of pressures, and a
// positive number if a node was pressed.
vec2 takeStep(Window window, float shift, float step_length) {
  // The first node in contact has no step length; its own compliance, 1, is the scale.
  float press = step_length > 0.0 ? step_length : 1.0;
  REDUCE_STRIPS(window, vec4(0), sums.xy += takeStep(window, at, shift, step_length, press))
  return sumOfPartials(window.num_parts).xy;
}

// Iterates from the pressures and `found` of initializePressures() until the error is at most TOLERANCE; returns the number of iterations.
// A load that even full depth does not carry ends as full depth, with drive.by_load false.
uint solve(Window window, inout Solution found, inout Drive drive) {
  uint iteration = 0, end = ITERATIONS;
  float factor = 1.0;
  float before = 0.0;  // squared residual before the step; 0 restarts the directions
  bool ended = false;
  while (true) {
    if (iteration >= end || found.error <= TOLERANCE) {
      if (!LOADS || !drive.by_load || found.shift <= 1.0) {
        ended = true;
        break;
      }
      drive.by_load = false;
      found.shift = 1.0;
      end = iteration + ITERATIONS;
      before = 0.0;
      clearSources();
    } else {
      ++iteration;
      float beta = before > 0.0 ? found.squared_residual / before : 0.0;
      before = found.squared_residual;
      clearSources();
      updateDirection(window, found.shift, beta);
      workgroupBarrierWithBuffers();
      float step_length = applyToDirection(window, drive, found.num_pressed);
      clearSources();
      vec2 sums = takeStep(window, found.shift, step_length);
      if (LOADS && drive.by_load && sums.x > 0.0) factor = drive.pressure_sum / sums.x;
      if (sums.y > 0.0) before = 0.0;
    }
    updateResidual(window, drive, factor, found);
    factor = 1.0;
  }
  checkLoop(!ended);
  return iteration;
}
