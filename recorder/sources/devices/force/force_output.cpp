// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/force/force_output.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <utility>

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

Vec3 limited(const Vec3& v, double longest) {
  if (!v.allFinite() || !(longest > 0.0)) return Vec3::Zero();
  const double largest = v.cwiseAbs().maxCoeff();
  if (largest == 0.0) return Vec3::Zero();
  // In two steps, as the square of a huge number overflows.
  const Vec3 scaled = v / largest;
  const double length = largest * scaled.norm();
  if (length <= longest) return v;
  Vec3 out = longest * scaled.normalized();
  // Rounding may leave it longer by a bit, and the limit is exact.
  while (out.norm() > longest) out *= 1.0 - 1e-15;
  return out;
}

namespace {

constexpr double torqueShare = 1.0 / 25.0;
constexpr std::int64_t longestFall = 200'000'000;  // ns, of the force when the device is closed
constexpr double longestPeriod = 0.02;  // s; a device that was silent for longer does not make the force jump

Vec3 towards(const Vec3& from, const Vec3& to, double most) { return from + limited(to - from, most); }

// Rotation vector from one orientation to the next, in D; exact enough for the steps of a millisecond.
Vec3 rotationBetween(const Quat& from, const Quat& to) {
  Quat step = to * from.conjugate();
  if (step.w() < 0.0) step.coeffs() = -step.coeffs();
  return 2.0 * step.vec();
}

}  // namespace

ForceOutput::ForceOutput(const HandleModel& model) : model_(model), force_(model.force), torque_(model.torque) {}

void ForceOutput::command(const Wrench& wrench, std::int64_t now) {
  asked_ = {limited(wrench.force, model_.force.maxEffort), limited(wrench.torque, model_.torque.maxEffort)};
  commanded_ = now;
  any_ = true;
}

double ForceOutput::gainAfter(const HandleMeasurement& measurement, std::int64_t now, double seconds) const {
  const bool on = any_ && !released_ && measurement.valid && !measurement.clutched && now - commanded_ < silence;
  return on ? std::min(1.0, gain_ + seconds / rise) : std::max(0.0, gain_ - seconds / fall);
}

void ForceOutput::noteRoundTrip(std::uint32_t shown, std::int64_t now) {
  if (shown <= shown_ || shown > number_ || number_ - shown >= sentAt_.size()) return;
  shown_ = shown;
  statistics_.maxRoundTrip = std::max(statistics_.maxRoundTrip, now - sentAt_[shown % sentAt_.size()]);
}

Wrench ForceOutput::measured(const HandleMeasurement& measurement, std::int64_t now) {
  const auto since = [&](std::int64_t time) { return 1e-9 * static_cast<double>(measurement.deviceTime - time); };
  double seconds = model_.force.period;
  if (heard_) seconds = std::clamp(since(lastTime_), 0.0, longestPeriod);
  heard_ = true;
  lastTime_ = measurement.deviceTime;
  if (measurement.valid) {
    if (seen_) {
      force_.account(measurement.number, measurement.shown.force, measurement.position - position_, since(seenTime_));
      torque_.account(measurement.number, measurement.shown.torque,
                      rotationBetween(orientation_, measurement.orientation), since(seenTime_));
    }
    position_ = measurement.position;
    orientation_ = measurement.orientation;
    seenTime_ = measurement.deviceTime;
    seen_ = true;
  }
  noteRoundTrip(measurement.number, now);
  gain_ = gainAfter(measurement, now, seconds);
  const auto next = [&](EnergyTank& tank, const Vec3& asked, const Vec3& sent, double slew) {
    const Vec3 wanted = gain_ * asked;
    tank.settle(std::max(wanted.norm(), sent.norm()));
    const Vec3 reached = towards(sent, wanted, slew * seconds);
    // If the motion is unknown, so is its energy: the force falls.
    if (!measurement.valid) return limited(reached, sent.norm());
    const Vec3 out = limited(reached, tank.bound());
    if (out.norm() < reached.norm()) ++statistics_.softened;
    return out;
  };
  const Wrench before = sent_;
  sent_.force = next(force_, asked_.force, sent_.force, maxSlew);
  sent_.torque = next(torque_, asked_.torque, sent_.torque, torqueShare * maxSlew);
  ++number_;
  force_.sent(number_, sent_.force.norm());
  torque_.sent(number_, sent_.torque.norm());
  sentAt_[number_ % sentAt_.size()] = now;
  ++statistics_.sent;
  statistics_.maxForce = std::max(statistics_.maxForce, sent_.force.norm());
  statistics_.maxChange = std::max(statistics_.maxChange, (sent_.force - before.force).norm());
  statistics_.lowestEnergy = force_.lowest();
  return sent_;
}

void ForceOutput::lost() {
  force_.reset();
  torque_.reset();
  sent_ = {};
  gain_ = 0.0;
  seen_ = heard_ = false;
}

void ForceFeedbackDevice::setWrench(Hand hand, const Wrench& wrench) {
  auto& output = output_[static_cast<std::size_t>(hand)];
  if (output) output->command(wrench, clock_());
}

Wrench ForceFeedbackDevice::measured(std::size_t hand, const HandleMeasurement& measurement, std::int64_t now) {
  const Wrench wrench = output_[hand]->measured(measurement, now);
  const std::lock_guard<std::mutex> lock(mutex_);
  statistics_[hand] = output_[hand]->statistics();
  return wrench;
}

std::array<ForceStatistics, handCount> ForceFeedbackDevice::forceStatistics() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return statistics_;
}

void ForceFeedbackDevice::lose(const std::string& why, DeviceInput& out) {
  for (auto& output : output_) {
    if (output) output->lost();
  }
  ReopeningDevice::lose(why, out);
}

void ForceFeedbackDevice::close() {
  if (std::exchange(closed_, true)) return;
  for (auto& output : output_) {
    if (output) output->release();
  }
  const auto idle = [](const auto& output) { return !output || output->idle(); };
  const std::int64_t until = clock_() + longestFall;
  DeviceInput unread;
  while (connected() && !std::all_of(output_.begin(), output_.end(), idle) && clock_() < until)
    poll(std::chrono::milliseconds(2), unread);
  if (connected()) sayGoodbye();
  ReopeningDevice::close();
}

}  // namespace calot::recorder
