// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "recorder/base/files.h"
#include "recorder/sources/devices/pointer_device.h"
#include "recorder/sources/devices/window_input.h"

namespace calot::recorder {

/// Mouse and keyboard of a window as one pointer that drives one hand at a time.
///
/// D is x right, y down, z away. The pointer moves the tip right and down, 0.15 mm a pixel; the wheel along the line of
/// sight, 3 mm a notch, so that the tip stays where it is in the picture. Keys move at 30 mm/s to the four sides and
/// along the shaft, roll at 1.5 rad/s, open and close the jaw at 1.8 rad/s. No motion is faster than 0.5 m/s: the tip
/// catches up with the pointer later. `fine` divides all of it by four.
///
/// The hand that is driven gives 250 samples a second. The other one stays as it was left, without a pedal, and reports
/// this 50 times a second, so that it counts as measured.
class MouseDevice final : public PointerDevice {
 public:
  /// @param input what the window writes to; not null
  explicit MouseDevice(std::shared_ptr<MouseInput> input, DeviceClock clock = monotonicNanoseconds);

  [[nodiscard]] bool connected() const override { return there_; }
  void setOut(Hand hand, const HandStart& start) override;

 private:
  Pointer* pointerOf(Hand hand) override { return &pointer_[static_cast<std::size_t>(hand)]; }
  /// Motion asked for and not yet done (m).
  struct Asked {
    double right = 0.0, down = 0.0, in = 0.0, away = 0.0;
  };
  std::string find() override;
  std::string readControls() override;
  void advance(double seconds, std::int64_t now, DeviceInput& out) override;
  void disconnect() override { there_ = false; }
  void move(Pointer& pointer, double seconds);
  void put(Hand hand, std::uint8_t momentary, std::int64_t now, DeviceInput& out);

  std::shared_ptr<MouseInput> input_;
  MouseInput::Wish wish_;
  std::array<Pointer, handCount> pointer_;
  Asked asked_;  ///< of the hand that is driven
  Hand hand_ = Hand::right;
  std::int64_t lastResting_ = 0;  ///< time of the last sample of the hand that holds (ns)
  bool there_ = false;
};

extern const DeviceKind mouseKind;

/// A mouse of its own for one hand, read from the kernel (evdev) and grabbed: the system's pointer does not move with
/// it. So two mice drive two hands at once.
///
/// D is x right, y down, z away. The mouse moves the tip right and down, 0.15 mm a count; the wheel along the shaft, 3
/// mm a notch; a tilting wheel rolls, 0.1 rad a notch. The left button closes the jaw and the right one opens it,
/// at 1.8 rad/s; the middle one cuts, or fires a clip; the side ones coagulate and lock. No motion is faster than 0.5
/// m/s: the tip catches up with the mouse later. 250 samples a second.
class EvdevMouse final : public PointerDevice {
 public:
  /// @param which "0", "1", ...: the n-th mouse that there is; a part of its name; or a path ("/dev/input/event5")
  /// @throws Error (failure) where it is not there or may not be read.
  EvdevMouse(std::string which, Hand hand, DeviceClock clock = monotonicNanoseconds);

  [[nodiscard]] bool connected() const override { return descriptor_.valid(); }

 private:
  Pointer* pointerOf(Hand hand) override { return hand == hand_ ? &pointer_ : nullptr; }
  std::string find() override;
  std::string readControls() override;
  void advance(double seconds, std::int64_t now, DeviceInput& out) override;
  void disconnect() override;
  void take(std::uint16_t type, std::uint16_t code, std::int32_t value);
  [[nodiscard]] bool holds(unsigned button) const;

  std::string which_;
  std::string name_;  ///< as the kernel has it: the one that may come back
  Hand hand_;
  Descriptor descriptor_;
  bool skipping_ = false;
  std::array<bool, 8> held_{};                  ///< buttons from BTN_MOUSE on
  double right_ = 0.0, down_ = 0.0, in_ = 0.0;  ///< asked for and not yet done (m)
  Pointer pointer_;
};

struct ListedMouse {
  std::filesystem::path path;
  std::string name;
};

/// Mice that the kernel has and that may be read, in the order of their numbers.
std::vector<ListedMouse> listMice();

}  // namespace calot::recorder
