// Strips of kStrip nodes along a row of an elastic layer: their storage in layer[] and their arithmetic. Layout: shared/elastic_layer.h.
//
// layer[] holds kLayerArrays arrays per instance, each (NODE_ROWS x kRowStrips x kStrip) floats in pairs of words. A strip is addressed by `at`, its row and
// its number in the row. Nodes past NODE_COLS pad the last strip of a row.

const uint kStripPairs = kStrip / 2;
const uint kRowStrips = (NODE_COLS + kStrip - 1) / kStrip;
const uint kArrayPairs = NODE_ROWS * kRowStrips * kStripPairs;
const uint kLayerArrays = kNumLayerArrays + (RELAXATION > 0 ? 1 + RELAXATION : 0) + (AREA ? RELAXATION > 0 ? 2 : 1 : 0);

struct Strip {
  vec4 low, high;
};

Strip strip(float value) { return Strip(vec4(value), vec4(value)); }

vec4 floatsOf(Pair a, Pair b) { return uintBitsToFloat(uvec4(wordsOf(a), wordsOf(b))); }

// First pair of an instance in layer[].
uint layerStart(uint instance) { return instance * kLayerArrays * kArrayPairs; }

uint stripAddress(uint layer_start, uint array, uvec2 at) { return layer_start + array * kArrayPairs + (at.x * kRowStrips + at.y) * kStripPairs; }

Strip readStrip(uint layer_start, uint array, uvec2 at) {
  uint address = stripAddress(layer_start, array, at);
  return Strip(floatsOf(layer[address], layer[address + 1]), floatsOf(layer[address + 2], layer[address + 3]));
}

void writeStrip(uint layer_start, uint array, uvec2 at, Strip values) {
  uint address = stripAddress(layer_start, array, at);
  uvec4 low = floatBitsToUint(values.low), high = floatBitsToUint(values.high);
  layer[address] = pairOf(low.xy);
  layer[address + 1] = pairOf(low.zw);
  layer[address + 2] = pairOf(high.xy);
  layer[address + 3] = pairOf(high.zw);
}

// Value of an array at one node.
float valueAt(uint layer_start, uint array, uvec2 node) {
  uvec2 words = wordsOf(layer[stripAddress(layer_start, array, uvec2(node.x, node.y / kStrip)) + node.y % kStrip / 2]);
  return uintBitsToFloat((node.y & 1u) == 0 ? words.x : words.y);
}

float sumOf(Strip s) { return dot(s.low + s.high, vec4(1)); }
float dotOf(Strip a, Strip b) { return dot(a.low, b.low) + dot(a.high, b.high); }
float largestOf(Strip s) {
  vec4 four = max(s.low, s.high);
  return max(max(four.x, four.y), max(four.z, four.w));
}

Strip scaled(Strip s, float factor) { return Strip(s.low * factor, s.high * factor); }
Strip sumOf(Strip a, Strip b) { return Strip(a.low + b.low, a.high + b.high); }
Strip productOf(Strip a, Strip b) { return Strip(a.low * b.low, a.high * b.high); }
Strip minus(Strip a, Strip b) { return Strip(a.low - b.low, a.high - b.high); }
Strip minus(Strip a, float b) { return Strip(a.low - b, a.high - b); }

// 1 where a value is above `limit`, else 0.
Strip whereAbove(Strip s, float limit) { return Strip(vec4(greaterThan(s.low, vec4(limit))), vec4(greaterThan(s.high, vec4(limit)))); }
