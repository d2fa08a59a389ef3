// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "recorder/sources/devices/device.h"
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
class MouseDevice final : public Device {
 public:
  /// @param input what the window writes to; not null
  explicit MouseDevice(std::shared_ptr<MouseInput> input, DeviceClock clock = monotonicNanoseconds);

  [[nodiscard]] const DeviceInfo& info() const override { return info_; }
  void poll(std::chrono::nanoseconds wait, DeviceInput& out) override;
  [[nodiscard]] bool connected() const override { return open_; }
  void close() override { open_ = false; }

 private:
  struct Pointer {
    Vec3 position = Vec3::Zero();  ///< of the tip, from where it began, in D (m)
    double roll = 0.0, jaw = 0.0;
    double right = 0.0, down = 0.0, in = 0.0, away = 0.0;  ///< asked for and not yet done (m)
    std::uint64_t sequence = 0;
  };
  void advance(Pointer& pointer, const MouseInput::Wish& wish, double seconds);
  void put(Hand hand, const MouseInput::Wish& wish, std::uint8_t momentary, std::int64_t now, DeviceInput& out);

  std::shared_ptr<MouseInput> input_;
  DeviceInfo info_;
  DeviceClock clock_;
  std::array<Pointer, handCount> pointer_;
  Hand hand_ = Hand::right;
  std::int64_t last_ = 0;         ///< time of the last sample (ns)
  std::int64_t lastResting_ = 0;  ///< of the hand that holds
  bool open_ = true, greeted_ = false;
};

extern const DeviceKind mouseKind;

/// A mouse of its own for one hand, read from the kernel (evdev) and grabbed: the system's pointer does not move with
/// it. So two mice drive two hands at once.
///
/// D is x right, y down, z away. The mouse moves the tip right and down, 0.15 mm a count; the wheel along the shaft, 3
/// mm a notch; a tilting wheel rolls, 0.1 rad a notch. The left button closes the jaw and the right one opens it,
/// at 1.8 rad/s; the middle one cuts, or fires a clip; the side ones coagulate and lock. No motion is faster than 0.5
/// m/s: the tip catches up with the mouse later. 250 samples a second.
class EvdevMouse final : public Device {
 public:
  /// @param which "0", "1", ...: the n-th mouse that there is; a part of its name; or a path ("/dev/input/event5")
  /// @throws Error (failure) where it is not there or may not be read.
  EvdevMouse(std::string which, Hand hand, DeviceClock clock = monotonicNanoseconds);
  ~EvdevMouse() override;

  [[nodiscard]] const DeviceInfo& info() const override { return info_; }
  void poll(std::chrono::nanoseconds wait, DeviceInput& out) override;
  [[nodiscard]] bool connected() const override { return descriptor_ >= 0; }
  void close() override;

 private:
  /// @returns what is wrong, or an empty text
  std::string open();
  void read();
  void take(std::uint16_t type, std::uint16_t code, std::int32_t value);
  void advance(double seconds);

  std::string which_;
  std::string name_;  ///< as the kernel has it: the one that may come back
  Hand hand_;
  DeviceInfo info_;
  DeviceClock clock_;
  std::filesystem::path path_;  ///< of the one that was opened: after a loss it is looked for by name or number again
  int descriptor_ = -1;
  bool lost_ = false, skipping_ = false, open_ = true, greeted_ = false;
  std::array<bool, 8> held_{};                  ///< buttons from BTN_MOUSE on
  double right_ = 0.0, down_ = 0.0, in_ = 0.0;  ///< asked for and not yet done (m)
  Vec3 position_ = Vec3::Zero();
  double roll_ = 0.0, jaw_ = 0.0;
  std::uint64_t sequence_ = 0;
  std::int64_t last_ = 0;
  std::int64_t nextAttempt_ = 0;
};

struct ListedMouse {
  std::filesystem::path path;
  std::string name;
};

/// Mice that the kernel has and that may be read, in the order of their numbers.
std::vector<ListedMouse> listMice();

}  // namespace calot::recorder
