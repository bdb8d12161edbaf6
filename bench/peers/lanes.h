// Sixteen values at once, by the compiler's vector extensions: one register with AVX-512, two with AVX2, more with less. Not a library:
// what the peers need.
#pragma once

#include <immintrin.h>

#include <cstdint>
#include <cstring>

namespace taxelsim::bench {

inline constexpr int kLanes = 16;
using Floats = float __attribute__((vector_size(64)));
using Ints = std::int32_t __attribute__((vector_size(64)));  // as a mask: all bits or none

inline Floats all(float value) {
  return value - Floats{};
}
inline Ints all(std::int32_t value) {
  return value - Ints{};
}
inline Floats load(const float* from) {
  Floats v;
  std::memcpy(&v, from, sizeof v);
  return v;
}
inline void store(float* to, Floats v) {
  std::memcpy(to, &v, sizeof v);
}
inline Floats smaller(Floats a, Floats b) {
  return a < b ? a : b;
}
inline Floats larger(Floats a, Floats b) {
  return a > b ? a : b;
}
inline Ints smaller(Ints a, Ints b) {
  return a < b ? a : b;
}
inline Ints larger(Ints a, Ints b) {
  return a > b ? a : b;
}
inline Floats toFloats(Ints v) {
  return __builtin_convertvector(v, Floats);
}
// Towards 0; |v| < 2^31.
inline Ints toInts(Floats v) {
  return __builtin_convertvector(v, Ints);
}
inline Ints floorOf(Floats v) {
#if defined(__AVX512F__)
  return reinterpret_cast<Ints>(_mm512_cvt_roundps_epi32(reinterpret_cast<__m512>(v), _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC));
#else
  const Ints t = toInts(v);
  return t + (toFloats(t) > v);
#endif
}
inline Ints ceilOf(Floats v) {
#if defined(__AVX512F__)
  return reinterpret_cast<Ints>(_mm512_cvt_roundps_epi32(reinterpret_cast<__m512>(v), _MM_FROUND_TO_POS_INF | _MM_FROUND_NO_EXC));
#else
  const Ints t = toInts(v);
  return t - (toFloats(t) < v);
#endif
}
inline Floats rootOf(Floats v) {
#if defined(__AVX512F__)
  return reinterpret_cast<Floats>(_mm512_sqrt_ps(reinterpret_cast<__m512>(v)));
#else
  for (int k = 0; k < kLanes; ++k) v[k] = __builtin_sqrtf(v[k]);
  return v;
#endif
}

// Bit k of the result: lane k of the mask.
inline unsigned bitsOf(Ints mask) {
#if defined(__AVX512F__) && defined(__AVX512DQ__)
  return _mm512_movepi32_mask(reinterpret_cast<__m512i>(mask));
#elif defined(__AVX2__)
  __m256 low, high;
  std::memcpy(&low, &mask, sizeof low);
  std::memcpy(&high, reinterpret_cast<const char*>(&mask) + sizeof low, sizeof high);
  return static_cast<unsigned>(_mm256_movemask_ps(low)) | static_cast<unsigned>(_mm256_movemask_ps(high)) << 8;
#else
  unsigned bits = 0;
  for (int k = 0; k < kLanes; ++k) bits |= static_cast<unsigned>(mask[k] & 1) << k;
  return bits;
#endif
}

// The first `count` <= 16 lanes.
template <typename Vector>
void storeFirst(void* to, Vector v, int count) {
  static_assert(sizeof(Vector) == 64);
#if defined(__AVX512F__)
  _mm512_mask_storeu_epi32(to, static_cast<__mmask16>((1u << count) - 1), reinterpret_cast<__m512i>(v));
#else
  std::memcpy(to, &v, static_cast<std::size_t>(count) * 4);
#endif
}

namespace lanes {
using Eight = float __attribute__((vector_size(32)));
using Four = float __attribute__((vector_size(16)));

template <typename Combine>
float reduce(Floats v, Combine combine) {
  const Eight e =
      combine(__builtin_shufflevector(v, v, 0, 1, 2, 3, 4, 5, 6, 7), __builtin_shufflevector(v, v, 8, 9, 10, 11, 12, 13, 14, 15));
  const Four f = combine(__builtin_shufflevector(e, e, 0, 1, 2, 3), __builtin_shufflevector(e, e, 4, 5, 6, 7));
  const Four g = combine(f, __builtin_shufflevector(f, f, 2, 3, 0, 1));
  return combine(g, __builtin_shufflevector(g, g, 1, 0, 3, 2))[0];
}
}  // namespace lanes

inline float sumOf(Floats v) {
  return lanes::reduce(v, [](auto a, auto b) { return a + b; });
}
inline float smallestOf(Floats v) {
  return lanes::reduce(v, [](auto a, auto b) { return a < b ? a : b; });
}
inline float largestOf(Floats v) {
  return lanes::reduce(v, [](auto a, auto b) { return a > b ? a : b; });
}

// Lane k of the result: the sum of vector k.
inline Floats sumsOf(const Floats (&v)[kLanes]) {
  Floats a[8], b[4], c[2];
  for (int k = 0; k < 8; ++k) {
    a[k] = __builtin_shufflevector(v[2 * k], v[2 * k + 1], 0, 1, 2, 3, 4, 5, 6, 7, 16, 17, 18, 19, 20, 21, 22, 23) +
           __builtin_shufflevector(v[2 * k], v[2 * k + 1], 8, 9, 10, 11, 12, 13, 14, 15, 24, 25, 26, 27, 28, 29, 30, 31);
  }
  for (int k = 0; k < 4; ++k) {
    b[k] = __builtin_shufflevector(a[2 * k], a[2 * k + 1], 0, 1, 2, 3, 8, 9, 10, 11, 16, 17, 18, 19, 24, 25, 26, 27) +
           __builtin_shufflevector(a[2 * k], a[2 * k + 1], 4, 5, 6, 7, 12, 13, 14, 15, 20, 21, 22, 23, 28, 29, 30, 31);
  }
  for (int k = 0; k < 2; ++k) {
    c[k] = __builtin_shufflevector(b[2 * k], b[2 * k + 1], 0, 1, 4, 5, 8, 9, 12, 13, 16, 17, 20, 21, 24, 25, 28, 29) +
           __builtin_shufflevector(b[2 * k], b[2 * k + 1], 2, 3, 6, 7, 10, 11, 14, 15, 18, 19, 22, 23, 26, 27, 30, 31);
  }
  return __builtin_shufflevector(c[0], c[1], 0, 2, 4, 6, 8, 10, 12, 14, 16, 18, 20, 22, 24, 26, 28, 30) +
         __builtin_shufflevector(c[0], c[1], 1, 3, 5, 7, 9, 11, 13, 15, 17, 19, 21, 23, 25, 27, 29, 31);
}

}  // namespace taxelsim::bench
