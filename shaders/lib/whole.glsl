// The whole number nearest to a float within +-2^22. The sum with 1.5 x 2^23 has it in its last bits; int() is one conversion for each lane on Mesa's
// newer software driver, ten times as dear.
const float kMostWhole = 4194304.0;
int wholeNumber(float v) {
  precise float sum = v + 12582912.0;
  return floatBitsToInt(sum) - 0x4B400000;
}
ivec2 wholeNumbers(vec2 v) { return ivec2(wholeNumber(v.x), wholeNumber(v.y)); }
