// Triangles into the depth tile, by one invocation each, or two at a time. Twin: src/reference/depth.cpp (rays).
//
// Vertices come as (u, v, z): u and v in samples of the patch, sample (a, b) at u = a, v = b; z in m, in P. Rows run along u. The tile keeps the lowest
// surface: atomicMin on the bits of a float that is never negative orders like the float itself, and the order of triangles does not show.

void lowerTile(uint address, float z) { atomicMin(tile[address], withSlot(max(z - z_base, 0.0), raster_slot)); }

// For triangles of about the size of the samples' spacing, two that share the edge from q to r, (p, q, r) and (r, q, s): every sample of the
// bounding box is tested against the five edges. An edge's value comes from the two vertices relative to the sample, so two triangles that share the edge
// find the same number with opposite signs, and a sample on it belongs to both: no gap.
void rasterBySamples(vec3 p, vec3 q, vec3 r, vec3 s) {
  if (min(min(p.z, q.z), min(r.z, s.z)) >= z_limit) return;
  vec2 first = max(ceil(min(min(p.xy, q.xy), min(r.xy, s.xy))), tile_first);
  vec2 last = min(floor(max(max(p.xy, q.xy), max(r.xy, s.xy))), tile_end - 1.0);
  if (first.x > last.x || first.y > last.y) return;
  // Seen edge-on there is no height.
  float area_p = (q.x - p.x) * (r.y - p.y) - (q.y - p.y) * (r.x - p.x);
  float area_s = (q.x - r.x) * (s.y - r.y) - (q.y - r.y) * (s.x - r.x);
  bool has_p = area_p != 0.0, has_s = area_s != 0.0;
  vec3 heights_p = vec3(p.z, q.z, r.z) / (has_p ? area_p : 1.0);
  vec3 heights_s = vec3(r.z, q.z, s.z) / (has_s ? area_s : 1.0);
  uint row_address = uint(first.x - tile_first.x) * tile_stride + uint(first.y - tile_first.y);
  uint address = row_address;
  vec2 at = first;
  while (at.x <= last.x) {
    vec2 tp = p.xy - at, tq = q.xy - at, tr = r.xy - at, ts = s.xy - at;
    precise float qr = tq.x * tr.y - tq.y * tr.x;
    precise float rp = tr.x * tp.y - tr.y * tp.x;
    precise float pq = tp.x * tq.y - tp.y * tq.x;
    precise float qs = tq.x * ts.y - tq.y * ts.x;
    precise float sr = ts.x * tr.y - ts.y * tr.x;
    float z_p = dot(vec3(qr, rp, pq), heights_p), z_s = dot(vec3(qs, sr, -qr), heights_s);
    float z = kMiss;
    if (has_p && (min(qr, min(rp, pq)) >= 0.0 || max(qr, max(rp, pq)) <= 0.0) && isSeen(z_p)) z = z_p;
    if (has_s && (min(-qr, min(qs, sr)) >= 0.0 || max(-qr, max(qs, sr)) <= 0.0) && isSeen(z_s)) z = min(z, z_s);
    if (z < kMiss) lowerTile(address, z);
    at.y += 1.0;
    ++address;
    if (at.y > last.y) {
      at = vec2(at.x + 1.0, first.y);
      row_address += tile_stride;
      address = row_address;
    }
  }
  cut_short = cut_short || at.x <= last.x;
}

// For larger triangles: row by row.
//
//        v ->
//   u    top *                 A row a crosses the long edge top-bottom and one of the two short ones; the samples between the
//   |       / \                crossings, half-open, are covered. A crossing is computed from the edge's upper and lower vertex alone, so
//   v   row/---\  <- a         two triangles that share an edge find the same number and leave no gap between them.
//         /    * middle
//        * bottom
float crossing(vec3 upper, vec3 lower, float a) { return upper.y + (a - upper.x) * ((lower.y - upper.y) / (lower.x - upper.x)); }

void rasterBySpans(vec3 p, vec3 q, vec3 r) {
  float z_low = min(p.z, min(q.z, r.z));
  if (z_low >= z_limit) return;
  float z_high = max(p.z, max(q.z, r.z));

  // Sort by u.
  vec3 top = p, middle = q, bottom = r;
  if (top.x > middle.x) { vec3 swap = top; top = middle; middle = swap; }
  if (middle.x > bottom.x) { vec3 swap = middle; middle = bottom; bottom = swap; }
  if (top.x > middle.x) { vec3 swap = top; top = middle; middle = swap; }

  float first_row = max(ceil(top.x), tile_first.x);
  float end_row = min(ceil(bottom.x), tile_end.x);
  float v_low = min(top.y, min(middle.y, bottom.y));
  float v_high = max(top.y, max(middle.y, bottom.y));
  if (first_row >= end_row || ceil(v_low) >= min(ceil(v_high), tile_end.y) || v_high < tile_first.y) return;

  // Plane z = z0 + gradient . (u - u0, v - v0).
  vec3 e1 = middle - top, e2 = bottom - top;
  float determinant = e1.x * e2.y - e2.x * e1.y;
  if (determinant == 0.0) return;
  vec2 gradient = vec2(e1.z * e2.y - e2.z * e1.y, e1.x * e2.z - e2.x * e1.z) / determinant;

  float a = first_row;
  for (; a < end_row; a += 1.0) {
    float v_long = crossing(top, bottom, a);
    float v_short = a < middle.x ? crossing(top, middle, a) : crossing(middle, bottom, a);
    float b_first = max(ceil(min(v_long, v_short)), tile_first.y);
    float b_end = min(ceil(max(v_long, v_short)), tile_end.y);
    // Leave out the part of the row that is too high to touch; one sample more on the open side, tested below.
    float z_row = top.z + gradient.x * (a - top.x);
    float b_limit = top.y + (z_limit - z_row) / gradient.y;
    if (gradient.y > 0.0) b_end = min(b_end, ceil(b_limit) + 1.0);
    if (gradient.y < 0.0) b_first = max(b_first, floor(b_limit) - 1.0);
    uint address = uint(a - tile_first.x) * tile_stride + uint(max(b_first - tile_first.y, 0.0));
    float b = b_first;
    for (; b < b_end; b += 1.0, ++address) {
      float z = clamp(z_row + gradient.y * (b - top.y), z_low, z_high);
      if (isSeen(z)) lowerTile(address, z);
    }
    cut_short = cut_short || b < b_end;
  }
  cut_short = cut_short || a < end_row;
}
