// Roundings of floats to integers, divisions of small integers and logical operations in constants, in the form that software drivers need.
#ifndef DRIVER_ARITHMETIC_GLSL
#define DRIVER_ARITHMETIC_GLSL
// Logical operations in constants from which others follow. Mesa 22.3 builds no pipeline with "||" or "&&" in such an expression.
#define EITHER(a, b) ((uint(a) | uint(b)) != 0u)
#define BOTH(a, b) ((uint(a) & uint(b)) != 0u)

// The integer nearest to a float within +-2^22, from the last bits of the sum with 1.5 x 2^23, which is exact (module.cmake). On Mesa's
// newer software driver int() costs ten times as much.
const float kMostWhole = 4194304.0;
int wholeNumber(float v) {
  float sum = v + 12582912.0;
  return floatBitsToInt(sum) - 0x4B400000;
}
ivec2 wholeNumbers(vec2 v) { return ivec2(wholeNumber(v.x), wholeNumber(v.y)); }

// Row and column of cell `i` in rows of num_cols cells, without an integer division: (i + 1/2) / num_cols is at least 1 / (2 num_cols) from
// an integer, more than rounding as long as there are fewer than 2^20 cells.
uvec2 cellNumbered(uint i, uint num_cols) {
  uint row = uint(wholeNumber((float(int(i)) + 0.5) / float(int(num_cols)) - 0.5));
  return uvec2(row, i - row * num_cols);
}

// `rectangle`: first row, end row, first col, end col.
bool isInside(uvec2 cell, uvec4 rectangle) { return all(greaterThanEqual(cell, rectangle.xz)) && all(lessThan(cell, rectangle.yw)); }
#endif
