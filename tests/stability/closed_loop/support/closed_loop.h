// SPDX-License-Identifier: GPL-3.0-or-later
// A force device in a human hand, simulated, and the way between it and the program: delay, quanta, limits. What
// renders is the test's: a wall, or the haptic path over a scene.
#pragma once

#include <algorithm>
#include <cstdint>
#include <deque>
#include <limits>

#include "recorder/sources/devices/force/force_output.h"
#include "recorder/sources/devices/force/force_server.h"

namespace calot::test {

struct LoopSettings {
  recorder::SimulatedHandModel hand;
  int delay = 0;        ///< ms, of pose and force together
  bool passive = true;  ///< through ForceOutput; false: the force as it is, within the device's limit
};

inline recorder::HandleModel handleOf(const recorder::SimulatedHandModel& hand) {
  recorder::HandleModel out;
  out.force = {hand.maxForce, hand.deviceDamping, hand.deviceFriction, hand.encoderQuantum, 0.001};
  return out;
}

/// Runs in ticks of a millisecond: position() is what the program knows, tick() gives it the force for that.
class ClosedLoop {
 public:
  explicit ClosedLoop(const LoopSettings& settings)
      : settings_(settings), hand_(settings.hand, Vec3::Zero()), output_(handleOf(settings.hand)) {
    up_.assign(static_cast<std::size_t>(settings.delay - settings.delay / 2), measure());
    down_.assign(static_cast<std::size_t>(settings.delay / 2), Command{});
  }

  /// Position of the handle that the program knows now (m).
  [[nodiscard]] Vec3 position() const { return up_.empty() ? measure().position : up_.front().position; }

  /// @param force of the program at position() @param intended by the arm
  void tick(const Vec3& force, const Vec3& intended) {
    up_.push_back(measure());
    recorder::HandleMeasurement known = up_.front();
    up_.pop_front();
    known.clutched = clutched;
    known.valid = !hidden;
    const std::int64_t now = 1'000'000 * tick_;
    Command command{0, force};
    if (settings_.passive) {
      if (!silent) output_.command({force, Vec3::Zero()}, now);
      command.force = output_.measured(known, now).force;
      command.number = output_.number();
    }
    maxSent = std::max(maxSent, command.force.norm());
    maxChange = std::max(maxChange, (command.force - lastSent_).norm());
    lastSent_ = command.force;
    down_.push_back(command);
    now_ = down_.front();
    down_.pop_front();
    shown_ = hand_.motorForce(now_.force);
    hand_.advance(0.001, shown_, intended);
    maxShown = std::max(maxShown, shown_.norm());
    // Beyond what the mechanism itself dissipated.
    maxGiven = std::max(maxGiven, hand_.work() - hand_.dissipated());
    ++tick_;
    if (tick_ > watchFrom) {
      const Vec3& at = hand_.position();
      lowest_ = lowest_.cwiseMin(at);
      highest_ = highest_.cwiseMax(at);
      rise_ = rise_.cwiseMax(at - lowest_);
      fall_ = fall_.cwiseMax(highest_ - at);
    }
  }

  recorder::SimulatedHand& hand() { return hand_; }
  recorder::ForceOutput& output() { return output_; }
  [[nodiscard]] const Vec3& shown() const { return shown_; }
  [[nodiscard]] const Vec3& sent() const { return lastSent_; }
  /// From one turning point to the other, since `watchFrom` (m). What only creeps to where it will rest does not swing:
  /// of each axis the lesser of the largest way up and the largest way down counts.
  [[nodiscard]] double swing() const { return rise_.cwiseMin(fall_).norm(); }
  void watch() {
    watchFrom = tick_;
    lowest_ = Vec3::Constant(std::numeric_limits<double>::infinity());
    highest_ = -lowest_;
    rise_ = fall_ = Vec3::Zero();
  }

  bool clutched = false, hidden = false, silent = false;
  std::int64_t watchFrom = 0;
  double maxSent = 0.0, maxShown = 0.0, maxChange = 0.0;
  double maxGiven = 0.0;  ///< J, net energy that came out of motors and mechanism together

 private:
  struct Command {
    std::uint32_t number = 0;
    Vec3 force = Vec3::Zero();
  };
  [[nodiscard]] recorder::HandleMeasurement measure() const {
    recorder::HandleMeasurement m;
    m.position = hand_.measured();
    m.deviceTime = 1'000'000 * tick_;
    m.number = now_.number;
    m.shown.force = shown_;
    return m;
  }

  LoopSettings settings_;
  recorder::SimulatedHand hand_;
  recorder::ForceOutput output_;
  std::deque<recorder::HandleMeasurement> up_;
  std::deque<Command> down_;
  Command now_;
  Vec3 shown_ = Vec3::Zero(), lastSent_ = Vec3::Zero();
  std::int64_t tick_ = 0;
  Vec3 lowest_ = Vec3::Constant(std::numeric_limits<double>::infinity());
  Vec3 highest_ = Vec3::Constant(-std::numeric_limits<double>::infinity());
  Vec3 rise_ = Vec3::Zero(), fall_ = Vec3::Zero();
};

/// A wall at x = 0: stiffness and damping (N/m, N s/m) where x > 0, from the positions that the program knows.
class VirtualWall {
 public:
  VirtualWall(double stiffness, double damping) : stiffness_(stiffness), damping_(damping) {}
  Vec3 force(const Vec3& position) {
    const double x = position.x();
    const double speed = (x - last_) / 0.001;
    last_ = x;
    if (x <= 0.0) return Vec3::Zero();
    return Vec3(std::min(0.0, -stiffness_ * x - damping_ * speed), 0.0, 0.0);
  }

 private:
  double stiffness_, damping_;
  double last_ = 0.0;
};

/// Nobody holds the device.
inline recorder::SimulatedHandModel letGo() {
  recorder::SimulatedHandModel out;
  out.gripStiffness = out.gripDamping = 0.0;
  return out;
}

/// A firm grip.
inline recorder::SimulatedHandModel firmGrip() {
  recorder::SimulatedHandModel out;
  out.gripStiffness = 3000.0;
  out.gripDamping = 15.0;
  out.armStiffness = 400.0;
  out.armDamping = 15.0;
  return out;
}

}  // namespace calot::test
