// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/mouse_input.h"

namespace calot::recorder {

using Lock = std::lock_guard<std::mutex>;

void MouseInput::move(double right, double down) {
  const Lock lock(mutex_);
  wish_.pixels[0] += right;
  wish_.pixels[1] += down;
}

void MouseInput::turnWheel(double notches) {
  const Lock lock(mutex_);
  wish_.notches += notches;
}

void MouseInput::hold(MouseControl control, bool held) {
  const Lock lock(mutex_);
  wish_.held[static_cast<std::size_t>(control)] = held;
}

void MouseInput::toggleLock() {
  const Lock lock(mutex_);
  bool& locked = wish_.locked[static_cast<std::size_t>(wish_.hand)];
  locked = !locked;
}

void MouseInput::switchHand() {
  const Lock lock(mutex_);
  wish_.hand = wish_.hand == Hand::right ? Hand::left : Hand::right;
  wish_.pixels = {};
  wish_.notches = 0.0;
}

void MouseInput::release() {
  const Lock lock(mutex_);
  wish_.held = {};
  wish_.pixels = {};
  wish_.notches = 0.0;
}

Hand MouseInput::hand() const {
  const Lock lock(mutex_);
  return wish_.hand;
}

void MouseInput::reset() {
  const Lock lock(mutex_);
  Wish fresh;
  fresh.port = wish_.port;
  fresh.eye = wish_.eye;
  wish_ = fresh;
}

void MouseInput::setPorts(const std::array<Vec3, handCount>& ports) {
  const Lock lock(mutex_);
  wish_.port = ports;
}

void MouseInput::setEyes(const std::array<Vec3, handCount>& eyes) {
  const Lock lock(mutex_);
  wish_.eye = eyes;
}

MouseInput::Wish MouseInput::take() {
  const Lock lock(mutex_);
  const Wish taken = wish_;
  wish_.pixels = {};
  wish_.notches = 0.0;
  return taken;
}

}  // namespace calot::recorder
