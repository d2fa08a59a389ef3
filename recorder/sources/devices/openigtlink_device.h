// SPDX-License-Identifier: GPL-3.0-or-later
// A small OpenIGTLink server on this machine that plays a motion: to try a set-up without a tracker.
#pragma once

#include <array>
#include <atomic>
#include <functional>
#include <set>
#include <string>

#include "recorder/sources/devices/device.h"
#include "recorder/sources/devices/device_script.h"
#include "recorder/sources/devices/openigtlink_wire.h"
#include "recorder/sources/devices/tcp.h"

namespace calot::recorder {

struct OpenIgtLinkSettings {
  std::string host = "localhost";
  int port = openigtlink::defaultPort;
  /// Names of the tools that drive the left and the right hand; an empty name: that hand has none.
  std::array<std::string, handCount> tool{"LeftTool", "RightTool"};
};

/// Client of an OpenIGTLink server (3D Slicer, PLUS, `calot devices serve`): poses of named tools by TRANSFORM, TDATA
/// or QTDATA; the opening of a tool's gripper (rad) by SENSOR with the tool's name and "Jaw" behind it; STATUS is told
/// as an event. Other messages and tools are passed over.
///
/// Connects at the first poll and again after a loss, every half second. Malformed input that names one of the tools
/// counts as an invalid sample; each kind is reported once. A stream that is not OpenIGTLink is disconnected.
class OpenIgtLinkDevice final : public ReopeningDevice {
 public:
  explicit OpenIgtLinkDevice(OpenIgtLinkSettings settings, DeviceClock clock = monotonicNanoseconds);

  [[nodiscard]] bool connected() const override { return stream_.open(); }

 private:
  std::string connect() override;
  void disconnect() override { stream_.close(); }
  void read(std::chrono::nanoseconds wait, DeviceInput& out) override;
  void take(const openigtlink::Item& item, DeviceInput& out);
  /// Reports a fault or a status of the server once a connection.
  void tellOnce(DeviceEvent::Kind kind, const std::string& fault, DeviceInput& out);

  OpenIgtLinkSettings settings_;
  TcpStream stream_;
  openigtlink::Decoder decoder_;
  std::array<std::uint64_t, handCount> sequence_{};
  std::array<double, handCount> gripper_{};
  std::set<std::string> told_;  ///< faults of this connection
};

extern const DeviceKind openIgtLinkKind;

struct OpenIgtLinkServerSettings {
  int port = openigtlink::defaultPort;  ///< 0: any that is free
  std::array<std::string, handCount> tool{"LeftTool", "RightTool"};
  double speed = 1.0;  ///< of the motion's time
  bool once = false;   ///< end when the first client has gone
};

/// Serves one client at a time. Each begins at the motion's first sample; at its end the last poses are sent on, ten
/// times a second, until the client goes.
class OpenIgtLinkServer {
 public:
  /// @throws Error (failure) where the port is taken.
  OpenIgtLinkServer(const DeviceScript& motion, OpenIgtLinkServerSettings settings);

  [[nodiscard]] int port() const { return listener_.port(); }

  /// Runs until `stop`, or with `once` until the first client has gone.
  /// @param tell takes a line for each client that comes or goes.
  void run(const std::atomic<bool>& stop, const std::function<void(const std::string&)>& tell);

 private:
  void serve(TcpStream client, const std::atomic<bool>& stop);
  bool send(TcpStream& client, const DeviceSample& sample);

  const DeviceScript& motion_;
  OpenIgtLinkServerSettings settings_;
  TcpListener listener_;
};

}  // namespace calot::recorder
