// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/floating_point.h"

#if defined(__x86_64__)
#include <xmmintrin.h>
#endif

namespace calot {

#if defined(__x86_64__)
namespace {
constexpr unsigned defaultControl = 0x1F80;  // all exceptions masked, round to nearest, FTZ and DAZ off
}
FloatingPointScope::FloatingPointScope() : saved_(_mm_getcsr()) { _mm_setcsr(defaultControl); }
FloatingPointScope::~FloatingPointScope() { _mm_setcsr(static_cast<unsigned>(saved_)); }
#elif defined(__aarch64__)
FloatingPointScope::FloatingPointScope() : saved_(0) {
  asm volatile("mrs %0, fpcr" : "=r"(saved_));
  asm volatile("msr fpcr, %0" : : "r"(std::uint64_t{0}));
}
FloatingPointScope::~FloatingPointScope() { asm volatile("msr fpcr, %0" : : "r"(saved_)); }
#else
#error "The floating-point environment of this architecture is not known to the determinism contract."
#endif

}  // namespace calot
