// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

namespace calot {

/// Sets the floating-point environment of the determinism contract (round to nearest, no flush-to-zero, no
/// denormals-are-zero, exceptions masked) for a scope and restores the previous one, since any library of the process
/// may have changed it. `step`, the haptic tick and every worker task use one.
class FloatingPointScope {
 public:
  FloatingPointScope();
  ~FloatingPointScope();
  FloatingPointScope(const FloatingPointScope&) = delete;
  FloatingPointScope& operator=(const FloatingPointScope&) = delete;

 private:
  std::uint64_t saved_;
};

}  // namespace calot
