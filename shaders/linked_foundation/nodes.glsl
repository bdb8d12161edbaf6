// The nodes of a linked foundation, and what they meet.

// Overlap of a node at the skin's full thickness, m.
float fullOverlap() { return AREA ? kFullDepth * THICKNESS : THICKNESS; }

// Place of a node in the heights of all instances. False outside of what the tiles of the contact pass have reached.
bool isReached(uint instance, uvec4 record, out uint place) {
  uvec2 at = uvec2(record.y >> 16, record.y & 0xFFFFu);
  uint tile = record.w & ((1u << kNodeLinksShift) - 1u);
  place = instance * kNumNodes + record.x;
  return isInside(at, windows[instance * NUM_HEIGHT_TILES + tile].window);
}

// Signed overlap of object and undeformed skin at a node, m. With AREA sets its arms (links.glsl).
float overlapOf(uint instance, uint node, out uvec2 arms) {
  uint place;
  arms = uvec2(0);
  if (!isReached(instance, fourOf(FoundationNodes, node), place)) return -kMiss;
  float height = uintBitsToFloat(heights[place]);
  if (AREA) {
    CutCell cell = cutCell(height, cellPart(place));
    if (cell.height < 0.0) arms = uvec2(packUnorm2x16(cell.arms.xy), packUnorm2x16(cell.arms.zw));
    height = cell.is_under ? cell.height : kMiss;
  }
  return min(-height, THICKNESS);
}

// With AREA the mean overlap over the cell of a node, m.
float meanOverlap(uint instance, uint node) {
  uint place;
  if (!isReached(instance, fourOf(FoundationNodes, node), place)) return 0.0;
  CellPart part = cellPart(place);
  return part.covered * clamp(-uintBitsToFloat(part.height), 0.0, THICKNESS);
}
