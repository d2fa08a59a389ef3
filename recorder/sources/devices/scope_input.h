// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <atomic>
#include <cstdint>

namespace calot::recorder {

/// What the endoscope does while a key is pressed.
enum class ScopeControl : std::uint8_t {
  right,  ///< looks to the right, ...
  left,
  up,
  down,
  in,  ///< nearer
  out,
  cableRight,  ///< rotates the light cable clockwise, seen from the camera head
  cableLeft,
  headRight,  ///< rotates the camera head clockwise
  headLeft,
};

/// Keys and mouse of a window for the endoscope. Lock-free: the haptic thread takes what came.
class ScopeInput {
 public:
  void hold(ScopeControl control, bool held);
  /// The pointer went by so many pixels, with the endoscope's pedal pressed.
  void move(double right, double down);
  /// The wheel rotated by so many notches; positive: nearer.
  void turnWheel(double notches);
  /// The pedal passes the mouse to the endoscope while it is pressed.
  void pressPedal(bool pressed) { pedal_ = pressed; }
  [[nodiscard]] bool pedal() const { return pedal_; }
  /// Releases everything and drops pending motion.
  void release();

  struct Wish {
    double right = 0.0, down = 0.0;  ///< pixels since the last one
    double notches = 0.0;            ///< since the last one
    std::uint32_t held = 0;          ///< bit c: ScopeControl c

    /// 1, -1, or 0 where both or none are held.
    [[nodiscard]] double between(ScopeControl plus, ScopeControl minus) const;
  };
  [[nodiscard]] Wish take();

 private:
  std::atomic<std::uint32_t> held_{0};
  std::atomic<std::int64_t> right_{0}, down_{0}, notches_{0};  ///< thousandths
  std::atomic<bool> pedal_{false};
};

}  // namespace calot::recorder
