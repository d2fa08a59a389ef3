// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/window_input.h"

#include <algorithm>
#include <cmath>

namespace calot::recorder {

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
