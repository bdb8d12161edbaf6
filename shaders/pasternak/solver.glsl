// Displacements of a two-parameter foundation under a rigid surface, by a fixed number of red-black sweeps of projected successive over-relaxation.
//
//   spring w + sum over links of c link (w - w') = f >= 0,   w >= d,   f (w - d) = 0
//
// A link has c = 2 where an outline of the object crosses it, which on average is half-way (src/reference/pasternak.h). Beyond the window and beyond the array
// the surface decays exponentially. foundation[] holds three arrays per instance: w (m), d (m), and the factors c - 1 of the four links of each node as bytes, which
// the forces f (N) replace in the end. Twin: src/reference/pasternak.cpp.

const uint kDisplacement = 0u, kOverlap = 1u, kLinks = 2u, kForce = 2u, kNumFoundationArrays = 3u;

uint nodeAddress(uint instance, uint array, uvec2 node) {
  return ((instance * kNumFoundationArrays + array) * kNodes.x + node.x) * kNodes.y + node.y;
}

float valueAt(uint instance, uint array, uvec2 node) { return uintBitsToFloat(foundation[nodeAddress(instance, array, node)]); }
float displacementAt(uint instance, uvec2 node) { return valueAt(instance, kDisplacement, node); }

// c - 1: grows from 0 to 1 while the surface falls by one to two spacings between two nodes, of which one overlaps.
vec2 linkFactors(float a, vec2 b, float spacing) {
  vec2 steep = clamp(abs(a - b) / spacing - 1.0, 0.0, 1.0);
  return steep * vec2(greaterThan(max(vec2(a), b), vec2(0)));
}

// Copies the overlaps of the window; elsewhere than under the object there is none.
void copyOverlaps(uint instance, Surface surface, Window window) {
  uint total = window.count.x * window.count.y, k = gl_LocalInvocationIndex;
  for (; k < total; k += WORKGROUP) {
    foundation[nodeAddress(instance, kOverlap, window.first + cellNumbered(k, window.count.y))] = floatBitsToUint(-kMiss);
  }
  checkLoop(k < total);
  workgroupBarrierWithBuffers();
  for (uint t = 0; t < NUM_HEIGHT_TILES; ++t) {
    Window part = intersectionOf(window, reachedNodes(surface, t));
    total = part.count.x * part.count.y;
    k = gl_LocalInvocationIndex;
    for (; k < total; k += WORKGROUP) {
      uvec2 node = part.first + cellNumbered(k, part.count.y);
      foundation[nodeAddress(instance, kOverlap, node)] = floatBitsToUint(overlapAt(surface, node));
    }
    checkLoop(k < total);
  }
  workgroupBarrierWithBuffers();
}

// Sets links and first displacements of the window.
void startNodes(uint instance, Window window) {
  vec2 spacing = nodeSpacing();
  uint total = window.count.x * window.count.y, k = gl_LocalInvocationIndex;
  for (; k < total; k += WORKGROUP) {
    uvec2 in_window = cellNumbered(k, window.count.y), node = window.first + in_window;
    float own = valueAt(instance, kOverlap, node);
    vec4 neighbours = vec4(own);  // beyond the window or the array there is no outline
    if (in_window.x > 0) neighbours.x = valueAt(instance, kOverlap, node - uvec2(1, 0));
    if (in_window.x + 1u < window.count.x) neighbours.y = valueAt(instance, kOverlap, node + uvec2(1, 0));
    if (in_window.y > 0) neighbours.z = valueAt(instance, kOverlap, node - uvec2(0, 1));
    if (in_window.y + 1u < window.count.y) neighbours.w = valueAt(instance, kOverlap, node + uvec2(0, 1));
    vec4 factors = vec4(linkFactors(own, neighbours.xy, spacing.x), linkFactors(own, neighbours.zw, spacing.y));
    foundation[nodeAddress(instance, kLinks, node)] = packUnorm4x8(factors);
    foundation[nodeAddress(instance, kDisplacement, node)] = floatBitsToUint(max(own, 0.0));
  }
  checkLoop(k < total);
  workgroupBarrierWithBuffers();
}

// The equation of a node: x: sum of link w', y: its diagonal, N/m.
vec2 nodeEquation(uint instance, Window window, uvec2 node, float own) {
  vec4 links = (1.0 + unpackUnorm4x8(foundation[nodeAddress(instance, kLinks, node)])) * vec4(LINK_X, LINK_X, LINK_Y, LINK_Y);
  vec4 neighbours = own * vec4(DECAY_X, DECAY_X, DECAY_Y, DECAY_Y);
  uvec2 in_window = node - window.first;
  if (in_window.x > 0) neighbours.x = displacementAt(instance, node - uvec2(1, 0));
  if (in_window.x + 1u < window.count.x) neighbours.y = displacementAt(instance, node + uvec2(1, 0));
  if (in_window.y > 0) neighbours.z = displacementAt(instance, node - uvec2(0, 1));
  if (in_window.y + 1u < window.count.y) neighbours.w = displacementAt(instance, node + uvec2(0, 1));
  precise float pull = links.x * neighbours.x + links.y * neighbours.y + links.z * neighbours.z + links.w * neighbours.w;
  precise float diagonal = SPRING + links.x + links.y + links.z + links.w;
  return vec2(pull, diagonal);
}

// Moves the nodes of one colour.
void sweep(uint instance, Window window, uint colour) {
  uint half_row = (window.count.y + 1u) / 2u;
  uint total = window.count.x * half_row, k = gl_LocalInvocationIndex;
  for (; k < total; k += WORKGROUP) {
    uvec2 at = cellNumbered(k, half_row);
    at.y = 2u * at.y + ((at.x + colour) & 1u);
    if (at.y >= window.count.y) continue;
    uvec2 node = window.first + at;
    float own = displacementAt(instance, node);
    vec2 equation = nodeEquation(instance, window, node, own);
    precise float next = own + OVER_RELAXATION * (equation.x / equation.y - own);
    foundation[nodeAddress(instance, kDisplacement, node)] = floatBitsToUint(max(next, max(valueAt(instance, kOverlap, node), 0.0)));
  }
  checkLoop(k < total);
  workgroupBarrierWithBuffers();
}

// Replaces the links of the window by the forces. Returns the sums of force (N), force times x and y of P (N m), and nodes at full depth.
vec4 nodeForces(uint instance, Window window) {
  uint total = window.count.x * window.count.y;
  for (uint v = gl_LocalInvocationIndex; v < LANES; v += WORKGROUP) {
    vec4 sums = vec4(0);
    uint k = v;
    for (; k < total; k += LANES) {
      uvec2 node = window.first + cellNumbered(k, window.count.y);
      float own = displacementAt(instance, node), overlap = valueAt(instance, kOverlap, node);
      vec2 equation = nodeEquation(instance, window, node, own);
      precise float reaction = equation.y * own - equation.x;
      float force = own <= overlap ? max(reaction, 0.0) : 0.0;
      foundation[nodeAddress(instance, kForce, node)] = floatBitsToUint(force);
      sums += vec4(force, force * nodePosition(node), overlap >= THICKNESS ? 1.0 : 0.0);
    }
    checkLoop(k < total);
    partial[v] = sums;
  }
  workgroupBarrierWithBuffers();
  return sumOfPartials();
}

// Solves the contact of a surface; returns the sums of nodeForces().
vec4 solveContact(uint instance, Surface surface, out Window window) {
  window = overlapWindow(surface);
  copyOverlaps(instance, surface, window);
  startNodes(instance, window);
  for (uint s = 0; s < 2u * SWEEPS; ++s) sweep(instance, window, s & 1u);
  return nodeForces(instance, window);
}
