// SPDX-License-Identifier: GPL-3.0-or-later
// Vectors by name, for kernels (lanes.h) whose loops the compiler takes lane by lane when left to itself: where one
// loop stands in another, or what a lane does is long. Operators act on each number as they would on it alone, so that
// the bits are those of the loop. Passed by reference, for by value they would follow another calling convention where
// the machine is not known to have registers as wide.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>

#include "sim/math/lanes.h"

namespace calot {

#define CALOT_INLINE inline __attribute__((always_inline))  // into the clones of the kernels

using FourFloats = float __attribute__((vector_size(4 * sizeof(float))));
using EightFloats = float __attribute__((vector_size(laneCount * sizeof(float))));
using EightInts = std::int32_t __attribute__((vector_size(laneCount * sizeof(std::int32_t))));
/// As wide as most machines' registers: wider ones would be spilled.
using FourDoubles = double __attribute__((vector_size(4 * sizeof(double))));
using EightDoubles = double __attribute__((vector_size(laneCount * sizeof(double))));

template <class Vector, class Number>
CALOT_INLINE void readVector(const Number* at, Vector& out) {
  std::memcpy(&out, at, sizeof out);
}

template <class Vector, class Number>
CALOT_INLINE void writeVector(const Vector& v, Number* at) {
  std::memcpy(at, &v, sizeof v);
}

/// v = its root.
CALOT_INLINE void takeRoot(FourDoubles& v) {
  double number[4];
  writeVector(v, number);
  for (double& x : number) x = std::sqrt(x);
  readVector(number, v);
}

}  // namespace calot
