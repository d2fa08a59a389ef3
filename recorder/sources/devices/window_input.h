// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <mutex>

#include "recorder/recording/device_sample.h"

namespace calot::recorder {

/// Actions while a key or button is pressed.
enum class MouseControl : std::uint8_t {
  right,
  left,
  down,
  up,
  in,         ///< deeper along the shaft
  out,        ///< back along it
  rollRight,  ///< clockwise, seen from the hand
  rollLeft,
  openJaw,
  closeJaw,
  cut,        ///< pedal
  coagulate,  ///< pedal
  fire,       ///< closes a clip
  fine,       ///< a quarter of every speed
};
inline constexpr std::size_t mouseControls = 14;

/// Mouse and keyboard input of a window, which a MouseDevice converts to samples. Thread-safe by a lock; the haptic
/// thread never calls it.
class MouseInput {
 public:
  /// Input of the device at each of its samples.
  struct Wish {
    Hand hand = Hand::right;
    std::array<double, 2> pixels{};  ///< right and down, since the last one
    double notches = 0.0;            ///< since the last one
    std::array<bool, mouseControls> held{};
    std::array<bool, handCount> locked{};
    std::array<Vec3, handCount> port{Vec3::Zero(), Vec3::Zero()};
    /// Far behind: lines of sight are parallel to the camera's axis.
    std::array<Vec3, handCount> eye{Vec3(0.0, 0.0, -1e3), Vec3(0.0, 0.0, -1e3)};

    [[nodiscard]] bool holds(MouseControl control) const { return held[static_cast<std::size_t>(control)]; }
    void dropMotion() {
      pixels = {};
      notches = 0.0;
    }
  };

  /// The pointer moved by these pixels.
  void move(double right, double down) {
    change([&](Wish& wish) { wish.pixels = {wish.pixels[0] + right, wish.pixels[1] + down}; });
  }
  /// The wheel rotated by `notches`; positive: away from the hand, deeper into the picture.
  void turnWheel(double notches) {
    change([&](Wish& wish) { wish.notches += notches; });
  }
  void hold(MouseControl control, bool held) {
    change([&](Wish& wish) { wish.held[static_cast<std::size_t>(control)] = held; });
  }
  /// Ratchet of the driven hand's grasper: locks, or lets go.
  void toggleLock() {
    change([](Wish& wish) {
      bool& locked = wish.locked[static_cast<std::size_t>(wish.hand)];
      locked = !locked;
    });
  }
  /// An attempt goes on with this hand's grasper locked, or not.
  void setLock(Hand hand, bool locked) {
    change([&](Wish& wish) { wish.locked[static_cast<std::size_t>(hand)] = locked; });
  }
  /// Passes mouse and keyboard to the other hand. The one that is left stays where and as it is, its lock
  /// too, but without pedals.
  void switchHand() {
    change([](Wish& wish) {
      wish.hand = wish.hand == Hand::right ? Hand::left : Hand::right;
      wish.dropMotion();
    });
  }
  /// Releases everything and drops pending motion: the window lost the keyboard focus.
  void release() {
    change([](Wish& wish) {
      wish.held = {};
      wish.dropMotion();
    });
  }
  /// The hand that is driven now; the right one first.
  [[nodiscard]] Hand hand() const {
    const std::lock_guard lock(mutex_);
    return wish_.hand;
  }
  /// A new attempt: the right hand, nothing held, nothing locked.
  void reset() {
    change([](Wish& wish) { wish = {.port = wish.port, .eye = wish.eye}; });
  }
  /// Position of each hand's port in D, relative to its tip's start (m): `in` and `out` move along the line from
  /// there.
  void setPorts(const std::array<Vec3, handCount>& ports) {
    change([&](Wish& wish) { wish.port = ports; });
  }
  /// Position of the endoscope's eye in D, relative to each tip's start (m): the wheel moves along the line from
  /// there.
  void setEyes(const std::array<Vec3, handCount>& eyes) {
    change([&](Wish& wish) { wish.eye = eyes; });
  }
  [[nodiscard]] Wish take() {
    Wish taken;
    change([&](Wish& wish) {
      taken = wish;
      wish.dropMotion();
    });
    return taken;
  }

 private:
  void change(const auto& how) {
    const std::lock_guard lock(mutex_);
    how(wish_);
  }

  mutable std::mutex mutex_;
  Wish wish_;
};

/// Motion of the endoscope while a key is pressed.
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
  /// The pointer moved by these pixels, with the endoscope's pedal pressed.
  void move(double right, double down);
  /// The wheel rotated by `notches`; positive: nearer.
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
