// The whole number nearest to a float within +-2^22. The sum with 1.5 x 2^23 has it in its last bits; int() is one conversion for each lane on Mesa's
// newer software driver, ten times as dear.
const float kMostWhole = 4194304.0;
int wholeNumber(float v) {
  precise float sum = v + 12582912.0;
  return floatBitsToInt(sum) - 0x4B400000;
}
ivec2 wholeNumbers(vec2 v) { return ivec2(wholeNumber(v.x), wholeNumber(v.y)); }

// Row and column of cell `i` of rows of so many cells. Without an integer division, which Mesa's software driver does lane by lane: (i + 1/2) / num_cols is at
// least 1 / (2 num_cols) from a whole number, more than it is rounded by as long as there are fewer than 2^20 cells.
uvec2 cellNumbered(uint i, uint num_cols) {
  uint row = uint(wholeNumber((float(int(i)) + 0.5) / float(int(num_cols)) - 0.5));
  return uvec2(row, i - row * num_cols);
}
