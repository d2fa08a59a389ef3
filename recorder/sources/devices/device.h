// SPDX-License-Identifier: GPL-3.0-or-later
// Input devices: the interface between a driver and the source of samples. Frame D is the device's own; a mapping
// (device_mapping.h) relates it to the scene. Lengths are metres, angles radians, times nanoseconds.
// Declaration of a kind of device. Each device's own source file defines its DeviceKind; the table in open_device.cpp
// lists them. Help texts, `calot devices`, `--device` and the trainer's menu use that table.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "recorder/base/identity.h"
#include "recorder/recording/device_sample.h"
#include "sim/math/linear.h"
#include "sim/scene/samples.h"

namespace calot::recorder {

/// Faults of an open device are events, not exceptions: it may disconnect at any time and come back.
struct DeviceEvent {
  enum class Kind : std::uint8_t {
    connected,
    disconnected,
    malformed,  ///< invalid input was received; reported once per kind of fault and connection
    status,     ///< status message of the device
  };
  Kind kind = Kind::status;
  std::int64_t hostTime = 0;  ///< ns
  std::string text;           ///< one line
};

/// Result of one poll, in the order of arrival.
struct DeviceInput {
  std::vector<DeviceSample> samples;
  std::vector<DeviceEvent> events;
};

struct DeviceCapabilities {
  int hands = 1;  ///< that it can drive at the same time
  int sensedRotations = 3;
  bool sensesGripper = false;
  int actuated = 0;        ///< degrees of freedom with a motor; 0: it shows no force
  double maxForce = 0.0;   ///< N, each hand
  double maxTorque = 0.0;  ///< N m
  /// Lower and upper corner in D (m); both zero: without bounds.
  std::array<Vec3, 2> workspace{Vec3::Zero(), Vec3::Zero()};
  double rate = 0.0;     ///< nominal, samples a second and hand; 0: the sender decides
  bool realTime = true;  ///< false: its clock is the tick clock, so that a run is the same every time
  bool absolute = true;  ///< false: its frame begins where the device was when it was opened
};

struct DeviceInfo {
  std::string name;      ///< class: gamepad, openigtlink, null, scripted; part of the comparability key
  std::string identity;  ///< identity within its class, to which a calibration belongs
  std::string detail;    ///< for people
  /// Operator: human if a person may act; performer for scripts; kinematics for motion files.
  OperatorKind operatorKind = OperatorKind::human;
  std::string sourceFile;    ///< script or motion file, base name; or empty
  std::string sourceSha256;  ///< of its bytes
  DeviceCapabilities capabilities;
};

/// How a hand was left where an attempt goes on (a branch).
struct HandStart {
  double jaw = 0.0;     ///< rad
  bool locked = false;  ///< ratchet of the grasper
};

/// Force on the operator's hand, in D.
struct Wrench {
  Vec3 force = Vec3::Zero();   ///< N
  Vec3 torque = Vec3::Zero();  ///< N m
};

/// Forces that a device was sent for one hand.
struct ForceStatistics {
  double maxForce = 0.0;          ///< N
  double maxChange = 0.0;         ///< N, from one wrench to the next
  double lowestEnergy = 0.0;      ///< J, of the tank
  std::uint64_t sent = 0;         ///< wrenches
  std::uint64_t softened = 0;     ///< of them, weaker than asked for, so that the port stays passive
  std::int64_t maxRoundTrip = 0;  ///< ns, from a wrench's sending until a pose said that it is shown
};

/// Host's monotonic clock in nanoseconds; tests and devices without real time bring their own.
using DeviceClock = std::function<std::int64_t()>;
std::int64_t monotonicNanoseconds();

/// A device that is open. One thread at a time may call it. Nothing here throws, except constructors.
class Device {
 public:
  /// @param clock that stamps samples and events
  explicit Device(DeviceClock clock = monotonicNanoseconds) : clock_(std::move(clock)) {}
  Device(const Device&) = delete;
  Device& operator=(const Device&) = delete;
  virtual ~Device() = default;

  [[nodiscard]] const DeviceInfo& info() const { return info_; }

  /// Appends what came in. Also connects, and connects again after a loss.
  /// @param wait blocks at most so long for the first new sample; 0: not at all.
  virtual void poll(std::chrono::nanoseconds wait, DeviceInput& out) = 0;

  /// Is the device connected?
  [[nodiscard]] virtual bool connected() const = 0;

  /// Has its motion ended (scripts)?
  [[nodiscard]] virtual bool ended() const { return false; }

  /// The hand sets out from here. A device that moves a jaw of its own, or that keeps a lock, goes on from this one; a
  /// device that senses them ignores it.
  virtual void setOut(Hand, const HandStart&) {}

  /// Sets the force on the hand. The device clamps it to its limits and releases it if no call arrives for 50 ms. A
  /// device without motors ignores it.
  virtual void setWrench(Hand, const Wrench&) {}

  /// Forces so far, left and right. Any thread.
  [[nodiscard]] virtual std::array<ForceStatistics, handCount> forceStatistics() const { return {}; }

  /// Closes the device; further polls return nothing.
  virtual void close() = 0;

 protected:
  void tell(DeviceEvent::Kind kind, std::string text, DeviceInput& out) const {
    out.events.push_back({kind, clock_(), std::move(text)});
  }

  DeviceInfo info_;  ///< filled by the constructor
  DeviceClock clock_;
};

/// A device that may be lost and come back: it is looked for every half second.
class ReopeningDevice : public Device {
 public:
  void poll(std::chrono::nanoseconds wait, DeviceInput& out) final;
  void close() override;

 protected:
  using Device::Device;
  /// Connects. @returns what is wrong, or an empty text
  virtual std::string connect() = 0;
  /// Reads a connected device.
  virtual void read(std::chrono::nanoseconds wait, DeviceInput& out) = 0;
  virtual void disconnect() = 0;
  /// Reports the loss of the device, and looks for it again later.
  virtual void lose(const std::string& why, DeviceInput& out);
  /// The constructor's connection. @param called name for the message @throws Error (failure)
  void connectFirst(const std::string& called);

  const char* gone_ = "unplugged";  ///< reason for a loss that nothing else explains

 private:
  std::int64_t nextAttempt_ = 0;  ///< ns
  std::string refusal_;           ///< why it is not connected, as the last event said
  bool open_ = true, greeted_ = false, welcomed_ = false;
};

struct Calibration;

/// The clock of a device without real time: a tick is a millisecond of it.
struct TickClock {
  std::int64_t now = 0;  ///< ns
};

struct DeviceRequest {
  std::string name;      ///< as written: "openigtlink:localhost:18944"
  std::string argument;  ///< behind the first colon, never empty where there is a colon: "localhost:18944"
  std::array<std::string, handCount> tools;  ///< names of a tracker's tools, left and right; empty: none
  const Calibration* calibration = nullptr;  ///< of the device, where one was given: a camera's lens is in it
  std::optional<Hand> hand = std::nullopt;   ///< the one hand that it is to drive, beside another device

  /// Reads HOST, HOST:PORT or [IPv6]:PORT from the argument; what is missing stays as it is.
  /// @throws Error (invalid)
  void readAddress(std::string& host, int& port) const;
  /// @throws Error (invalid) that names the request and says why
  [[noreturn]] void refuse(const std::string& why) const;
};

struct OpenedDevice {
  std::unique_ptr<Device> device;
  std::shared_ptr<TickClock> tickClock;  ///< for devices without real time: DeviceSourceSettings::tickClock
};

struct ListedDevice {
  std::string name;    ///< what to ask for
  std::string detail;  ///< for people
  bool present = true;
  std::string hands;
  std::string senses;
  std::string rate;
};

struct DeviceKind {
  const char* name;          ///< before the colon, and DeviceInfo::name: "gamepad"; stored, never reused
  const char* usage;         ///< how to ask for one: "gamepad[:NAME]"
  const char* help;          ///< one line for people
  bool needsWindow = false;  ///< its input comes from a window, which opens it; `open` refuses
  /// Its row of `calot devices`: name, detail, hands, senses, rate. Where `list` is set it is for what that throws.
  std::array<const char*, 5> row{};
  /// Lists devices that are, or could be, available. @throws Error that is their detail. Null: the row.
  std::vector<ListedDevice> (*list)() = nullptr;
  /// @throws Error: invalid, for a request that makes no sense; damaged, for a bad file; failure, where it is not
  /// there.
  OpenedDevice (*open)(const DeviceRequest& request);

  /// Does not throw.
  [[nodiscard]] std::vector<ListedDevice> listed() const;
};

}  // namespace calot::recorder
