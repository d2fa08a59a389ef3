// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/scope_device.h"

#include <utility>

#include "sim/math/elementary.h"

namespace calot::recorder {
namespace {

constexpr std::int64_t scopeTick = 1'000'000;  // ns

/// Rotation about z, of the rotation from a to b (rad).
double rollBetween(const Quat& a, const Quat& b) {
  const Quat turn = a.conjugate() * b;
  return 2.0 * arctangent2(turn.w() < 0.0 ? -turn.z() : turn.z(), turn.w() < 0.0 ? -turn.w() : turn.w());
}

}  // namespace

ScopeDevice::ScopeDevice(OpenedDevice device, bool straight)
    : device_(std::move(device)), straight_(straight), pump_(*device_.device, !device_.tickClock) {}

void ScopeDevice::setOut(const ScopeJoints& joints) {
  from_ = aim_ = joints;
  anchor_.reset();
}

void ScopeDevice::gather() {
  pump_.drain(input_);
  for (const DeviceEvent& event : input_.events) {
    if (event.kind != DeviceEvent::Kind::disconnected) continue;
    newest_.reset();
    setOut(aim_);
  }
  for (const DeviceSample& sample : input_.samples) {
    if (sample.hand == Hand::right && sample.valid) newest_ = sample;
  }
}

ScopeJoints ScopeDevice::wish(double /*time*/, const ScopeJoints& /*present*/, const TickSamples& /*hands*/) {
  gather();
  if (device_.tickClock) device_.tickClock->now += scopeTick;
  if (!newest_) return aim_;
  if (!anchor_) {
    anchor_ = newest_;
    rolled_ = 0.0;
  }
  const double turn = ((newest_->buttons & button::coagulatePedal) != 0 ? 1.0 : 0.0) -
                      ((newest_->buttons & button::cutPedal) != 0 ? 1.0 : 0.0);
  const Vec3 moved = newest_->position - anchor_->position;
  const double rolled = rollBetween(anchor_->orientation, newest_->orientation);
  // The device's rotation is counted on across half a turn.
  constexpr double half = Endoscope::maxRotation;
  double step = rolled - rolled_;
  while (step > half) step -= 2.0 * half;
  while (step < -half) step += 2.0 * half;
  rolled_ += step;
  aim_.pan = from_.pan + swingOfMetre * moved.x();
  aim_.tilt = from_.tilt - swingOfMetre * moved.y();
  aim_.insertion = from_.insertion + moved.z();
  from_.head += tickLength * headSpeed * turn;
  aim_.cable = from_.cable + (straight_ ? 0.0 : rolled_);
  aim_.head = from_.head + (straight_ ? rolled_ : 0.0);
  return aim_;
}

void ScopeDevice::rest() {
  gather();
  setOut(aim_);
}

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
