// Target displacements of an elastic layer (thicknesses), and the window of strips whose nodes may be in contact.
//
// Nodes whose target is not above a limit cannot be touched: their target becomes kNoTarget, and the window shrinks to the other nodes.

vec4 aboveOrNoTarget(vec4 target, float limit) { return mix(vec4(kNoTarget), target, greaterThan(target, vec4(limit))); }

// Stores the targets of a strip that are above `limit`; the strip becomes a source if there are any.
void setTarget(Window window, uvec2 at, Strip target, float limit) {
  target = Strip(aboveOrNoTarget(target.low, limit), aboveOrNoTarget(target.high, limit));
  writeStrip(window, kLayerTarget, at, target);
  if (largestOf(target) > kNoTarget) addSource(at);
}

// Shrinks the window to the sources. `end`: end of the strips of a row that have targets.
void shrinkWindow(inout Window window, uint end) {
  workgroupBarrierWithBuffers();
  uvec2 rows = uvec2(source_rows[0], source_rows[1]);
  for (uint row = rows.x + gl_LocalInvocationIndex; row < rows.y; row += WORKGROUP) {
    if (source_first[row] < source_end[row]) atomicMax(widest, source_end[row] - source_first[row]);
  }
  workgroupBarrierWithBuffers();
  uint width = widest;
  for (uint row = rows.x + gl_LocalInvocationIndex; row < rows.y; row += WORKGROUP) {
    window_first[row] = min(source_first[row], end - width);
  }
  setWindow(window, uvec2(rows.x, max(rows.y, rows.x) - rows.x), width);
  workgroupBarrierWithBuffers();
}

// The smallest window over the nodes that were reached.
Window reachedWindow(uint instance, Surface surface) {
  uint first = surface.reached.z / kStrip, end = (surface.reached.w + kStrip - 1u) / kStrip;
  Window window;
  window.layer_start = layerStart(instance);
  for (uint row = gl_LocalInvocationIndex; row < NODE_ROWS; row += WORKGROUP) window_first[row] = first;
  setWindow(window, uvec2(surface.reached.x, surface.reached.y - surface.reached.x), end - first);
  return window;
}

// Sets the targets to the overlaps with the surface that are above `limit`.
void setTargets(Surface surface, float limit, inout Window window) {
  uint end = surface.reached.z / kStrip + window.width;
  clearSources();
  uint k = gl_LocalInvocationIndex;
  for (; k < window.num_strips; k += WORKGROUP) setTarget(window, stripAt(window, k), overlapsOver(surface, stripAt(window, k)), limit);
  checkLoop(k < window.num_strips);
  shrinkWindow(window, end);
}

// Keeps the targets that are above `limit`. `end` as in shrinkWindow().
void limitTargets(uint end, float limit, inout Window window) {
  clearSources();
  uint k = gl_LocalInvocationIndex;
  for (; k < window.num_strips; k += WORKGROUP) setTarget(window, stripAt(window, k), readStrip(window, kLayerTarget, stripAt(window, k)), limit);
  checkLoop(k < window.num_strips);
  shrinkWindow(window, end);
}

// Clears the pressures outside the window; all of them in the first step.
void clearPressures(Window window, bool first_step) {
  uint k = gl_LocalInvocationIndex;
  for (; k < NODE_ROWS * kRowStrips; k += WORKGROUP) {
    uvec2 at = uvec2(k / kRowStrips, k % kRowStrips);
    bool in_window = at.x - window.rows.x < window.rows.y && at.y - window_first[at.x] < window.width;
    if (first_step || !in_window) writeStrip(window, kLayerPressure, at, strip(0.0));
  }
  checkLoop(k < NODE_ROWS * kRowStrips);
  workgroupBarrierWithBuffers();
}
