// SPDX-License-Identifier: GPL-3.0-or-later
// The reference server of the protocol of force devices: a simulated device in a simulated hand, on this machine alone.
#pragma once

#include <array>
#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "recorder/sources/devices/device_script.h"
#include "recorder/sources/devices/force/force_wire.h"
#include "recorder/sources/devices/force/simulated_hand.h"
#include "recorder/sources/devices/tcp.h"

namespace calot::recorder {

struct ForceServerSettings {
  int port = forcewire::defaultPort;  ///< 0: any that is free
  std::uint8_t hands = 2;             ///< bit 0 left, bit 1 right
  double delay = 0.0;                 ///< s, before a wrench is shown
  SimulatedHandModel hand;
  bool once = false;  ///< end when the first client has gone
};

/// What the hand intends: its path, roll, jaw and buttons.
struct Intention {
  Vec3 position = Vec3::Zero();
  Quat orientation = Quat::Identity();
  double gripper = 0.0;
  std::uint8_t buttons = 0;
};

/// Where a hand of a script wants to be, in between its samples on the straight line. At its end it stays.
class IntendedPath {
 public:
  IntendedPath(const DeviceScript& script, Hand hand);
  /// A path of its own: reaches 65 mm away and back every four seconds, in small circles: in touch-liver the right hand
  /// meets the liver.
  IntendedPath() = default;
  [[nodiscard]] Intention at(double seconds) const;

 private:
  std::vector<DeviceSample> samples_;
};

/// Serves one client at a time at 1 kHz. Each begins at the start of the path.
class ForceServer {
 public:
  /// @param motion what the hands intend; null: a path of its own. Outlives the server.
  /// @throws Error (failure) where the port is taken.
  ForceServer(const DeviceScript* motion, const ForceServerSettings& settings);

  [[nodiscard]] int port() const { return listener_.port(); }
  /// What it says of itself.
  [[nodiscard]] const forcewire::Hello& hello() const { return hello_; }

  /// Runs until `stop`, or with `once` until the first client has gone.
  /// @param tell takes a line for each client that comes or goes.
  void run(const std::atomic<bool>& stop, const std::function<void(const std::string&)>& tell);

 private:
  struct Commanded {
    double at = 0.0;  ///< s, when it takes effect
    std::uint32_t number = 0;
    Wrench wrench;
  };
  struct Handle {
    Hand hand = Hand::right;
    IntendedPath path;
    std::optional<SimulatedHand> simulated;
    std::vector<Commanded> coming;
    Commanded now;
    double heard = 0.0;  ///< s, when the last wrench came
    double maxForce = 0.0;
    std::uint64_t sequence = 0;
  };
  void serve(TcpStream client, const std::atomic<bool>& stop, const std::function<void(const std::string&)>& tell);
  bool greet(TcpStream& client, const std::atomic<bool>& stop, const std::function<void(const std::string&)>& tell);
  bool receive(TcpStream& client, double now);
  forcewire::Pose tick(Handle& handle, double now) const;

  ForceServerSettings settings_;
  forcewire::Hello hello_;
  std::vector<Handle> handles_;
  forcewire::Decoder decoder_;
  std::vector<forcewire::Frame> frames_;
  TcpListener listener_;
};

}  // namespace calot::recorder
