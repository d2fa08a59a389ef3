// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>

#include "analytics/checkpoints/phases.h"
#include "sim/math/linear.h"
#include "sim/scene/step_result.h"

namespace calot::analytics {

/// How much of a quantity that only ever grows fell into one phase of the procedure.
class GrowthInPhase {
 public:
  explicit GrowthInPhase(Phase phase) : phase_(phase) {}

  /// @param total so far, after a step of the phase `now`.
  /// @param fromZero the quantity was 0 before the first step that is given; else what it was then is not known, and
  /// that step's growth is none.
  void add(Phase now, double total, bool fromZero) {
    if (!begun_) before_ = fromZero ? 0.0 : total;
    begun_ = true;
    if (now == phase_) growth_ += notNegative(total - before_);
    before_ = total;
  }
  [[nodiscard]] double growth() const { return growth_; }

 private:
  Phase phase_;
  bool begun_ = false;
  double before_ = 0.0;
  double growth_ = 0.0;
};

/// Of all organs' skins, so far (m^2, at rest).
inline double charredArea(const StepResult& result) {
  double area = 0.0;
  for (const OrganResult& organ : result.organ) area += organ.charredArea;
  return area;
}

}  // namespace calot::analytics
