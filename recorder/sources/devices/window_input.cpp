// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/window_input.h"

#include <algorithm>
#include <cmath>

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

namespace {

constexpr double parts = 1000.0;
constexpr double maxMotion = 1e6;  // of one event

std::int64_t partsOf(double value) {
  return std::isfinite(value) ? std::llround(parts * std::clamp(value, -maxMotion, maxMotion)) : 0;
}

std::uint32_t bitOf(ScopeControl control) { return 1U << static_cast<unsigned>(control); }

}  // namespace

void ScopeInput::hold(ScopeControl control, bool held) {
  if (held)
    held_.fetch_or(bitOf(control));
  else
    held_.fetch_and(~bitOf(control));
}

void ScopeInput::move(double right, double down) {
  right_ += partsOf(right);
  down_ += partsOf(down);
}

void ScopeInput::turnWheel(double notches) { notches_ += partsOf(notches); }

void ScopeInput::release() {
  held_ = 0;
  right_ = down_ = notches_ = 0;
  pedal_ = false;
}

double ScopeInput::Wish::between(ScopeControl plus, ScopeControl minus) const {
  return ((held & bitOf(plus)) != 0 ? 1.0 : 0.0) - ((held & bitOf(minus)) != 0 ? 1.0 : 0.0);
}

ScopeInput::Wish ScopeInput::take() {
  return {static_cast<double>(right_.exchange(0)) / parts, static_cast<double>(down_.exchange(0)) / parts,
          static_cast<double>(notches_.exchange(0)) / parts, held_.load()};
}

}  // namespace calot::recorder
