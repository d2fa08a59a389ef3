// SPDX-License-Identifier: GPL-3.0-or-later
// Explicit vector types for kernels that the compiler does not vectorise by itself: nested loops or long
// bodies. Operators act elementwise, so that the bits equal those of a scalar loop. Vectors are passed by reference: by
// value, the calling convention would depend on the register width of the target.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>

namespace calot {

// Kernels process a fixed number of lanes, each an independent element, whatever the machine's vector width: wider
// hardware is faster and gives the same bits. A kernel is a plain loop over the lanes with a scalar body, which the
// compiler vectorises. CALOT_LANE_KERNEL adds clones for wider machines, selected at program start.

inline constexpr int laneCount = 8;

/// Number of groups of lanes that hold `count` elements.
constexpr std::size_t laneGroups(std::size_t count) { return (count + laneCount - 1) / laneCount; }

#ifndef CALOT_VECTOR_BITS
#define CALOT_VECTOR_BITS 512  // of the widest clones (the build option of this name)
#endif
#if !defined(__x86_64__) || !defined(__OPTIMIZE__) || defined(CALOT_SANITIZED) || CALOT_VECTOR_BITS < 256
#define CALOT_LANE_KERNEL
#elif CALOT_VECTOR_BITS < 512
#define CALOT_LANE_KERNEL __attribute__((target_clones("avx2", "default")))
#else
#define CALOT_LANE_KERNEL __attribute__((target_clones("avx512f", "avx2", "default")))
#endif

#define CALOT_INLINE inline __attribute__((always_inline))  // into the clones of the kernels

using FourFloats = float __attribute__((vector_size(4 * sizeof(float))));
using EightFloats = float __attribute__((vector_size(laneCount * sizeof(float))));
using FourInts = std::int32_t __attribute__((vector_size(4 * sizeof(std::int32_t))));
using EightInts = std::int32_t __attribute__((vector_size(laneCount * sizeof(std::int32_t))));
/// The register width of most machines; wider vectors would be spilled.
using FourDoubles = double __attribute__((vector_size(4 * sizeof(double))));

// Vectors at numbers of any alignment. By memcpy, gcc 12 takes the 32 bytes of an AVX2 clone through the stack in
// halves, where the load of the whole waits for both stores. A typedef: an alias in a template loses its attributes.

template <class Vector, class Number>
CALOT_INLINE void readVector(const Number* at, Vector& out) {
  typedef Vector Loose __attribute__((aligned(alignof(Number)), may_alias));  // NOLINT(modernize-use-using)
  out = *reinterpret_cast<const Loose*>(at);
}

template <class Vector, class Number>
CALOT_INLINE void writeVector(const Vector& v, Number* at) {
  typedef Vector Loose __attribute__((aligned(alignof(Number)), may_alias));  // NOLINT(modernize-use-using)
  *reinterpret_cast<Loose*>(at) = v;
}

/// Consecutive vectors.
template <std::size_t count, class Vector, class Number>
CALOT_INLINE void readVectors(const Number* at, Vector* out) {
  for (std::size_t i = 0; i < count; ++i) readVector(at + i * (sizeof(Vector) / sizeof(Number)), out[i]);
}
template <std::size_t count, class Vector, class Number>
CALOT_INLINE void writeVectors(const Vector* v, Number* at) {
  for (std::size_t i = 0; i < count; ++i) writeVector(v[i], at + i * (sizeof(Vector) / sizeof(Number)));
}

/// Sums of eight lanes in double precision.
struct LaneSums {
  FourDoubles low{}, high{};

  CALOT_INLINE void read(const double* at) {
    readVector(at, low);
    readVector(at + 4, high);
  }
  CALOT_INLINE void write(double* at) const {
    writeVector(low, at);
    writeVector(high, at + 4);
  }
  CALOT_INLINE void addProducts(const EightFloats& a, const EightFloats& b) {
    const FourFloats lowA = __builtin_shufflevector(a, a, 0, 1, 2, 3), lowB = __builtin_shufflevector(b, b, 0, 1, 2, 3);
    const FourFloats highA = __builtin_shufflevector(a, a, 4, 5, 6, 7);
    const FourFloats highB = __builtin_shufflevector(b, b, 4, 5, 6, 7);
    low += __builtin_convertvector(lowA, FourDoubles) * __builtin_convertvector(lowB, FourDoubles);
    high += __builtin_convertvector(highA, FourDoubles) * __builtin_convertvector(highB, FourDoubles);
  }
};

/// Transposes an 8x8 matrix: element l of vector k becomes element k of vector l.
CALOT_INLINE void transpose(EightFloats (&v)[laneCount]) {
  EightFloats pair[8];
  for (std::size_t k = 0; k < 4; ++k) {
    pair[2 * k] = __builtin_shufflevector(v[2 * k], v[2 * k + 1], 0, 8, 1, 9, 4, 12, 5, 13);
    pair[2 * k + 1] = __builtin_shufflevector(v[2 * k], v[2 * k + 1], 2, 10, 3, 11, 6, 14, 7, 15);
  }
  EightFloats four[8];
  for (std::size_t k = 0; k < 2; ++k) {
    for (std::size_t i = 0; i < 2; ++i) {
      four[4 * k + 2 * i] = __builtin_shufflevector(pair[4 * k + i], pair[4 * k + 2 + i], 0, 1, 8, 9, 4, 5, 12, 13);
      four[4 * k + 2 * i + 1] =
          __builtin_shufflevector(pair[4 * k + i], pair[4 * k + 2 + i], 2, 3, 10, 11, 6, 7, 14, 15);
    }
  }
  for (std::size_t k = 0; k < 4; ++k) {
    v[k] = __builtin_shufflevector(four[k], four[4 + k], 0, 1, 2, 3, 8, 9, 10, 11);
    v[4 + k] = __builtin_shufflevector(four[k], four[4 + k], 4, 5, 6, 7, 12, 13, 14, 15);
  }
}

/// Elementwise square root.
CALOT_INLINE void squareRoot(FourDoubles& v) {
  double number[4];
  writeVector(v, number);
  for (double& x : number) x = std::sqrt(x);
  readVector(number, v);
}

}  // namespace calot
