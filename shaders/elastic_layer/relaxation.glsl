// Relaxation of an elastic layer. All its moduli follow one k(t), so that the pressures p follow the strain pressures P, with A P = w, node by node as those of
// a sample follow its strain (skin/relaxation.glsl, which defines e, c, held and gain). Twins: src/reference/relaxation.cpp, elastic_layer.cpp.
//
// Without pressure a step leaves the dent q = P - held / gain; pressure adds p / gain to it. With p' = p / gain the contact problem is
//   A p' = d - A q where p' > 0,   A p' >= d - A q elsewhere:
// that of a layer without relaxation whose targets are lower by the displacement of the dents. Then P' = q + p'.
//
// With area sampling a pressure is the mean over a node's whole cell, of dents too. Its own displacement has the compliance of what was covered when it acted
// (kLayerDentCompliance, a mean with the pressures as weights); another part of the cell meets of it what both parts have in common: the compliance that is
// nearer to a whole cell's. So a dent under what made it moves as the pressures there, and a dent of a whole cell or under one moves as with points.
//
// State: P and one overstress h per term, over all nodes, in units of pressures (kLayerStrain, kLayerOverstress).

Strip faded(SkinStep step, uint term, Strip h) { return sumOf(scaled(h, step.fade[term]), scaled(h, step.fade_rest[term])); }

// q of a strip.
Strip dentAt(SkinStep step, uint layer_start, uvec2 at) {
  if (step.is_new) return strip(0.0);
  Strip strain = readStrip(layer_start, kLayerStrain, at);
  Strip held = scaled(strain, step.settled);
  for (uint term = 0; term < RELAXATION; ++term) held = sumOf(held, faded(step, term, readStrip(layer_start, kLayerOverstress + term, at)));
  Strip dent = minus(strain, scaled(held, 1.0 / step.gain));
  return Strip(max(dent.low, 0.0), max(dent.high, 0.0));  // negative only by rounding
}

// Compliance of dents to what is covered now, less that of a whole cell.
Strip dentCompliance(Window window, uvec2 at) {
  Strip then = readStrip(window, kLayerDentCompliance, at), now = readStrip(window, kLayerCompliance, at);
  return Strip(clamp(then.low, min(now.low, 0.0), max(now.low, 0.0)), clamp(then.high, min(now.high, 0.0), max(now.high, 0.0)));
}

// Lowers the targets of the window by the displacement of the dents, which are left in kLayerDirection. Returns the largest target, kNoTarget without any.
float lowerTargetsByDents(SkinStep step, Window window) {
  clearSources();
  uint k = gl_LocalInvocationIndex;
  for (; k < NODE_ROWS * kRowStrips; k += WORKGROUP) {
    uvec2 at = uvec2(k / kRowStrips, k % kRowStrips);
    Strip dent = dentAt(step, window.layer_start, at);
    writeStrip(window, kLayerDirection, at, dent);
    if (largestOf(dent) > 0.0) addSource(at);
  }
  checkLoop(k < NODE_ROWS * kRowStrips);
  workgroupBarrierWithBuffers();
  for (uint v = gl_LocalInvocationIndex; v < window.num_parts; v += WORKGROUP) {
    float deepest = kNoTarget;
    uint k = v;
    for (; k < window.num_strips; k += LANES) {
      uvec2 at = stripAt(window, k);
      // kNoTarget is so large that the difference rounds to it.
      Strip target = minus(readStrip(window, kLayerTarget, at), displacementAt(window, at, kLayerDirection));
      if (AREA && !step.is_new) {
        // The displacement has the compliances of what is covered now.
        Strip other = minus(dentCompliance(window, at), readStrip(window, kLayerCompliance, at));
        target = minus(target, productOf(other, readStrip(window, kLayerDirection, at)));
      }
      writeStrip(window, kLayerTarget, at, target);
      deepest = max(deepest, largestOf(target));
    }
    checkLoop(k < window.num_strips);
    partial[v] = vec4(deepest);
  }
  return largestOfPartials(window.num_parts);
}

vec4 dentComplianceAfter(vec4 then, vec4 dent, vec4 now, vec4 pressure) {
  return mix(then, (dent * then + pressure * now) / (dent + pressure), greaterThan(pressure, vec4(0)));
}

// Updates the compliance of the dents of a strip, which are `dent` before the pressures act.
void updateDentCompliance(SkinStep step, uint layer_start, uvec2 at, Strip dent) {
  Strip then = strip(0.0), now = readStrip(layer_start, kLayerCompliance, at), pressure = readStrip(layer_start, kLayerPressure, at);
  if (!step.is_new) then = readStrip(layer_start, kLayerDentCompliance, at);
  Strip after = Strip(dentComplianceAfter(then.low, dent.low, now.low, pressure.low), dentComplianceAfter(then.high, dent.high, now.high, pressure.high));
  writeStrip(layer_start, kLayerDentCompliance, at, after);
}

// Updates strain and overstresses of all nodes under the pressures of the solution.
void updateSkin(SkinStep step, uint layer_start) {
  uint k = gl_LocalInvocationIndex;
  for (; k < NODE_ROWS * kRowStrips; k += WORKGROUP) {
    uvec2 at = uvec2(k / kRowStrips, k % kRowStrips);
    Strip before = strip(0.0);
    if (!step.is_new) before = readStrip(layer_start, kLayerStrain, at);
    Strip dent = dentAt(step, layer_start, at), strain = sumOf(dent, readStrip(layer_start, kLayerPressure, at));
    if (AREA) updateDentCompliance(step, layer_start, at, dent);
    Strip added = minus(strain, before);
    for (uint term = 0; term < RELAXATION; ++term) {
      Strip h = scaled(added, step.growth[term]);
      if (!step.is_new) h = sumOf(h, faded(step, term, readStrip(layer_start, kLayerOverstress + term, at)));
      writeStrip(layer_start, kLayerOverstress + term, at, h);
    }
    writeStrip(layer_start, kLayerStrain, at, strain);
  }
  checkLoop(k < NODE_ROWS * kRowStrips);
}
