// Relaxation of an elastic layer: all its moduli follow one k(t), so that pressures p follow the strain pressures P, A P = w, node by node as those of a
// sample follow its strain (relaxation.glsl, whose e, c, held and gain these are). Included by elastic_layer.comp, whose names it uses, after
// layer_solver.glsl. Twin: src/reference/relaxation.cpp, elastic_layer.cpp.
//
// Without pressure a step would leave the dent q = P - held / gain; pressure adds p / gain to it. So with p' = p / gain
//   A p' = d - A q where p' > 0,   A p' >= d - A q elsewhere:
// the layer that has not relaxed, with a target lower by the dents. P' = q + p'.
//
// State: P, then h of each term, over all nodes; in the units of pressures.

bool skin_is_new;  // the instance's first step

Strip faded(uint term, Strip h) { return sumOf(scaled(h, skin_fade[term]), scaled(h, skin_fade_rest[term])); }

// q of a strip.
Strip dentAt(uvec2 at) {
  if (skin_is_new) return strip(0.0);
  Strip strain = readStrip(kLayerStrain, at);
  Strip held = scaled(strain, skin_settled);
  for (uint term = 0; term < RELAXATION; ++term) held = sumOf(held, faded(term, readStrip(kLayerOverstress + term, at)));
  Strip dent = minus(strain, scaled(held, 1.0 / skin_gain));
  return Strip(max(dent.low, 0.0), max(dent.high, 0.0));  // negative by rounding alone
}

// Lowers the targets of the window by the dents, which kLayerDirection then holds. Returns the largest target, kNever if there is none.
float sinkTargets() {
  clearSources();
  uint k = gl_LocalInvocationIndex;
  for (; k < NODE_ROWS * kRowStrips; k += WORKGROUP) {
    uvec2 at = uvec2(k / kRowStrips, k % kRowStrips);
    Strip dent = dentAt(at);
    writeStrip(kLayerDirection, at, dent);
    if (largestOf(dent) > 0.0) addSource(at);
  }
  cut_short = cut_short || k < NODE_ROWS * kRowStrips;
  meet();
  for (uint v = gl_LocalInvocationIndex; v < num_parts; v += WORKGROUP) {
    float deepest = kNever;
    uint k = v;
    for (; k < num_strips; k += LANES) {
      uvec2 at = stripAt(k);
      Strip target = minus(readStrip(kLayerTarget, at), displacementAt(at, kLayerDirection));  // kNever is too large to change
      writeStrip(kLayerTarget, at, target);
      deepest = max(deepest, largestOf(target));
    }
    cut_short = cut_short || k < num_strips;
    partial[v] = vec4(deepest);
  }
  return largestOfPartials(num_parts);
}

// Moves the state on, under the pressures that were found.
void keepSkin() {
  uint k = gl_LocalInvocationIndex;
  for (; k < NODE_ROWS * kRowStrips; k += WORKGROUP) {
    uvec2 at = uvec2(k / kRowStrips, k % kRowStrips);
    Strip before = strip(0.0);
    if (!skin_is_new) before = readStrip(kLayerStrain, at);
    Strip strain = sumOf(dentAt(at), readStrip(kLayerPressure, at));
    Strip added = minus(strain, before);
    for (uint term = 0; term < RELAXATION; ++term) {
      Strip h = scaled(added, skin_growth[term]);
      if (!skin_is_new) h = sumOf(h, faded(term, readStrip(kLayerOverstress + term, at)));
      writeStrip(kLayerOverstress + term, at, h);
    }
    writeStrip(kLayerStrain, at, strain);
  }
  cut_short = cut_short || k < NODE_ROWS * kRowStrips;
}
