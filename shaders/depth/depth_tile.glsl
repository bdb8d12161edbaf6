// The lowest surface over each sample of the tile that a workgroup is at. Included by contact.comp, whose names it uses.
//
// The bits of a float that is never negative order like the float itself, so the tile keeps minima, and the order of triangles does not show. It is empty
// between two tiles that a workgroup goes to: where surfaces have been seen it is cleared behind them.

const uint kEmpty = 0x7F7FFFFFu;  // the largest finite float, as bits: no surface over the sample
shared uint tile[TILE_SAMPLES];
#ifdef LOCKSTEP
shared int lane_words[WORKGROUP];
#else
shared int active_box[4];  // first row, last row, first col, last col
#endif

// As integers, a negative float is a negative number.
void lowerTile(uint address, float z) {
  int height = max(floatBitsToInt(z - z_base), 0);
  atomicMin(tile[address], withSlot(intBitsToFloat(height), raster_slot));
}

void clearTile() {
  for (uint address = gl_LocalInvocationIndex; address < TILE_SAMPLES; address += WORKGROUP) tile[address] = kEmpty;
}

void clearSamples(Box box) {
  if (!isAny(box)) return;
  for (int row = box.first.x + int(gl_LocalInvocationIndex); row <= box.last.x; row += int(WORKGROUP)) {
    uint first = uint(row) * tile_stride + uint(box.first.y), last = first + uint(box.last.y - box.first.y);
    for (uint address = first; address <= last; ++address) tile[address] = kEmpty;
  }
}

// The box around those of all invocations, which come here together. One of them calls startBoxes() beforehand, and all meet in between.
#ifdef LOCKSTEP
void startBoxes() {}

int leastOfAll(int mine) {
  lane_words[gl_LocalInvocationIndex] = mine;
  workgroupBarrier();
  int least = mine;
  for (uint v = 0; v < WORKGROUP; ++v) least = min(least, lane_words[v]);
  workgroupBarrier();
  return least;
}

Box boxAround(Box part) {
  return Box(ivec2(leastOfAll(part.first.x), leastOfAll(part.first.y)), -ivec2(leastOfAll(-part.last.x), leastOfAll(-part.last.y)));
}
#else
void startBoxes() {
  active_box[0] = active_box[2] = 0x7FFFFFFF;
  active_box[1] = active_box[3] = -1;
}

Box boxAround(Box part) {
  if (isAny(part)) {
    atomicMin(active_box[0], part.first.x);
    atomicMax(active_box[1], part.last.x);
    atomicMin(active_box[2], part.first.y);
    atomicMax(active_box[3], part.last.y);
  }
  workgroupBarrier();
  return Box(ivec2(active_box[0], active_box[2]), ivec2(active_box[1], active_box[3]));
}
#endif
