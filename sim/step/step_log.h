// SPDX-License-Identifier: GPL-3.0-or-later
// Reports of a step's stages: events and misses. Internal to this folder.
#pragma once

#include <cstddef>
#include <cstdint>

#include "sim/scene/step_result.h"

namespace calot {

/// The events and missed tolerances of the step at hand, in the order in which the stages report them.
class StepLog {
 public:
  /// Event::hand of an event that no instrument causes.
  static constexpr std::size_t noHand = 255;

  /// @param result outlives the log; its events and misses start empty.
  explicit StepLog(StepResult& result) : result_(result) {
    result_.events.clear();
    result_.misses = 0;
  }

  /// @param subject a structure, or what EventKind names. @param position p_W (m)
  void emit(EventKind kind, std::size_t hand, std::size_t subject, const Vec3& position, double value) {
    result_.events.push_back(
        {result_.step, kind, static_cast<std::uint8_t>(hand), static_cast<std::uint16_t>(subject), position, value});
  }
  /// @param tolerance a bit of calot::miss
  void miss(std::uint32_t tolerance) { result_.misses |= tolerance; }
  [[nodiscard]] bool hasMissed(std::uint32_t tolerance) const { return (result_.misses & tolerance) != 0; }

 private:
  StepResult& result_;
};

}  // namespace calot
