// Stage 1 of the contact pass for meshes: triangles into the depth tile, by one invocation each, or two at a time. Twin: src/reference/depth.cpp (rays).
//
// Which samples a triangle covers is found in integers, exactly. Rows run along u. Heights z are floats, in m, in P. The tile keeps the lowest surface:
// atomicMin on the bits of a float that is never negative orders like the float itself, and the order of triangles does not show.

// As integers, a negative float is a negative number.
void lowerTile(uint address, float z) {
  int height = max(floatBitsToInt(z - z_base), 0);
  atomicMin(tile[address], withSlot(intBitsToFloat(height), raster_slot));
}

// Twice the area of the origin, q and r: the edge function of q and r at the origin, positive on one side of the edge.
int edge(ivec2 q, ivec2 r) { return q.x * r.y - q.y * r.x; }

// For triangles of about the size of the samples' spacing, two that share the edge from q to r, (p, q, r) and (r, q, s): every sample of the bounding
// box is tested against the five edges. No edge is longer than kSmallEdge units, so 32 bits hold the products. A sample on an edge belongs to both.
//
//    p ------ r      An edge's value changes by the same amount from each sample of a row to the next, and by another from the end of one row to the
//    |      / |      start of the next. Of a triangle seen from behind all signs are turned: its mask is ~0, and (e + mask) ^ mask is negative
//    |    /   |      where -e is. What is left of three of these is or-ed: the sample is covered unless its sign is set.
//    |  /     |
//    q ------ s
void rasterBySamples(Vertex p, Vertex q, Vertex r, Vertex s, inout Box seen) {
  if (p.z >= z_limit && q.z >= z_limit && r.z >= z_limit && s.z >= z_limit) return;
  ivec2 first = firstSample(min(min(p.at, q.at), min(r.at, s.at)));
  ivec2 last = lastSample(max(max(p.at, q.at), max(r.at, s.at)));
  if (first.x > last.x || first.y > last.y) return;
  ivec2 steps = last - first;

  // Values over the first sample.
  ivec2 origin = first << subpixel_bits;
  p.at -= origin;
  q.at -= origin;
  r.at -= origin;
  s.at -= origin;
  int qr = edge(q.at, r.at);
  int rp = edge(r.at, p.at), pq = edge(p.at, q.at);
  int qs = edge(q.at, s.at), sr = edge(s.at, r.at);
  int area_p = qr + rp + pq, area_s = qs + sr - qr;
  int mask_p = area_p >> 31, mask_s = area_s >> 31;

  // Heights as p's or s's and what the others add. Seen edge-on there is none.
  vec2 slope_p = vec2(q.z - p.z, r.z - p.z) * (1.0 / float(area_p)), slope_s = vec2(r.z - s.z, q.z - s.z) * (1.0 / float(area_s));
  if (area_p == 0) p.z = kMiss, slope_p = vec2(0);
  if (area_s == 0) s.z = kMiss, slope_s = vec2(0);

  ivec2 along_qr = (r.at - q.at) << subpixel_bits, along_rp = (p.at - r.at) << subpixel_bits, along_pq = (q.at - p.at) << subpixel_bits;
  ivec2 along_qs = (s.at - q.at) << subpixel_bits, along_sr = (r.at - s.at) << subpixel_bits;
  int wrap_qr = -along_qr.y - steps.y * along_qr.x, wrap_rp = -along_rp.y - steps.y * along_rp.x, wrap_pq = -along_pq.y - steps.y * along_pq.x;
  int wrap_qs = -along_qs.y - steps.y * along_qs.x, wrap_sr = -along_sr.y - steps.y * along_sr.x;

  uint address = uint(first.x) * tile_stride + uint(first.y);
  uint wrap_address = tile_stride - uint(steps.y);
  int count = (steps.x + 1) * (steps.y + 1), next_wrap = steps.y;
  bool any_seen = false;
  int k = 0;
  for (; k < count; ++k) {
    bool outside_p = ((((qr + mask_p) ^ mask_p) | ((rp + mask_p) ^ mask_p) | ((pq + mask_p) ^ mask_p)) < 0);
    bool outside_s = ((((mask_s - qr) ^ mask_s) | ((qs + mask_s) ^ mask_s) | ((sr + mask_s) ^ mask_s)) < 0);
    float z_p = p.z + float(rp) * slope_p.x + float(pq) * slope_p.y;
    float z_s = s.z + float(qs) * slope_s.x + float(sr) * slope_s.y;
    float z = kMiss;
    if (!outside_p && isSeen(z_p)) z = z_p;
    if (!outside_s && isSeen(z_s)) z = z_s < z ? z_s : z;
    any_seen = any_seen || z < kMiss;
    if (z < kMiss) lowerTile(address, z);
    bool wraps = k == next_wrap;
    qr += wraps ? wrap_qr : along_qr.x;
    rp += wraps ? wrap_rp : along_rp.x;
    pq += wraps ? wrap_pq : along_pq.x;
    qs += wraps ? wrap_qs : along_qs.x;
    sr += wraps ? wrap_sr : along_sr.x;
    address += wraps ? wrap_address : 1u;
    next_wrap += wraps ? steps.y + 1 : 0;
  }
  if (any_seen) grow(seen, Box(first, last));
  cut_short = cut_short || k < count;
}

// For larger triangles: row by row.
//
//        v ->
//   u    top *                 A row a crosses the long edge top-bottom and one of the two short ones; the samples between the
//   |       / \                crossings, half-open, are covered. A crossing is guessed in floats and settled by 64-bit products of the
//   v   row/---\  <- a         edge's upper and lower vertex alone, so two triangles that share an edge find the same sample and leave no
//         /    * middle        gap between them.
//        * bottom

// a.x a.y >= b.x b.y
bool isProductAtLeast(ivec2 a, ivec2 b) {
  int a_high, b_high, a_low, b_low;
  imulExtended(a.x, a.y, a_high, a_low);
  imulExtended(b.x, b.y, b_high, b_low);
  return a_high > b_high || (a_high == b_high && uint(a_low) >= uint(b_low));
}

// First sample of the row at `row`, in units, that is not before the edge; the edge crosses the row.
int crossing(ivec2 upper, ivec2 lower, int row) {
  ivec2 edge = lower - upper;
  int along = row - upper.x;
  int guess = (upper.y + int(float(along) * float(edge.y) / float(edge.x))) >> subpixel_bits;
  int b = guess - 1;
  for (int k = 0; k < 3; ++k) {
    if (!isProductAtLeast(ivec2((b << subpixel_bits) - upper.y, edge.x), ivec2(along, edge.y))) ++b;
  }
  return b;
}

void rasterBySpans(Vertex p, Vertex q, Vertex r, inout Box seen) {
  float z_low = min(p.z, min(q.z, r.z));
  if (z_low >= z_limit) return;
  float z_high = max(p.z, max(q.z, r.z));

  // Sort by u.
  Vertex top = p, middle = q, bottom = r;
  if (top.at.x > middle.at.x) { Vertex swap = top; top = middle; middle = swap; }
  if (middle.at.x > bottom.at.x) { Vertex swap = middle; middle = bottom; bottom = swap; }
  if (top.at.x > middle.at.x) { Vertex swap = top; top = middle; middle = swap; }

  ivec2 first = firstSample(ivec2(top.at.x, min(top.at.y, min(middle.at.y, bottom.at.y))));
  ivec2 last = lastSample(ivec2(bottom.at.x, max(top.at.y, max(middle.at.y, bottom.at.y))));
  if (last.x << subpixel_bits == bottom.at.x) --last.x;  // the rows, too, are half-open
  if (first.x > last.x || first.y > last.y) return;

  // Plane z = z0 + gradient . (u - u0, v - v0), in samples.
  vec2 to_middle = vec2(middle.at - top.at), to_bottom = vec2(bottom.at - top.at);
  float determinant = to_middle.x * to_bottom.y - to_bottom.x * to_middle.y;
  if (determinant == 0.0) return;
  float per_sample = float(1 << subpixel_bits) / determinant;
  float rise_middle = middle.z - top.z, rise_bottom = bottom.z - top.z;
  vec2 gradient = vec2(rise_middle * to_bottom.y - rise_bottom * to_middle.y, to_middle.x * rise_bottom - to_bottom.x * rise_middle) * per_sample;
  vec2 top_sample = vec2(top.at) / float(1 << subpixel_bits);

  bool any_seen = false;
  int a = first.x;
  for (; a <= last.x; ++a) {
    int row = a << subpixel_bits;
    int b_long = crossing(top.at, bottom.at, row);
    bool upper = row < middle.at.x;
    int b_short = crossing(upper ? top.at : middle.at, upper ? middle.at : bottom.at, row);
    int b_first = max(min(b_long, b_short), first.y), b_end = min(max(b_long, b_short), last.y + 1);
    // Leave out the part of the row that is too high to touch; one sample more on the open side, tested below.
    float z_row = top.z + gradient.x * (float(a) - top_sample.x);
    float b_limit = clamp(top_sample.y + (z_limit - z_row) / gradient.y, float(b_first) - 2.0, float(b_end) + 2.0);
    if (gradient.y > 0.0) b_end = min(b_end, int(ceil(b_limit)) + 1);
    if (gradient.y < 0.0) b_first = max(b_first, int(floor(b_limit)) - 1);
    uint address = uint(a) * tile_stride + uint(b_first);
    int b = b_first;
    for (; b < b_end; ++b, ++address) {
      float z = clamp(z_row + gradient.y * (float(b) - top_sample.y), z_low, z_high);
      if (!isSeen(z)) continue;
      lowerTile(address, z);
      any_seen = true;
    }
    cut_short = cut_short || b < b_end;
  }
  if (any_seen) grow(seen, Box(first, last));
  cut_short = cut_short || a <= last.x;
}

// Triangles of a mesh, for lib/mesh.glsl.
void visitQuad(Affine from_lattice, uint quad, bool large, inout Box seen) {
  Vertex p = vertexOf(from_lattice, 4 * quad), q = vertexOf(from_lattice, 4 * quad + 1);
  Vertex r = vertexOf(from_lattice, 4 * quad + 2), s = vertexOf(from_lattice, 4 * quad + 3);
  if (TRIANGLES == 1 || (TRIANGLES == 3 && !large)) rasterBySamples(p, q, r, s, seen);
  if (TRIANGLES == 2 || (TRIANGLES == 3 && large)) {
    rasterBySpans(p, q, r, seen);
    rasterBySpans(r, q, s, seen);
  }
}

// Samples of the box, whole taxels of them, are without a surface.
void clearSamples(Box box) {
  if (!isAny(box)) return;
  uvec2 first = uvec2(box.first) / SAMPLES * SAMPLES;
  uvec2 end = (uvec2(box.last) / SAMPLES + 1u) * SAMPLES;
  for (uint row = first.x + gl_LocalInvocationIndex; row < end.x; row += WORKGROUP) {
    for (uint address = row * tile_stride + first.y; address < row * tile_stride + end.y; ++address) tile[address] = kEmpty;
  }
}

void clearUnder(Box reached) {
  addToBox(kCleared, reached);
  workgroupBarrier();
  clearSamples(boxNumbered(kCleared));
}

// Instead of visitMesh(): the quads that find_candidates.comp has found.
void visitCandidates(uint instance, Body body, Affine from_lattice, inout Box seen) {
  uvec4 list = candidates[instance].list;
  clearSamples(Box(ivec2(list.zw & 0xFFFFu), ivec2(list.zw >> 16)));
  workgroupBarrier();
  Affine X = atHand(from_lattice);
  uint first = instance * kMostCandidates;
  uint i = gl_LocalInvocationIndex;
  for (; i < list.y; i += WORKGROUP) visitQuad(X, candidate_quads[first + i], (body.kind_groups.w & kLargeTriangles) != 0, seen);
  cut_short = cut_short || i < list.y;
  workgroupBarrier();
}
