// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "recorder/sources/scope/endoscope.h"

namespace calot::recorder {

/// Moves an endoscope towards where it is wished: each joint as a critically damped spring would, no faster than its
/// greatest speed, within its limits.
class ScopeMotion {
 public:
  static constexpr double frequency = 8.0;        ///< of the springs (rad/s): a step is over in 0.7 s
  static constexpr double maxSwingSpeed = 0.6;    ///< pan and tilt (rad/s)
  static constexpr double maxInsertSpeed = 0.08;  ///< m/s
  static constexpr double maxRotateSpeed = 1.5;   ///< light cable and camera head (rad/s)

  void setOut(const ScopeJoints& joints) {
    joints_ = joints;
    speed_ = {};
  }
  /// Advances by one tick.
  void advance(const ScopeJoints& wish);
  [[nodiscard]] const ScopeJoints& joints() const { return joints_; }

 private:
  ScopeJoints joints_;
  ScopeJoints speed_;  ///< 1/s
};

}  // namespace calot::recorder
