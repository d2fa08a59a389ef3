// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/scope_keys.h"

namespace calot::recorder {

void ScopeKeys::setOut(const ScopeJoints& joints) {
  aim_ = joints;
  static_cast<void>(input_->take());
}

ScopeJoints ScopeKeys::wish(double /*time*/, const ScopeJoints& /*present*/, const TickSamples& /*hands*/) {
  const ScopeInput::Wish wish = input_->take();
  const double swing = tickLength * swingSpeed, rotate = tickLength * rotateSpeed;
  aim_.pan += swing * wish.between(ScopeControl::right, ScopeControl::left) + pixelSwing * wish.right;
  aim_.tilt += swing * wish.between(ScopeControl::up, ScopeControl::down) - pixelSwing * wish.down;
  aim_.insertion +=
      tickLength * insertSpeed * wish.between(ScopeControl::in, ScopeControl::out) + notchInsert * wish.notches;
  aim_.cable += rotate * wish.between(ScopeControl::cableRight, ScopeControl::cableLeft);
  aim_.head += rotate * wish.between(ScopeControl::headRight, ScopeControl::headLeft);
  aim_ = Endoscope::withinLimits(aim_);
  return aim_;
}

}  // namespace calot::recorder
