// SPDX-License-Identifier: GPL-3.0-or-later
// The reference server of the protocol of force devices: a simulated device in a simulated hand, on this machine alone.
// A force device in the grip of a human hand, simulated: what the reference server plays and the closed-loop tests
// close the loop with. One axis is like the other.
#pragma once

#include <array>
#include <atomic>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "recorder/sources/devices/device_script.h"
#include "recorder/sources/devices/force/force_wire.h"
#include "recorder/sources/devices/tcp.h"
#include "sim/math/linear.h"

namespace calot::recorder {

struct SimulatedHandModel {
  // The device at its handle.
  double deviceMass = 0.1;       ///< kg
  double deviceDamping = 0.3;    ///< N s/m
  double deviceFriction = 0.05;  ///< N, Coulomb's
  double encoderQuantum = 1e-5;  ///< m
  double motorQuantum = 0.005;   ///< N
  double maxForce = 8.0;         ///< N
  // The arm. Measured at a force device (van Beek, Bergmann Tiest, Mugge and Kappers 2015, Sci. Rep. 5:18004, figure
  // 4).
  double armMass = 0.554;       ///< kg
  double armDamping = 6.45;     ///< N s/m, towards the path that is intended
  double armStiffness = 135.0;  ///< N/m
  // Fingers between arm and handle; both 0: nobody holds it. Assumed.
  double gripStiffness = 1000.0;  ///< N/m
  double gripDamping = 3.0;       ///< N s/m
};

/// Handle and hand as two masses; the arm pulls the hand along an intended path. Semi-implicit Euler in steps of 20 us,
/// friction as an impulse that stops a slow handle.
class SimulatedHand {
 public:
  SimulatedHand(const SimulatedHandModel& model, const Vec3& position);

  /// A time under a force of the motors that is held. @param intended where the arm wants its hand at the end of it
  void advance(double seconds, const Vec3& force, const Vec3& intended);
  /// An impulse on the handle: somebody strikes it (N s).
  void strike(const Vec3& impulse) { velocity_ += impulse / model_.deviceMass; }

  [[nodiscard]] const Vec3& position() const { return position_; }  ///< of the handle
  [[nodiscard]] const Vec3& velocity() const { return velocity_; }
  /// Position as its encoders give it.
  [[nodiscard]] Vec3 measured() const;
  /// The force that its motors make of a command: limited, in steps of their quantum.
  [[nodiscard]] Vec3 motorForce(const Vec3& command) const;

  /// Work that the motors have done on the handle, and what its own damping and friction have dissipated (J).
  [[nodiscard]] double work() const { return work_; }
  [[nodiscard]] double dissipated() const { return dissipated_; }

 private:
  SimulatedHandModel model_;
  Vec3 position_, hand_, intended_;
  Vec3 velocity_ = Vec3::Zero(), handVelocity_ = Vec3::Zero();
  double work_ = 0.0, dissipated_ = 0.0;
};

struct ForceServerSettings {
  int port = forcewire::defaultPort;  ///< 0: any that is free
  std::uint8_t hands = 2;             ///< bit 0 left, bit 1 right
  double delay = 0.0;                 ///< s, before a wrench is shown
  SimulatedHandModel hand;
  bool once = false;  ///< end when the first client has gone
};

/// Target of a scripted hand, between its samples on the straight line. At its end it stays.
class IntendedPath {
 public:
  IntendedPath(const DeviceScript& script, Hand hand);
  /// A path of its own: reaches 65 mm away and back every four seconds, in small circles: in touch-liver the right hand
  /// meets the liver.
  IntendedPath() = default;
  [[nodiscard]] DeviceSample at(double seconds) const;

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
