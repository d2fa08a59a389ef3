// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/force/simulated_hand.h"

#include <algorithm>
#include <cmath>

namespace calot::recorder {
namespace {

constexpr double step = 2e-5;  // s

double onGrid(double value, double quantum) { return quantum > 0.0 ? quantum * std::round(value / quantum) : value; }

}  // namespace

SimulatedHand::SimulatedHand(const SimulatedHandModel& model, const Vec3& position)
    : model_(model), position_(position), hand_(position), intended_(position) {}

void SimulatedHand::advance(double seconds, const Vec3& force, const Vec3& intended) {
  const int steps = std::max(1, static_cast<int>(std::lround(seconds / step)));
  const double h = seconds / steps;
  const Vec3 start = intended_;
  const Vec3 pace = (intended - start) / seconds;
  for (int i = 1; i <= steps; ++i) {
    intended_ = start + (h * i) * pace;
    const Vec3 grip = model_.gripStiffness * (hand_ - position_) + model_.gripDamping * (handVelocity_ - velocity_);
    const Vec3 arm = model_.armStiffness * (intended_ - hand_) + model_.armDamping * (pace - handVelocity_);
    Vec3 speed = velocity_ + (h / model_.deviceMass) * (force + grip - model_.deviceDamping * velocity_);
    const double most = h * model_.deviceFriction / model_.deviceMass;
    const double size = speed.norm();
    const Vec3 slowed = size > most ? Vec3((1.0 - most / size) * speed) : Vec3(Vec3::Zero());
    const Vec3 way = h * slowed;
    dissipated_ += model_.deviceDamping * velocity_.dot(way) + model_.deviceFriction * way.norm();
    work_ += force.dot(way);
    velocity_ = slowed;
    position_ += way;
    handVelocity_ += (h / model_.armMass) * (arm - grip);
    hand_ += h * handVelocity_;
  }
  intended_ = intended;
}

Vec3 SimulatedHand::measured() const {
  Vec3 out;
  for (int k = 0; k < 3; ++k) out[k] = onGrid(position_[k], model_.encoderQuantum);
  return out;
}

Vec3 SimulatedHand::motorForce(const Vec3& command) const {
  Vec3 out = command;
  const double size = out.norm();
  if (!out.allFinite()) return Vec3::Zero();
  if (size > model_.maxForce) out *= model_.maxForce / size;
  // Towards zero, so that the limit holds.
  for (int k = 0; k < 3; ++k) {
    if (model_.motorQuantum > 0.0) out[k] = model_.motorQuantum * std::trunc(out[k] / model_.motorQuantum);
  }
  return out;
}

}  // namespace calot::recorder
