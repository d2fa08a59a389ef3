// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "recorder/sources/scope/scope_motion.h"

#include <algorithm>

namespace calot::recorder {
namespace {

void follow(double wish, double maxSpeed, double& at, double& speed) {
  constexpr double w = ScopeMotion::frequency;
  speed += tickLength * (w * w * (wish - at) - 2.0 * w * speed);
  speed = std::clamp(speed, -maxSpeed, maxSpeed);
  at += tickLength * speed;
}

}  // namespace

void ScopeMotion::advance(const ScopeJoints& wish) {
  const ScopeJoints to = Endoscope::withinLimits(wish);
  follow(to.pan, maxSwingSpeed, joints_.pan, speed_.pan);
  follow(to.tilt, maxSwingSpeed, joints_.tilt, speed_.tilt);
  follow(to.insertion, maxInsertSpeed, joints_.insertion, speed_.insertion);
  follow(to.cable, maxRotateSpeed, joints_.cable, speed_.cable);
  follow(to.head, maxRotateSpeed, joints_.head, speed_.head);
  joints_ = Endoscope::withinLimits(joints_);
}

}  // namespace calot::recorder
