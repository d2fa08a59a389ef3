// SPDX-License-Identifier: GPL-3.0-or-later
// A small OpenIGTLink server on this machine that plays a motion: to try a set-up without a tracker.
#pragma once

#include <array>
#include <atomic>
#include <functional>
#include <string>

#include "recorder/sources/devices/device_script.h"
#include "recorder/sources/devices/openigtlink_wire.h"
#include "recorder/sources/devices/tcp.h"

namespace calot::recorder {

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
