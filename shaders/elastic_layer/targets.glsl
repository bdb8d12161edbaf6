// Target displacements of an elastic layer (thicknesses), and the window of strips whose nodes may be in contact.
//
// Nodes whose target is not above a limit cannot be touched: their target becomes kNoTarget, and the window shrinks to the other nodes.

// Stores the targets of a strip that are above `limit`; the strip becomes a source if there are any.
void setTarget(Window window, uvec2 at, vec4 target, float limit) {
  target = mix(vec4(kNoTarget), target, greaterThan(target, vec4(limit)));
  writeStrip(window, kLayerTarget, at, target);
  if (largestOf(target) > kNoTarget) addSource(at);
}

// The columns for which setTargets() stores targets: first, end. They are those of whole bits of source_strips[], so that ranges of sources
// stay in the window.
uvec2 targetColumns(Surface surface) {
  const uint kBitNodes = kStripsPerBit * kStrip;
  return min(uvec2(surface.reached.z, surface.reached.w + kBitNodes - 1u) / kBitNodes * kBitNodes, uvec2(kRowNodes));
}

// Shrinks the window to the sources.
void shrinkWindow(Surface surface, inout Window window) {
  if (gl_LocalInvocationIndex == 0) widest = 0;
  workgroupBarrierWithBuffers();
  uvec2 rows = sourceRows();
  for (uint row = rows.x + gl_LocalInvocationIndex; row < rows.y; row += WORKGROUP) {
    if (source_strips[row] != 0) atomicMax(widest, sourcesOfRow(row).y - sourcesOfRow(row).x);
  }
  workgroupBarrierWithBuffers();
  uint width = widest, last = targetColumns(surface).y - width * kStrip;
  for (uint row = rows.x + gl_LocalInvocationIndex; row < rows.y; row += WORKGROUP) {
    window_first[row] = source_strips[row] == 0 ? last : min(sourcesOfRow(row).x * kStrip, last);
  }
  setWindow(window, uvec2(rows.x, rows.y - rows.x), width);
  workgroupBarrierWithBuffers();
}

// The smallest window over the nodes that were reached.
Window reachedWindow(uint instance, Surface surface) {
  uvec2 cols = targetColumns(surface);
  Window window;
  window.layer_start = layerStart(instance);
  for (uint row = gl_LocalInvocationIndex; row < NODE_ROWS; row += WORKGROUP) window_first[row] = cols.x;
  setWindow(window, uvec2(surface.reached.x, surface.reached.y - surface.reached.x), (cols.y - cols.x) / kStrip);
  return window;
}

// Sets the targets to the overlaps with the surface that are above `limit`.
void setTargets(Surface surface, float limit, inout Window window) {
  clearSources();
  FOR_EACH_STRIP(window, setTarget(window, at, overlapsOver(surface, at), limit))
  shrinkWindow(surface, window);
}

// Keeps the targets that are above `limit`.
void limitTargets(Surface surface, float limit, inout Window window) {
  clearSources();
  FOR_EACH_STRIP(window, setTarget(window, at, readStrip(window, kLayerTarget, at), limit))
  shrinkWindow(surface, window);
}

// Clears the pressures outside the window; all of them in the first step.
void clearPressures(Window window, bool first_step) {
  FOR_EACH(kNumStrips, {
    uvec2 at = stripNumbered(k);
    if (first_step || !isInWindow(window, at)) writeStrip(window, kLayerPressure, at, vec4(0));
  })
  workgroupBarrierWithBuffers();
}
