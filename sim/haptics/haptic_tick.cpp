// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/haptics/haptic_tick.h"

#include <cmath>

#include "sim/contact/complementarity.h"
#include "sim/math/floating_point.h"

namespace calot {

bool isConsistent(const ContactSet& set) {
  const std::size_t rows = set.free.size();
  return set.direction.size() == rows && set.lambda.size() == rows && set.compliance.size() == rows * rows;
}

bool isConsistent(const HapticState& state, const ContactSet& set) {
  return state.set != set.step || state.lambda.size() == set.free.size();
}

HapticForce hapticTick(const HapticModel& model, HapticState& state, const ContactSet& set) {
  const FloatingPointScope scope;
  const std::size_t rows = set.free.size();
  if (state.set != set.step) {
    state.set = set.step;
    state.lambda.assign(set.lambda.begin(), set.lambda.end());
  }
  HapticForce out;
  if (rows == 0) return out;
  // The free gaps at this tick's pose stand behind the forces in one array, which keeps its capacity.
  state.lambda.resize(2 * rows);
  const Vec3 moved = state.tip - set.reference;
  for (std::size_t i = 0; i < rows; ++i) state.lambda[rows + i] = set.free[i] + set.direction[i].dot(moved);
  const std::span<double> all(state.lambda);
  solveComplementarity(set.compliance, all.subspan(rows, rows), all.first(rows), model.tolerance, model.sweeps,
                       Finish::sweeps);
  for (std::size_t i = 0; i < rows; ++i) out.force += state.lambda[i] * set.direction[i];
  state.lambda.resize(rows);
  const double size = out.force.norm();
  if (size > model.largestForce) out.force *= model.largestForce / size;
  return out;
}

}  // namespace calot
