// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/force/energy_tank.h"

#include <algorithm>
#include <cmath>

namespace calot::recorder {
namespace {
constexpr double halfDiagonal = 0.8660254037844386;  // of a cube of side 1
}

EnergyTank::EnergyTank(const TankModel& model) : model_(model), error_(halfDiagonal * model.quantum) {
  model_.damping *= trusted;
  model_.friction *= trusted;
}

double EnergyTank::reserve(double effort) const {
  const double beyond = std::max(0.0, effort - model_.friction);
  return beyond > 0.0 ? beyond * beyond * model_.period / (4.0 * model_.damping) : 0.0;
}

void EnergyTank::account(std::uint32_t number, const Vec3& effort, const Vec3& displacement, double seconds) {
  const double certain = std::max(0.0, displacement.norm() - 2.0 * error_);
  level_ -= effort.dot(displacement);
  if (seconds > 0.0) level_ += model_.damping * certain * certain / seconds;
  level_ += model_.friction * certain;
  lowest_ = std::min(lowest_, level_);
  // The command that was in force may be held for another interval: its reserve stays until a later one is seen.
  while (count_ > 0 && flight_[first_].number < number) {
    first_ = (first_ + 1) % flight_.size();
    --count_;
  }
  reserved_ = 0.0;
  for (std::size_t i = 0; i < count_; ++i) reserved_ += flight_[(first_ + i) % flight_.size()].reserve;
}

double EnergyTank::bound() const {
  const double free = level_ - reserved_;
  if (!(free > 0.0) || count_ == flight_.size()) return 0.0;
  if (!(model_.damping > 0.0)) return std::min(model_.maxEffort, model_.friction);
  return std::min(model_.maxEffort, model_.friction + std::sqrt(4.0 * model_.damping * free / model_.period));
}

void EnergyTank::sent(std::uint32_t number, double effort) {
  if (count_ == flight_.size()) return;
  flight_[(first_ + count_) % flight_.size()] = {number, reserve(effort)};
  reserved_ += reserve(effort);
  ++count_;
}

void EnergyTank::settle(double wanted) {
  const double need = reserve(std::min(wanted, model_.maxEffort));
  level_ = std::min(level_, reserved_ + 2.0 * need + initial);
}

void EnergyTank::reset() {
  level_ = std::clamp(level_, 0.0, initial);
  reserved_ = 0.0;
  count_ = 0;
}

}  // namespace calot::recorder
