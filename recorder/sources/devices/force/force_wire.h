// SPDX-License-Identifier: GPL-3.0-or-later
// The protocol of force devices as bytes, version 1: schemas/device.md. Both sides use it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "recorder/sources/devices/device.h"
#include "recorder/sources/devices/force/force_output.h"

namespace calot::recorder::forcewire {

inline constexpr std::uint16_t version = 1;
inline constexpr int defaultPort = 18950;
inline constexpr std::size_t maxText = 200;

/// Description of a device: its first frame.
struct Hello {
  std::uint16_t version = forcewire::version;
  std::uint8_t hands = 2;       ///< bit 0 left, bit 1 right
  std::uint32_t watchdog = 50;  ///< ms without a wrench after which its motors go off
  double rate = 1000.0;         ///< poses a second and hand
  HandleModel handle;           ///< limits, least damping and friction, quanta
  /// Lower and upper corner in D (m); both zero: without bounds.
  std::array<Vec3, 2> workspace{Vec3::Zero(), Vec3::Zero()};
  std::string name, serial;  ///< at most 63 and 31 bytes
};

struct Welcome {
  std::uint16_t version = forcewire::version;
  std::uint8_t hands = 2;  ///< that it wants
};

struct Pose {
  Hand hand = Hand::right;
  bool valid = true;
  std::uint8_t buttons = 0;
  std::uint32_t number = 0;  ///< of the wrench that was in force since the last pose; 0: none
  std::uint64_t sequence = 0;
  std::int64_t deviceTime = 0;  ///< ns
  Vec3 position = Vec3::Zero();
  Quat orientation = Quat::Identity();
  double gripper = 0.0;  ///< rad
  Wrench shown;          ///< by the motors since the last pose
};

struct WrenchFrame {
  Hand hand = Hand::right;
  std::uint32_t number = 0;     ///< 1, 2, 3, ... for each hand and connection
  std::int64_t deviceTime = 0;  ///< of the pose that it follows
  Wrench wrench;
};

struct Fault {
  std::string text;
};

struct End {};

using Frame = std::variant<Hello, Welcome, Pose, WrenchFrame, Fault, End>;

std::vector<std::byte> encode(Frame frame);

/// Parses a stream. A malformed stream is refused as a whole; the receiver checks the numbers.
class Decoder {
 public:
  /// Appends the frames that are complete. @returns false, with `fault()`, where the stream is not this protocol.
  bool take(std::span<const std::byte> bytes, std::vector<Frame>& out);
  [[nodiscard]] const std::string& fault() const { return fault_; }
  void reset();

 private:
  std::vector<std::byte> rest_;
  std::string fault_;
};

/// Does a hello make sense? @returns an empty text, or what is wrong
std::string faultOf(const Hello& hello);
/// Finite numbers, a unit quaternion, within 10 m.
bool isPose(const Pose& pose);

}  // namespace calot::recorder::forcewire
