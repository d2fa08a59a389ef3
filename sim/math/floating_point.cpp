// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/floating_point.h"

#if defined(__x86_64__) || defined(__SSE2_MATH__)
#include <xmmintrin.h>
#endif

namespace calot {

#if defined(__x86_64__) || defined(__SSE2_MATH__)
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
#elif defined(__riscv)
// Rounding to nearest is 0; there is no other mode.
FloatingPointScope::FloatingPointScope() : saved_(0) {
  asm volatile("frcsr %0" : "=r"(saved_));
  asm volatile("fscsr %0" : : "r"(std::uint64_t{0}));
}
FloatingPointScope::~FloatingPointScope() { asm volatile("fscsr %0" : : "r"(saved_)); }
#elif defined(__arm__)
// Numbers in vectors (NEON) are flushed to zero whatever the mode: compilers keep doubles out of them.
FloatingPointScope::FloatingPointScope() : saved_(0) {
  std::uint32_t control = 0;
  asm volatile("vmrs %0, fpscr" : "=r"(control));
  saved_ = control;
  asm volatile("vmsr fpscr, %0" : : "r"(std::uint32_t{0}));
}
FloatingPointScope::~FloatingPointScope() {
  asm volatile("vmsr fpscr, %0" : : "r"(static_cast<std::uint32_t>(saved_)));
}
#elif defined(__wasm__)
// WebAssembly has one environment, that of the contract.
FloatingPointScope::FloatingPointScope() : saved_(0) {}
FloatingPointScope::~FloatingPointScope() = default;
#else
#error "The floating-point environment of this architecture is not known to the determinism contract."
#endif

}  // namespace calot
