// Quaternion arithmetic without normalisation, for code that normalises once at the end of a chain. taxelsim/pose.h has the public product.
#pragma once

#include "taxelsim/pose.h"

namespace taxelsim {

// Hamilton product a b, not normalised.
inline Quaternion product(const Quaternion& a, const Quaternion& b) {
  return {a[0] * b[0] - a[1] * b[1] - a[2] * b[2] - a[3] * b[3],  //
          a[0] * b[1] + a[1] * b[0] + a[2] * b[3] - a[3] * b[2],  //
          a[0] * b[2] - a[1] * b[3] + a[2] * b[0] + a[3] * b[1],  //
          a[0] * b[3] + a[1] * b[2] - a[2] * b[1] + a[3] * b[0]};
}

// The inverse of a unit quaternion.
inline Quaternion conjugate(const Quaternion& q) {
  return {q[0], -q[1], -q[2], -q[3]};
}

}  // namespace taxelsim
