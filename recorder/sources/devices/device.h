// SPDX-License-Identifier: GPL-3.0-or-later
// What a trainee holds: the interface between a driver and the source of samples. Frame D is the device's own; a
// mapping (device_mapping.h) lays it into the scene. Lengths are metres, angles radians, times nanoseconds.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "recorder/device_sample.h"
#include "recorder/identity.h"
#include "sim/math/linear.h"
#include "sim/scene/samples.h"

namespace calot::recorder {

/// Once a device is open its faults are events, not exceptions: it may vanish at any moment and come back.
struct DeviceEvent {
  enum class Kind : std::uint8_t {
    connected,
    disconnected,
    malformed,  ///< something was received that is no sample; told once for each kind of fault and connection
    status,     ///< the device says something of itself
  };
  Kind kind = Kind::status;
  std::int64_t hostTime = 0;  ///< ns
  std::string text;           ///< one line
};

/// What one poll brought, in the order of arrival.
struct DeviceInput {
  std::vector<DeviceSample> samples;
  std::vector<DeviceEvent> events;
};

struct DeviceCapabilities {
  int hands = 1;  ///< that it can drive at the same time
  int sensedRotations = 3;
  bool sensesGripper = false;
  int actuated = 0;               ///< degrees of freedom with a motor; 0: it shows no force
  double largestForce = 0.0;      ///< N, each hand
  double largestTorque = 0.0;     ///< N m
  std::array<Vec3, 2> workspace;  ///< lower and upper corner in D (m); both zero: without bounds
  double rate = 0.0;              ///< nominal, samples a second and hand; 0: the sender decides
  bool realTime = true;           ///< false: its clock is the tick clock, so that a run is the same every time
  bool absolute = true;           ///< false: its frame begins where the device was when it was opened

  DeviceCapabilities() { workspace.fill(Vec3::Zero()); }
};

struct DeviceInfo {
  std::string name;      ///< class: gamepad, openigtlink, null, scripted; what attempts are compared by
  std::string identity;  ///< which one of its class: what a calibration belongs to
  std::string detail;    ///< for people
  /// Who acts through it: human where a person may; what plays a script is a performer, what plays a motion file that.
  OperatorKind operatorKind = OperatorKind::human;
  std::string sourceFile;    ///< script or motion file, base name; or empty
  std::string sourceSha256;  ///< of its bytes
  DeviceCapabilities capabilities;
};

/// Force on the operator's hand, in D.
struct Wrench {
  Vec3 force = Vec3::Zero();   ///< N
  Vec3 torque = Vec3::Zero();  ///< N m
};

/// Host's monotonic clock in nanoseconds; tests and devices without real time bring their own.
using DeviceClock = std::function<std::int64_t()>;
std::int64_t monotonicNanoseconds();

/// A device that is open. One thread at a time may call it. Nothing here throws.
class Device {
 public:
  Device() = default;
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;
  virtual ~Device() = default;

  [[nodiscard]] virtual const DeviceInfo& info() const = 0;

  /// Appends what came in. Also connects, and connects again after a loss.
  /// @param wait blocks at most so long for the first new sample; 0: not at all.
  virtual void poll(std::chrono::nanoseconds wait, DeviceInput& out) = 0;

  /// There and answering.
  [[nodiscard]] virtual bool connected() const = 0;

  /// Its motion has come to its end (scripts).
  [[nodiscard]] virtual bool ended() const { return false; }

  /// What the hand shall feel; the device clamps it to what it can do, and lets go when no call came for 50 ms.
  /// A device without motors ignores it.
  virtual void setWrench(Hand, const Wrench&) {}

  /// Lets go of everything; further polls bring nothing.
  virtual void close() = 0;
};

}  // namespace calot::recorder
