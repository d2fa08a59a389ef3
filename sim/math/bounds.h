// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers kept on one side of zero. std::max(x, 0.0), std::min(0.0, x) and std::clamp(x, 0.0, y) say the same, but
// which zero they give of -0 and 0 is lost where clang 14 makes one instruction of them that orders the two zeros: fmax
// and fminnm on aarch64, fmin on RISC-V, f64.max on WebAssembly. The comparisons here are none that it does that with.
#pragma once

#include "sim/math/linear.h"

namespace calot {

/// x, and 0 where it is negative or no number. -0 stays -0.
[[nodiscard]] constexpr double notNegative(double x) { return x >= 0.0 ? x : 0.0; }

/// x, and 0 where it is positive or no number. -0 becomes 0.
[[nodiscard]] constexpr double notPositive(double x) { return 0.0 - notNegative(-x); }

/// Of each component.
[[nodiscard]] inline Vec3 notNegative(const Vec3& v) {
  return {notNegative(v[0]), notNegative(v[1]), notNegative(v[2])};
}

}  // namespace calot
