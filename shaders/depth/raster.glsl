// Stage 1 of the contact pass for meshes: triangles into the depth tile, by one invocation each, or two at a time. Twin: src/reference/depth.cpp (rays).
//
// Which samples a triangle covers is found in integers, exactly. Rows run along u. Heights z are floats, in m, in P.

// Where this invocation has seen triangles.
Box seen;

// Twice the area of the origin, q and r: the edge function of q and r at the origin, positive on one side of the edge.
int edge(ivec2 q, ivec2 r) { return q.x * r.y - q.y * r.x; }

// Of a surface over a sample, if the sample is not outside of it.
float heightSeen(bool outside, float z) {
  if (NUM_ROWS > 0) return outside ? kMiss : z;
  return !outside && isSeen(z) ? z : kMiss;
}

// For triangles of about the size of the samples' spacing, two that share the edge from q to r, (p, q, r) and (r, q, s): every sample of the bounding
// box is tested against the five edges. No edge is longer than kSmallEdge units, so 32 bits hold the products. A sample on an edge belongs to both.
//
//    p ------ r      An edge's value changes by the same amount from each sample of a row to the next, and by another from the end of one row to the
//    |      / |      start of the next. Of a triangle seen from behind all signs are turned: its mask is ~0, and (e + mask) ^ mask is negative
//    |    /   |      where -e is. What is left of three of these is or-ed: the sample is covered unless its sign is set.
//    |  /     |
//    q ------ s      The three add up to twice the triangle's area everywhere, so that one of them need not be followed.
void rasterBySamples(Vertex p, Vertex q, Vertex r, Vertex s) {
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
  int qr = edge(q.at, r.at), rp = edge(r.at, p.at), qs = edge(q.at, s.at);
  int area_p = qr + rp + edge(p.at, q.at), area_s = qs + edge(s.at, r.at) - qr;
  int mask_p = area_p >> 31, mask_s = area_s >> 31;

  // Heights as p's or s's and what the others add.
  vec2 slope_p = vec2(q.z - p.z, r.z - p.z) * (1.0 / float(area_p)), slope_s = vec2(r.z - s.z, q.z - s.z) * (1.0 / float(area_s));
  // Seen edge-on there is none: with a sum of -1 one of three is negative.
  if (area_p == 0) area_p = -1;
  if (area_s == 0) area_s = -1;

  ivec2 along_qr = (r.at - q.at) << subpixel_bits, along_rp = (p.at - r.at) << subpixel_bits, along_qs = (s.at - q.at) << subpixel_bits;
  int wrap_qr = -along_qr.y - steps.y * along_qr.x, wrap_rp = -along_rp.y - steps.y * along_rp.x, wrap_qs = -along_qs.y - steps.y * along_qs.x;

  int stride = int(tile_stride);
  int address = first.x * stride + first.y, row_end = address + steps.y, last_address = last.x * stride + last.y;
  int wrap_address = stride - steps.y;
  bool any_seen = false;
  while (address <= last_address) {
    int pq = area_p - qr - rp, sr = area_s - qs + qr;
    bool outside_p = ((((qr + mask_p) ^ mask_p) | ((rp + mask_p) ^ mask_p) | ((pq + mask_p) ^ mask_p)) < 0);
    bool outside_s = ((((mask_s - qr) ^ mask_s) | ((qs + mask_s) ^ mask_s) | ((sr + mask_s) ^ mask_s)) < 0);
    if (!outside_p || !outside_s) {
      float z_p = p.z + float(rp) * slope_p.x + float(pq) * slope_p.y;
      float z_s = s.z + float(qs) * slope_s.x + float(sr) * slope_s.y;
      float z = min(heightSeen(outside_p, z_p), heightSeen(outside_s, z_s));
      if (z < z_limit) {
        lowerTile(uint(address), z);
        any_seen = true;
      }
    }
    bool wraps = address == row_end;
    qr += wraps ? wrap_qr : along_qr.x;
    rp += wraps ? wrap_rp : along_rp.x;
    qs += wraps ? wrap_qs : along_qs.x;
    row_end += wraps ? stride : 0;
    address += wraps ? wrap_address : 1;
  }
  if (any_seen) grow(seen, Box(first, last));
  cut_short = cut_short || address <= last_address;
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

void rasterBySpans(Vertex p, Vertex q, Vertex r) {
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

// Triangles of a mesh, for depth/mesh.glsl.
void visitQuad(Affine from_lattice, uint quad, bool large) {
  Vertex p, q, r, s;
  fetchQuad(from_lattice, quad, p, q, r, s);
  if (TRIANGLES == 1 || (TRIANGLES == 3 && !large)) rasterBySamples(p, q, r, s);
  if (TRIANGLES == 2 || (TRIANGLES == 3 && large)) {
    rasterBySpans(p, q, r);
    rasterBySpans(r, q, s);
  }
}

// Instead of visitMesh(): the quads that find_candidates.comp has found.
void visitCandidates(uint instance, Body body, Affine from_lattice) {
  uint first = instance * kMaxCandidates, count = candidates[instance].list.y;
  uint i = gl_LocalInvocationIndex;
  for (; i < count; i += WORKGROUP) visitQuad(from_lattice, candidate_quads[first + i], (body.kind_groups.w & kLargeTriangles) != 0);
  cut_short = cut_short || i < count;
  workgroupBarrier();
}
