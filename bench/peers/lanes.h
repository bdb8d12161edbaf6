// Vectors of sixteen values: one register with AVX-512, two with AVX2, by the compiler's vector extensions. Holds only what the peers
// need.
#pragma once

#include <immintrin.h>

#include <cstdint>
#include <cstring>

namespace taxelsim::bench {

inline constexpr int kLanes = 16;

namespace lanes {
using Eight = float __attribute__((vector_size(32)));
using EightInts = std::int32_t __attribute__((vector_size(32)));
using Four = float __attribute__((vector_size(16)));
}  // namespace lanes

#if defined(__AVX512F__)

using Floats = float __attribute__((vector_size(64)));
using Ints = std::int32_t __attribute__((vector_size(64)));  // masks have all bits of a lane set or none

inline Floats all(float value) {
  return value - Floats{};
}
inline Ints all(std::int32_t value) {
  return value - Ints{};
}
// Per lane: a where the mask is set, else b.
inline Floats select(Ints mask, Floats a, Floats b) {
  return mask ? a : b;
}
inline Ints select(Ints mask, Ints a, Ints b) {
  return mask ? a : b;
}
inline void setLane(Floats& v, std::size_t lane, float value) {
  v[lane] = value;
}
inline Floats toFloats(Ints v) {
  return __builtin_convertvector(v, Floats);
}
// Truncates towards 0; |v| < 2^31.
inline Ints toInts(Floats v) {
  return __builtin_convertvector(v, Ints);
}
inline Ints floorOf(Floats v) {
  return reinterpret_cast<Ints>(_mm512_cvt_roundps_epi32(reinterpret_cast<__m512>(v), _MM_FROUND_TO_NEG_INF | _MM_FROUND_NO_EXC));
}
inline Ints ceilOf(Floats v) {
  return reinterpret_cast<Ints>(_mm512_cvt_roundps_epi32(reinterpret_cast<__m512>(v), _MM_FROUND_TO_POS_INF | _MM_FROUND_NO_EXC));
}
inline Floats rootOf(Floats v) {
  return reinterpret_cast<Floats>(_mm512_sqrt_ps(reinterpret_cast<__m512>(v)));
}
// Bit k of the result: lane k of the mask.
inline unsigned bitsOf(Ints mask) {
  return _mm512_cmplt_epi32_mask(reinterpret_cast<__m512i>(mask), __m512i{});
}
// The first `count` <= 16 lanes.
template <typename Vector>
void storeFirst(void* to, Vector v, int count) {
  _mm512_mask_storeu_epi32(to, static_cast<__mmask16>((1u << count) - 1), reinterpret_cast<__m512i>(v));
}

namespace lanes {
inline Eight lowOf(Floats v) {
  return __builtin_shufflevector(v, v, 0, 1, 2, 3, 4, 5, 6, 7);
}
inline Eight highOf(Floats v) {
  return __builtin_shufflevector(v, v, 8, 9, 10, 11, 12, 13, 14, 15);
}
}  // namespace lanes

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

#else

// Two halves with the operators of a compiler vector.
template <typename Half, typename Value>
struct alignas(64) Halves {
  Half low{}, high{};

  constexpr Halves() = default;
  constexpr Halves(Half a, Half b) : low(a), high(b) {}
  constexpr Halves(Value a, Value b, Value c, Value d, Value e, Value f, Value g, Value h, Value i, Value j, Value k, Value l, Value m,
                   Value n, Value o, Value p)
      : low{a, b, c, d, e, f, g, h}, high{i, j, k, l, m, n, o, p} {}

  Value operator[](std::size_t lane) const { return lane < 8 ? low[lane] : high[lane - 8]; }
  Halves operator-() const { return {-low, -high}; }
  Halves operator~() const { return {~low, ~high}; }
  Halves operator<<(int count) const { return {low << count, high << count}; }
  Halves operator>>(int count) const { return {low >> count, high >> count}; }
};
using Floats = Halves<lanes::Eight, float>;
using Ints = Halves<lanes::EightInts, std::int32_t>;  // masks have all bits of a lane set or none

#define TAXELSIM_LANES(operation, Result, Vector, Value)               \
  inline Result operator operation(const Vector& a, const Vector& b) { \
    return {a.low operation b.low, a.high operation b.high};           \
  }                                                                    \
  inline Result operator operation(const Vector& a, Value b) {         \
    return {a.low operation b, a.high operation b};                    \
  }                                                                    \
  inline Result operator operation(Value a, const Vector& b) {         \
    return {a operation b.low, a operation b.high};                    \
  }
#define TAXELSIM_LANES_AND_ASSIGN(operation, Vector, Value)          \
  TAXELSIM_LANES(operation, Vector, Vector, Value)                   \
  inline Vector& operator operation##=(Vector& a, const Vector& b) { \
    return a = a operation b;                                        \
  }
TAXELSIM_LANES_AND_ASSIGN(+, Floats, float)
TAXELSIM_LANES_AND_ASSIGN(-, Floats, float)
TAXELSIM_LANES_AND_ASSIGN(*, Floats, float)
TAXELSIM_LANES_AND_ASSIGN(/, Floats, float)
TAXELSIM_LANES_AND_ASSIGN(+, Ints, std::int32_t)
TAXELSIM_LANES_AND_ASSIGN(-, Ints, std::int32_t)
TAXELSIM_LANES_AND_ASSIGN(*, Ints, std::int32_t)
TAXELSIM_LANES_AND_ASSIGN(&, Ints, std::int32_t)
TAXELSIM_LANES_AND_ASSIGN(|, Ints, std::int32_t)
TAXELSIM_LANES(<, Ints, Floats, float)
TAXELSIM_LANES(>, Ints, Floats, float)
TAXELSIM_LANES(<=, Ints, Floats, float)
TAXELSIM_LANES(>=, Ints, Floats, float)
TAXELSIM_LANES(<, Ints, Ints, std::int32_t)
TAXELSIM_LANES(>, Ints, Ints, std::int32_t)
TAXELSIM_LANES(<=, Ints, Ints, std::int32_t)
TAXELSIM_LANES(>=, Ints, Ints, std::int32_t)
#undef TAXELSIM_LANES_AND_ASSIGN
#undef TAXELSIM_LANES

inline Floats all(float value) {
  return value - Floats();
}
inline Ints all(std::int32_t value) {
  return value - Ints();
}
inline Floats select(const Ints& mask, const Floats& a, const Floats& b) {
  return {mask.low ? a.low : b.low, mask.high ? a.high : b.high};
}
inline Ints select(const Ints& mask, const Ints& a, const Ints& b) {
  return {mask.low ? a.low : b.low, mask.high ? a.high : b.high};
}
inline void setLane(Floats& v, std::size_t lane, float value) {
  (lane < 8 ? v.low : v.high)[lane % 8] = value;
}
inline Floats toFloats(const Ints& v) {
  return {__builtin_convertvector(v.low, lanes::Eight), __builtin_convertvector(v.high, lanes::Eight)};
}
inline Ints toInts(const Floats& v) {
  return {__builtin_convertvector(v.low, lanes::EightInts), __builtin_convertvector(v.high, lanes::EightInts)};
}
inline Ints floorOf(const Floats& v) {
  const Ints t = toInts(v);
  return t + (toFloats(t) > v);
}
inline Ints ceilOf(const Floats& v) {
  const Ints t = toInts(v);
  return t - (toFloats(t) < v);
}
inline Floats rootOf(Floats v) {
  for (int k = 0; k < 8; ++k) {
    v.low[k] = __builtin_sqrtf(v.low[k]);
    v.high[k] = __builtin_sqrtf(v.high[k]);
  }
  return v;
}
inline unsigned bitsOf(const Ints& mask) {
#if defined(__AVX__)
  const auto bits = [](lanes::EightInts half) { return static_cast<unsigned>(_mm256_movemask_ps(reinterpret_cast<__m256>(half))); };
  return bits(mask.low) | bits(mask.high) << 8;
#else
  unsigned bits = 0;
  for (std::size_t k = 0; k < kLanes; ++k) bits |= static_cast<unsigned>(mask[k] & 1) << k;
  return bits;
#endif
}
template <typename Vector>
void storeFirst(void* to, const Vector& v, int count) {
  std::memcpy(to, &v, static_cast<std::size_t>(count) * 4);
}

namespace lanes {
inline Eight lowOf(const Floats& v) {
  return v.low;
}
inline Eight highOf(const Floats& v) {
  return v.high;
}
}  // namespace lanes

#endif

inline Floats load(const float* from) {
  Floats v;
  std::memcpy(static_cast<void*>(&v), from, sizeof v);
  return v;
}
inline void store(float* to, const Floats& v) {
  std::memcpy(to, &v, sizeof v);
}
inline Floats smaller(const Floats& a, const Floats& b) {
  return select(a < b, a, b);
}
inline Floats larger(const Floats& a, const Floats& b) {
  return select(a > b, a, b);
}
inline Ints smaller(const Ints& a, const Ints& b) {
  return select(a < b, a, b);
}
inline Ints larger(const Ints& a, const Ints& b) {
  return select(a > b, a, b);
}

namespace lanes {
template <typename Combine>
float reduce(const Floats& v, Combine combine) {
  const Eight e = combine(lowOf(v), highOf(v));
  const Four f = combine(__builtin_shufflevector(e, e, 0, 1, 2, 3), __builtin_shufflevector(e, e, 4, 5, 6, 7));
  const Four g = combine(f, __builtin_shufflevector(f, f, 2, 3, 0, 1));
  return combine(g, __builtin_shufflevector(g, g, 1, 0, 3, 2))[0];
}
}  // namespace lanes

inline float sumOf(const Floats& v) {
  return lanes::reduce(v, [](auto a, auto b) { return a + b; });
}
inline float smallestOf(const Floats& v) {
  return lanes::reduce(v, [](auto a, auto b) { return a < b ? a : b; });
}
inline float largestOf(const Floats& v) {
  return lanes::reduce(v, [](auto a, auto b) { return a > b ? a : b; });
}

#if !defined(__AVX512F__)
inline Floats sumsOf(const Floats (&v)[kLanes]) {
  float sums[kLanes];
  for (int k = 0; k < kLanes; ++k) sums[k] = sumOf(v[k]);
  return load(sums);
}
#endif

}  // namespace taxelsim::bench
