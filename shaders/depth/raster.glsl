// Rasterizes triangles of meshes into the tile's heights; an invocation draws one triangle or two that share an edge. Reference:
// src/reference/depth.cpp (rays).
//
// Coverage is exact, in integers, with the coordinates of depth/mesh.glsl. Rows run along u. Heights z are floats, in m, in P.

#include "depth/area/facets.glsl"

// Edge function of q and r at the origin: twice the signed area of the triangle (origin, q, r).
int edge(ivec2 q, ivec2 r) { return q.x * r.y - q.y * r.x; }

// Height z of a surface over a sample; kNoHeight if the sample is outside of the surface.
float visibleHeight(Tile tile, bool outside, float z, inout Found found) {
  if (NUM_ROWS > 0) return outside ? kNoHeight : z;
  return !outside && isVisible(tile, z, found) ? z : kNoHeight;
}

// Half-space test for small triangles, two that share the edge from q to r, (p, q, r) and (r, q, s): every sample of the bounding box is
// tested against the five edges. No edge is longer than 2^kSmallEdgeBits units, so that 32 bits hold the products. A sample on the shared
// edge belongs to both triangles.
//
//    p ------ r      Edge functions are updated incrementally: by one amount from a sample of a row to the next, by another from
//    |      / |      the end of a row to the start of the next row. For a back-facing triangle all signs are flipped: its mask
//    |    /   |      is ~0, and (e + mask) ^ mask is negative where -e is. A sample is covered unless the sign of the three
//    |  /     |      results or-ed together is set. The three edge functions add up to twice the triangle's area everywhere, so
//    q ------ s      that one of them need not be updated.
void rasterBySamples(Tile tile, MeshView view, Vertex p, Vertex q, Vertex r, Vertex s, inout Found found) {
  if (p.z >= tile.z_limit && q.z >= tile.z_limit && r.z >= tile.z_limit && s.z >= tile.z_limit) return;
  ivec2 first = firstSample(view, min(min(p.at, q.at), min(r.at, s.at)));
  ivec2 last = lastSample(tile, view, max(max(p.at, q.at), max(r.at, s.at)));
  if (first.x > last.x || first.y > last.y) return;
  ivec2 steps = last - first;

  // Edge functions at the first sample.
  ivec2 origin = first << view.subpixel_bits;
  p.at -= origin, q.at -= origin, r.at -= origin, s.at -= origin;
  int qr = edge(q.at, r.at), rp = edge(r.at, p.at), qs = edge(q.at, s.at);
  int area_p = qr + rp + edge(p.at, q.at), area_s = qs + edge(s.at, r.at) - qr;
  int mask_p = area_p >> 31, mask_s = area_s >> 31;

  // Heights: that of p or s, and the slopes towards the other two vertices.
  vec2 slope_p = vec2(q.z - p.z, r.z - p.z) * (1.0 / float(area_p)), slope_s = vec2(r.z - s.z, q.z - s.z) * (1.0 / float(area_s));
  // A triangle seen edge-on covers nothing: with a sum of -1 one of the three edge functions is negative.
  if (area_p == 0) area_p = -1;
  if (area_s == 0) area_s = -1;

  ivec2 along_qr = (r.at - q.at) << view.subpixel_bits, along_rp = (p.at - r.at) << view.subpixel_bits,
        along_qs = (s.at - q.at) << view.subpixel_bits;
  int wrap_qr = -along_qr.y - steps.y * along_qr.x, wrap_rp = -along_rp.y - steps.y * along_rp.x,
      wrap_qs = -along_qs.y - steps.y * along_qs.x;
  int stride = int(tile.stride), wrap_address = stride - steps.y;
  int address = first.x * stride + first.y, row_end = address + steps.y, last_address = last.x * stride + last.y;
  bool any_visible = false;
  do {
    int pq = area_p - qr - rp, sr = area_s - qs + qr;
    bool outside_p = ((((qr + mask_p) ^ mask_p) | ((rp + mask_p) ^ mask_p) | ((pq + mask_p) ^ mask_p)) < 0);
    bool outside_s = ((((mask_s - qr) ^ mask_s) | ((qs + mask_s) ^ mask_s) | ((sr + mask_s) ^ mask_s)) < 0);
    if (!outside_p || !outside_s) {
      float z_p = p.z + float(rp) * slope_p.x + float(pq) * slope_p.y;
      float z_s = s.z + float(qs) * slope_s.x + float(sr) * slope_s.y;
      float z = min(visibleHeight(tile, outside_p, z_p, found), visibleHeight(tile, outside_s, z_s, found));
      if (z < tile.z_limit) {
        lowerHeight(tile, uint(address), z, view.slot);
        any_visible = true;
      }
    }
    bool wraps = address == row_end;
    qr += wraps ? wrap_qr : along_qr.x;
    rp += wraps ? wrap_rp : along_rp.x;
    qs += wraps ? wrap_qs : along_qs.x;
    row_end += wraps ? stride : 0;
    address += wraps ? wrap_address : 1;
  } while (address <= last_address);
  if (any_visible) grow(found.samples, Box(first, last));
  checkLoop(address <= last_address);
}

// Scanline rasterization for large triangles.
//
//        v ->
//   u    top *                 A row a crosses the long edge top-bottom and one of the two short ones; the samples between the
//   |       / \                crossings, half-open, are covered. A crossing is guessed in floats and corrected by 64-bit products that
//   v   row/---\  <- a         depend on the edge's upper and lower vertex only, so that two triangles that share an edge find the same
//         /    * middle        sample and leave no gap.
//        * bottom

// a.x a.y >= b.x b.y
bool isProductAtLeast(ivec2 a, ivec2 b) {
  int a_high, b_high, a_low, b_low;
  imulExtended(a.x, a.y, a_high, a_low);
  imulExtended(b.x, b.y, b_high, b_low);
  return a_high > b_high || (a_high == b_high && uint(a_low) >= uint(b_low));
}

// First sample of the row at `row` (in units) that is not before the edge, which crosses the row.
int crossing(MeshView view, ivec2 upper, ivec2 lower, int row) {
  ivec2 edge = lower - upper;
  int along = row - upper.x;
  int guess = (upper.y + int(float(along) * float(edge.y) / float(edge.x))) >> view.subpixel_bits;
  int b = guess - 1;
  for (int k = 0; k < 3; ++k) {
    if (!isProductAtLeast(ivec2((b << view.subpixel_bits) - upper.y, edge.x), ivec2(along, edge.y))) ++b;
  }
  return b;
}

// First and end sample of the row at `row` (in units) between the edges.
ivec2 spanOf(MeshView view, ivec2 top, ivec2 middle, ivec2 bottom, int row) {
  int b_long = crossing(view, top, bottom, row);
  bool upper = row < middle.x;
  int b_short = crossing(view, upper ? top : middle, upper ? middle : bottom, row);
  return ivec2(min(b_long, b_short), max(b_long, b_short));
}

void orderByU(inout Vertex first, inout Vertex second) {
  if (first.at.x > second.at.x) {
    Vertex swap = first;
    first = second;
    second = swap;
  }
}

void rasterBySpans(Tile tile, MeshView view, Vertex p, Vertex q, Vertex r, inout Found found) {
  float z_low = min(p.z, min(q.z, r.z));
  if (z_low >= tile.z_limit) return;
  float z_high = max(p.z, max(q.z, r.z));

  Vertex top = p, middle = q, bottom = r;
  orderByU(top, middle);
  orderByU(middle, bottom);
  orderByU(top, middle);

  ivec2 first = firstSample(view, ivec2(top.at.x, min(top.at.y, min(middle.at.y, bottom.at.y))));
  ivec2 last = lastSample(tile, view, ivec2(bottom.at.x, max(top.at.y, max(middle.at.y, bottom.at.y))));
  if (last.x << view.subpixel_bits == bottom.at.x) --last.x;  // the rows, too, are half-open
  if (first.x > last.x || first.y > last.y) return;

  // Plane z = z0 + gradient . (u - u0, v - v0), in samples.
  vec2 to_middle = vec2(middle.at - top.at), to_bottom = vec2(bottom.at - top.at);
  float determinant = to_middle.x * to_bottom.y - to_bottom.x * to_middle.y;
  if (determinant == 0.0) return;
  float per_sample = float(1 << view.subpixel_bits) / determinant;
  float rise_middle = middle.z - top.z, rise_bottom = bottom.z - top.z;
  vec2 gradient =
      vec2(rise_middle * to_bottom.y - rise_bottom * to_middle.y, to_middle.x * rise_bottom - to_bottom.x * rise_middle) * per_sample;
  vec2 top_sample = vec2(top.at) / float(1 << view.subpixel_bits);

  bool any_visible = false;
  int a = first.x;
  for (; a <= last.x; ++a) {
    int row = a << view.subpixel_bits;
    ivec2 span = spanOf(view, top.at, middle.at, bottom.at, row);
    int b_first = max(span.x, first.y), b_end = min(span.y, last.y + 1);
    // Skips the part of the row that is too high to touch, but for one sample on the open side, which is tested below.
    float z_row = top.z + gradient.x * (float(a) - top_sample.x);
    float b_limit = clamp(top_sample.y + (tile.z_limit - z_row) / gradient.y, float(b_first) - 2.0, float(b_end) + 2.0);
    if (gradient.y > 0.0) b_end = min(b_end, int(ceil(b_limit)) + 1);
    if (gradient.y < 0.0) b_first = max(b_first, int(floor(b_limit)) - 1);
    uint address = uint(a) * tile.stride + uint(b_first);
    int b = b_first;
    for (; b < b_end; ++b, ++address) {
      float z = clamp(z_row + gradient.y * (float(b) - top_sample.y), z_low, z_high);
      if (!isVisible(tile, z, found)) continue;
      lowerHeight(tile, address, z, view.slot);
      any_visible = true;
    }
    checkLoop(b < b_end);
  }
  if (any_visible) grow(found.samples, Box(first, last));
  checkLoop(a <= last.x);
}

void drawQuad(Tile tile, MeshView view, uint quad, inout Found found) {
  Vertex p, q, r, s;
  fetchQuad(view, quad, p, q, r, s);
  bool large = view.large;  // see isVisible()
  if (isDrawn(kBySamples, !large)) rasterBySamples(tile, view, p, q, r, s, found);
  if (isDrawn(kBySpans, large)) {
    rasterBySpans(tile, view, p, q, r, found);
    rasterBySpans(tile, view, r, q, s, found);
  }
}

void visitQuads(Tile tile, MeshView view, bool is_candidate, uint first, uint count, inout Found found) {
  countIterations(kIterationsOfTriangle * 2u * count);
  const uint kSums = kBySums | kByLargeSums;
  if ((TRIANGLE_SIZES & kSums) != 0) addQuads(tile, view, is_candidate, first, view.closed ? count : 0u, found);
  if ((TRIANGLE_SIZES & ~kSums) == 0) return;
  uint i = gl_LocalInvocationIndex, end = view.closed ? 0u : count;
  do {
    if (i < end) drawQuad(tile, view, quadNumbered(i, is_candidate, first), found);
    i += WORKGROUP;
  } while (i - gl_LocalInvocationIndex < end);
  checkLoop(i < end);
}

// Draws a mesh in batches of GROUPS_PER_BATCH groups.
void visitMesh(Tile tile, Body body, MeshView view, inout Found found) {
  uint start = body.kind_groups.y, end_group = start + body.kind_groups.z;
  do {
    uint count = listQuads(tile, view, start, end_group);
    visitQuads(tile, view, false, 0, count, found);
    workgroupBarrier();
    start += GROUPS_PER_BATCH;
  } while (start < end_group);
  countIterations(body.kind_groups.z);
  checkLoop(start < end_group);
}

// Visits the quads that find_candidates.comp has found; replaces visitMesh().
void visitCandidates(Tile tile, uint instance, MeshView view, inout Found found) {
  visitQuads(tile, view, true, instance * kMaxCandidates, candidates[instance].list.y, found);
  workgroupBarrier();
}
