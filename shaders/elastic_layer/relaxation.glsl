// Relaxation of an elastic layer. All its moduli follow one k(t), so that the pressures p follow the strain pressures P, with A P = w, node by node as those of
// a sample follow its strain (skin/relaxation.glsl, which defines e, c, held and gain). Twins: src/reference/relaxation.cpp, elastic_layer.cpp.
//
// Without pressure a step leaves the dent q = P - held / gain; pressure adds p / gain to it. With p' = p / gain the contact problem is
//   A p' = d - A q where p' > 0,   A p' >= d - A q elsewhere:
// that of a layer without relaxation whose targets are lower by the displacement of the dents. Then P' = q + p'.
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
      writeStrip(window, kLayerTarget, at, target);
      deepest = max(deepest, largestOf(target));
    }
    checkLoop(k < window.num_strips);
    partial[v] = vec4(deepest);
  }
  return largestOfPartials(window.num_parts);
}

// Updates strain and overstresses of all nodes under the pressures of the solution.
void updateSkin(SkinStep step, uint layer_start) {
  uint k = gl_LocalInvocationIndex;
  for (; k < NODE_ROWS * kRowStrips; k += WORKGROUP) {
    uvec2 at = uvec2(k / kRowStrips, k % kRowStrips);
    Strip before = strip(0.0);
    if (!step.is_new) before = readStrip(layer_start, kLayerStrain, at);
    Strip strain = sumOf(dentAt(step, layer_start, at), readStrip(layer_start, kLayerPressure, at));
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
