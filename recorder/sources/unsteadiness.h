// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>

#include "sim/math/linear.h"
#include "sim/math/random.h"

namespace calot::recorder {

/// Movement about the planned tip: a sum of sines with frequencies and phases drawn once.
class Unsteadiness {
 public:
  Unsteadiness() = default;
  /// @param amplitude root mean square of each axis (m). @param lower, upper band (Hz).
  Unsteadiness(double amplitude, double lower, double upper, Random& random);
  [[nodiscard]] Vec3 at(double time) const;

 private:
  static constexpr std::size_t sines = 4;
  double amplitude_ = 0.0;
  std::array<std::array<double, sines>, 3> omega_{}, phase_{};
};

}  // namespace calot::recorder
