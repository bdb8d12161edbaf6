#version 460
#extension GL_GOOGLE_include_directive : require
// Integers and flags among the features, which kernels compute as floats, for importers of the device's memory; the host converts its own.
//
// An invocation owns a word of integer_features: an integer, or four flags.
// In:  integer_rows: the number of arrays and of their words; then the arrays in the order of their words. features: the source SOURCE.
// Out: the words of the arrays of this source.
// Shared memory: none.
// Reference: src/simulation/integer_features.h, IntegerFeatures::convert().

#include "passes/declare.glsl"
#include "passes/integer_features.h"

// Four flags from `first` on, of which the array has `count`, a byte each.
uint flagsOf(uint source, uint first, uint count) {
  uint flags = 0;
  for (uint k = first; k < min(first + 4, count); ++k) flags |= uint(features[source + k] != 0.0) << (8 * (k - first));
  return flags;
}

void main() {
  uint word = workgroupNumber() * WORKGROUP + gl_LocalInvocationIndex;
  if (word >= integer_rows[0].y) return;
  uint number = 1;
  while (number < integer_rows[0].x && word >= integer_rows[number + 1].w) ++number;
  uvec4 row = integer_rows[number];
  if (row.x % kFlags != SOURCE) return;
  uint element = word - row.w;
  integer_features[word] = row.x < kFlags ? uint(int(features[row.y + element])) : flagsOf(row.y, 4 * element, row.z);
}
