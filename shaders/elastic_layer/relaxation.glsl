// Relaxation of an elastic layer. All its moduli follow one k(t), so that the pressures p follow the strain pressures P, with A P = w, node
// by node as those of a sample follow its strain (skin/sample_states.glsl, which defines e, c, held and gain). References:
// src/reference/relaxation.cpp, elastic_layer.cpp.
//
// Without pressure a step leaves the dent q = P - held / gain; pressure adds p / gain to it. With p' = p / gain the contact problem is
//   A p' = d - A q where p' > 0,   A p' >= d - A q elsewhere:
// that of a layer without relaxation whose targets are lower by the displacement of the dents. Then P' = q + p'.
//
// With area sampling a pressure is the mean over a node's whole cell, of dents too. Its own displacement has the compliance of the part
// that was covered when it acted (kLayerDentCompliance, a mean with the pressures as weights); another part of the cell meets the share of
// it that both parts have in common: the compliance that is nearer to a whole cell's. So a dent under what made it moves as the pressures
// there, and a dent of a whole cell or under one moves as with points.
//
// State: P and one overstress h per term, over all nodes, in units of pressures (kLayerStrain, kLayerOverstress).

vec4 faded(SkinStep step, uint term, vec4 h) { return h * step.fade[term] + h * step.fade_rest[term]; }

// q of a strip.
vec4 dentAt(SkinStep step, uint layer_start, uvec2 at) {
  if (step.is_new) return vec4(0);
  vec4 strain = readStrip(layer_start, kLayerStrain, at);
  vec4 held = strain * step.settled;
  for (uint term = 0; term < RELAXATION; ++term) held += faded(step, term, readStrip(layer_start, kLayerOverstress + term, at));
  vec4 dent = strain - held * (1.0 / step.gain);
  return max(dent, 0.0);  // negative only by rounding
}

// Compliance of dents to the part that is covered now, less that of a whole cell.
vec4 dentCompliance(Window window, uvec2 at) {
  vec4 then = readStrip(window, kLayerDentCompliance, at), now = readStrip(window, kLayerCompliance, at);
  return clamp(then, min(now, 0.0), max(now, 0.0));
}

// Lowers the targets of a strip by the displacement of the dents in kLayerDirection. Returns the largest target.
float lowerTargets(SkinStep step, Window window, uvec2 at) {
  // kNoTarget is so large that the difference rounds to it.
  vec4 target = readStrip(window, kLayerTarget, at) - displacementAt(window, at, kLayerDirection);
  if (AREA && !step.is_new) {
    // The displacement has the compliances of the parts that are covered now.
    vec4 other = dentCompliance(window, at) - readStrip(window, kLayerCompliance, at);
    target -= other * readStrip(window, kLayerDirection, at);
  }
  writeStrip(window, kLayerTarget, at, target);
  return largestOf(target);
}

// Lowers the targets of the window by the displacement of the dents, which are left in kLayerDirection. Returns the largest target,
// kNoTarget without any.
float lowerTargetsByDents(SkinStep step, Window window) {
  clearSources();
  FOR_EACH(kNumStrips, {
    uvec2 at = stripNumbered(k);
    vec4 dent = dentAt(step, window.layer_start, at);
    writeStrip(window, kLayerDirection, at, dent);
    if (largestOf(dent) > 0.0) addSource(at);
  })
  workgroupBarrierWithBuffers();
  REDUCE_STRIPS(window, vec4(kNoTarget), sums.x = max(sums.x, lowerTargets(step, window, at)))
  return largestOfPartials(window.num_parts);
}

// Updates the compliance of the dents of a strip, which are `dent` before the pressures act.
void updateDentCompliance(SkinStep step, uint layer_start, uvec2 at, vec4 dent) {
  vec4 then = vec4(0), now = readStrip(layer_start, kLayerCompliance, at), pressure = readStrip(layer_start, kLayerPressure, at);
  if (!step.is_new) then = readStrip(layer_start, kLayerDentCompliance, at);
  vec4 mean = (dent * then + pressure * now) / (dent + pressure);
  writeStrip(layer_start, kLayerDentCompliance, at, mix(then, mean, greaterThan(pressure, vec4(0))));
}

void updateSkin(SkinStep step, uint layer_start, uvec2 at) {
  vec4 before = vec4(0);
  if (!step.is_new) before = readStrip(layer_start, kLayerStrain, at);
  vec4 dent = dentAt(step, layer_start, at), strain = dent + readStrip(layer_start, kLayerPressure, at);
  if (AREA) updateDentCompliance(step, layer_start, at, dent);
  vec4 added = strain - before;
  for (uint term = 0; term < RELAXATION; ++term) {
    vec4 h = added * step.growth[term];
    if (!step.is_new) h += faded(step, term, readStrip(layer_start, kLayerOverstress + term, at));
    writeStrip(layer_start, kLayerOverstress + term, at, h);
  }
  writeStrip(layer_start, kLayerStrain, at, strain);
}

// Updates strain and overstresses of all nodes under the pressures of the solution.
void updateSkin(SkinStep step, uint layer_start) { FOR_EACH(kNumStrips, updateSkin(step, layer_start, stripNumbered(k))) }
