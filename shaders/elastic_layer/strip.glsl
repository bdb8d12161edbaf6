// Strips of kStrip nodes along a row of an elastic layer: their storage in layer[]. Layout: shared/elastic_layer.h.
//
// Layer holds kLayerArrays arrays per instance, each (NODE_ROWS x kRowStrips) strips. A strip is the vec4 of its values; it is addressed by
// `at`, its row and the column of its first node, a multiple of kStrip. Nodes past NODE_COLS pad a row.

const uint kRowStrips = (NODE_COLS + kStrip - 1) / kStrip;
const uint kNumStrips = NODE_ROWS * kRowStrips;  // strips of a whole array
const uint kRowNodes = kRowStrips * kStrip;
const uint kLayerArrays = kNumLayerArrays + (RELAXATION > 0 ? 1 + RELAXATION : 0) + (AREA ? RELAXATION > 0 ? 2 : 1 : 0);

// Strip `k` of a whole array.
uvec2 stripNumbered(uint k) { return uvec2(k / kRowStrips, k % kRowStrips * kStrip); }

// First strip of an instance.
uint layerStart(uint instance) { return instance * kLayerArrays * kNumStrips; }

// The strip that holds a node.
uint stripAddress(uint layer_start, uint array, uvec2 node) {
  return layer_start + array * kNumStrips + node.x * kRowStrips + node.y / kStrip;
}

vec4 readStrip(uint layer_start, uint array, uvec2 at) {
  return uintBitsToFloat(loadFour(LayerStrips, stripAddress(layer_start, array, at)));
}

void writeStrip(uint layer_start, uint array, uvec2 at, vec4 values) {
  uint pair = 2 * stripAddress(layer_start, array, at);
  uvec4 words = floatBitsToUint(values);
  layer[pair] = words.xy;
  layer[pair + 1] = words.zw;
}

// Value of an array at one node.
float valueAt(uint layer_start, uint array, uvec2 node) {
  uint address = stripAddress(layer_start, array, node);
  uvec2 words = layer[2 * address + node.y % kStrip / 2];
  return uintBitsToFloat((node.y & 1u) == 0 ? words.x : words.y);
}

float sumOf(vec4 strip) { return dot(strip, vec4(1)); }
float largestOf(vec4 strip) { return max(max(strip.x, strip.y), max(strip.z, strip.w)); }

// 1 where a value is above `limit`, else 0.
vec4 whereAbove(vec4 strip, float limit) { return vec4(greaterThan(strip, vec4(limit))); }
