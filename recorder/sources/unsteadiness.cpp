// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/unsteadiness.h"

#include <cmath>

#include "sim/math/elementary.h"

namespace calot::recorder {
namespace {

constexpr double twoPi = 6.283185307179586;

}  // namespace

Unsteadiness::Unsteadiness(double amplitude, double lower, double upper, Random& random)
    : amplitude_(amplitude * std::sqrt(2.0 / static_cast<double>(sines))) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t i = 0; i < sines; ++i) {
      omega_[axis][i] = twoPi * random.uniform(lower, upper);
      phase_[axis][i] = twoPi * random.uniform();
    }
  }
}

Vec3 Unsteadiness::at(double time) const {
  Vec3 sum = Vec3::Zero();
  if (amplitude_ == 0.0) return sum;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    double total = 0.0;
    for (std::size_t i = 0; i < sines; ++i) total += sine(omega_[axis][i] * time + phase_[axis][i]);
    sum[static_cast<Eigen::Index>(axis)] = amplitude_ * total;
  }
  return sum;
}

}  // namespace calot::recorder
