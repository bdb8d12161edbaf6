// The conjugate gradients of an elastic layer. Included by elastic_layer.comp, whose names it uses, after layer_strips.glsl. Twin:
// src/reference/elastic_layer.cpp.

// What all invocations know of it.
struct Solution {
  float shift;        // thicknesses
  float squares;      // of the excess w - d over the nodes in contact
  float num_pressed;  // nodes in contact
  float residual;     // root of the mean square, over the nodes in contact, of the excess there and of penetrations elsewhere; in depths
};

// What is asked for.
struct Goal {
  float deepest;  // target of the deepest node
  bool by_load;
  float sum;      // of pressures, if by load
};

Strip scaled(Strip s, float factor) { return Strip(s.low * factor, s.high * factor); }
Strip sumOf(Strip a, Strip b) { return Strip(a.low + b.low, a.high + b.high); }
Strip productOf(Strip a, Strip b) { return Strip(a.low * b.low, a.high * b.high); }
Strip minus(Strip a, Strip b) { return Strip(a.low - b.low, a.high - b.high); }
Strip minus(Strip a, float b) { return Strip(a.low - b, a.high - b); }

// The excess goes on by the displacements of array kLayerProduct over the sources. In load-driven mode pressures and displacements are then multiplied by
// `factor`, and the shift follows. How far the solution is now.
void settle(inout Solution found, Goal goal, float factor) {
  for (uint v = gl_LocalInvocationIndex; v < num_parts; v += WORKGROUP) {
    vec4 sums = vec4(0);  // over the nodes in contact: excess, its square, their number; squares of penetrations elsewhere
    uint k = v;
    for (; k < num_strips; k += LANES) {
      uvec2 at = stripAt(k);
      Strip p = readStrip(kLayerPressure, at);
      Strip excess = sumOf(readStrip(kLayerResidual, at), displacementAt(at, kLayerProduct));
      if (LOADS) {
        Strip target = readStrip(kLayerTarget, at);
        p = scaled(p, factor);
        // As it is where the factor is 1: an instance that is driven by its pose must not feel that another is not.
        if (factor != 1.0) excess = minus(scaled(sumOf(excess, target), factor), target);
        writeStrip(kLayerPressure, at, p);
      }
      writeStrip(kLayerResidual, at, excess);
      excess = minus(excess, found.shift);
      Strip pressed = whereAbove(p, 0.0);
      Strip inside = productOf(excess, pressed);
      Strip outside = Strip(min(excess.low, 0.0) * (1.0 - pressed.low), min(excess.high, 0.0) * (1.0 - pressed.high));
      sums += vec4(sumOf(inside), dotOf(inside, inside), sumOf(pressed), dotOf(outside, outside));
    }
    cut_short = cut_short || k < num_strips;
    partial[v] = sums;
  }
  vec4 sums = sumOfPartials(num_parts);
  float number = max(sums.z, 1.0);
  float mean = LOADS && goal.by_load ? sums.x / number : 0.0;
  found.num_pressed = sums.z;
  found.residual = sqrt((sums.y + sums.w) / number) / max(goal.deepest + found.shift, 1e-30);
  found.squares = max(sums.y - mean * sums.x, 0.0);
  found.shift += mean;
}

// The direction t of the next step: the excess over the nodes in contact, conjugate to the step before by `share` of its direction. Leaves the sum of excess
// times direction in partial[].x; the nodes in contact are the sources.
void direct(Solution found, float share) {
  for (uint v = gl_LocalInvocationIndex; v < num_parts; v += WORKGROUP) {
    float along = 0.0;
    uint k = v;
    for (; k < num_strips; k += LANES) {
      uvec2 at = stripAt(k);
      Strip pressed = whereAbove(readStrip(kLayerPressure, at), 0.0);
      if (sumOf(pressed) > 0.0) addSource(at);
      Strip excess = productOf(pressed, minus(readStrip(kLayerResidual, at), found.shift));
      Strip t = sumOf(excess, productOf(pressed, scaled(readStrip(kLayerDirection, at), share)));
      writeStrip(kLayerDirection, at, t);
      along += dotOf(excess, t);
    }
    cut_short = cut_short || k < num_strips;
    partial[v] = vec4(along, 0, 0, 0);
  }
}

// q = A t over the window; returns the length of the step.
float answer(Solution found, Goal goal) {
  for (uint v = gl_LocalInvocationIndex; v < num_parts; v += WORKGROUP) {
    vec4 sums = vec4(partial[v].x, 0, 0, 0);  // excess times t; then over the nodes in contact q times t, q, t
    uint k = v;
    for (; k < num_strips; k += LANES) {
      uvec2 at = stripAt(k);
      Strip q = displacementAt(at, kLayerDirection);
      writeStrip(kLayerProduct, at, q);
      Strip t = readStrip(kLayerDirection, at);
      sums.y += dotOf(q, t);
      if (LOADS && goal.by_load) {
        sums.z += sumOf(productOf(q, whereAbove(readStrip(kLayerPressure, at), 0.0)));
        sums.w += sumOf(t);
      }
    }
    cut_short = cut_short || k < num_strips;
    partial[v] = sums;
  }
  vec4 sums = sumOfPartials(num_parts);
  // Where the shift is free, only what q has beside its mean counts.
  float curvature = LOADS && goal.by_load ? sums.y - sums.z * sums.w / max(found.num_pressed, 1.0) : sums.y;
  return curvature > 0.0 ? max(sums.x / curvature, 0.0) : 0.0;
}

// Goes the step, lets go of nodes that it would pull, presses those that are penetrated. Leaves in kLayerProduct by how much the pressures differ from the
// plain step, where they do are the sources; returns the sum of pressures, and whether a node was pressed.
vec2 advance(Solution found, float step_length) {
  // The first node has no step to go by; its own compliance, 1, is the scale.
  float press = step_length > 0.0 ? step_length : 1.0;
  for (uint v = gl_LocalInvocationIndex; v < num_parts; v += WORKGROUP) {
    vec2 sums = vec2(0);
    uint k = v;
    for (; k < num_strips; k += LANES) {
      uvec2 at = stripAt(k);
      Strip unshifted = readStrip(kLayerResidual, at), excess = minus(unshifted, found.shift);
      Strip plain = minus(readStrip(kLayerPressure, at), scaled(readStrip(kLayerDirection, at), step_length));
      Strip entering = Strip((1.0 - vec4(greaterThan(plain.low, vec4(0)))) * max(-excess.low, 0.0),
                             (1.0 - vec4(greaterThan(plain.high, vec4(0)))) * max(-excess.high, 0.0));
      Strip p = Strip(max(plain.low, 0.0) + press * entering.low, max(plain.high, 0.0) + press * entering.high);
      Strip change = minus(p, plain);
      if (largestOf(change) > 0.0) addSource(at);
      writeStrip(kLayerPressure, at, p);
      writeStrip(kLayerResidual, at, minus(unshifted, scaled(readStrip(kLayerProduct, at), step_length)));
      writeStrip(kLayerProduct, at, change);
      sums += vec2(sumOf(p), sumOf(entering));
    }
    cut_short = cut_short || k < num_strips;
    partial[v] = vec4(sums, 0, 0);
  }
  return sumOfPartials(num_parts).xy;
}

// Iterates from the pressures that begin() left until the residual is small enough; returns how many times. A load beyond full depth ends as full depth,
// `goal.by_load` false.
uint solve(inout Solution found, inout Goal goal) {
  uint iteration = 0, end = ITERATIONS;
  float factor = 1.0;
  float before = 0.0;  // squares before the step; 0 starts the directions anew
  bool ended = false;
  clearSources();
  while (true) {
    settle(found, goal, factor);
    factor = 1.0;
    if (iteration >= end || found.residual <= TOLERANCE) {
      if (!LOADS || !goal.by_load || found.shift <= 1.0) {
        ended = true;
        break;
      }
      goal.by_load = false;
      found.shift = 1.0;
      end = iteration + ITERATIONS;
      before = 0.0;
      clearSources();
      continue;
    }
    ++iteration;
    float share = before > 0.0 ? found.squares / before : 0.0;
    before = found.squares;
    clearSources();
    direct(found, share);
    meet();
    float step_length = answer(found, goal);
    clearSources();
    vec2 sums = advance(found, step_length);
    if (LOADS && goal.by_load && sums.x > 0.0) factor = goal.sum / sums.x;
    if (sums.y > 0.0) before = 0.0;
  }
  cut_short = cut_short || !ended;
  return iteration;
}
