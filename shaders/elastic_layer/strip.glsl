// Strips of kStrip nodes along a row of an elastic layer: their storage in layer[]. Layout: shared/elastic_layer.h.
//
// layer[] holds kLayerArrays arrays per instance, each (NODE_ROWS x kRowNodes) floats in pairs of words. A strip is the vec4 of its values; it is addressed by
// `at`, its row and the column of its first node, which is even. Nodes past NODE_COLS pad a row.

const uint kRowStrips = (NODE_COLS + kStrip - 1) / kStrip;
const uint kNumStrips = NODE_ROWS * kRowStrips;  // of a whole array
const uint kRowNodes = kRowStrips * kStrip;
const uint kArrayPairs = NODE_ROWS * kRowNodes / 2;
const uint kLayerArrays = kNumLayerArrays + (RELAXATION > 0 ? 1 + RELAXATION : 0) + (AREA ? RELAXATION > 0 ? 2 : 1 : 0);

// Strip `k` of a whole array.
uvec2 stripNumbered(uint k) { return uvec2(k / kRowStrips, k % kRowStrips * kStrip); }

// First pair of an instance in layer[].
uint layerStart(uint instance) { return instance * kLayerArrays * kArrayPairs; }

// The pair that holds a node.
uint pairAddress(uint layer_start, uint array, uvec2 node) { return layer_start + array * kArrayPairs + (node.x * kRowNodes + node.y) / 2; }

vec4 stripFrom(uint address) { return uintBitsToFloat(uvec4(wordsOf(layer[address]), wordsOf(layer[address + 1]))); }

vec4 readStrip(uint layer_start, uint array, uvec2 at) { return stripFrom(pairAddress(layer_start, array, at)); }

void writeStrip(uint layer_start, uint array, uvec2 at, vec4 values) {
  uint address = pairAddress(layer_start, array, at);
  uvec4 words = floatBitsToUint(values);
  layer[address] = pairOf(words.xy);
  layer[address + 1] = pairOf(words.zw);
}

// Value of an array at one node.
float valueAt(uint layer_start, uint array, uvec2 node) {
  uvec2 words = wordsOf(layer[pairAddress(layer_start, array, node)]);
  return uintBitsToFloat((node.y & 1u) == 0 ? words.x : words.y);
}

float sumOf(vec4 strip) { return dot(strip, vec4(1)); }
float largestOf(vec4 strip) { return max(max(strip.x, strip.y), max(strip.z, strip.w)); }

// 1 where a value is above `limit`, else 0.
vec4 whereAbove(vec4 strip, float limit) { return vec4(greaterThan(strip, vec4(limit))); }
