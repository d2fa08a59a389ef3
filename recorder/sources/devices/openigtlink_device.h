// SPDX-License-Identifier: GPL-3.0-or-later
// A small OpenIGTLink server on this machine that plays a motion: to try a set-up without a tracker.
// OpenIGTLink messages as bytes (protocol versions 1 and 2, http://openigtlink.org/developers/spec): a header of 58
// bytes, then a body with a CRC-64. Lengths on the wire are millimetres, quaternions x y z w, floats of 32 bits.
// Internal to this folder.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "recorder/sources/devices/device.h"
#include "recorder/sources/devices/device_script.h"
#include "recorder/sources/devices/tcp.h"
#include "sim/math/linear.h"

namespace calot::recorder::openigtlink {

inline constexpr int defaultPort = 18944;
inline constexpr std::size_t maxName = 20;  ///< bytes of a tool's name

/// One thing that a message said.
struct Item {
  enum class Kind : std::uint8_t {
    pose,     ///< TRANSFORM, an element of TDATA or QTDATA
    number,   ///< SENSOR: its first value
    status,   ///< STATUS: code and text
    fault,    ///< the message is not well formed; `text` says how
    unknown,  ///< a message of another type; `name` is the type
  };
  Kind kind = Kind::fault;
  std::string name;                     ///< of the tool
  std::int64_t time = -1;               ///< the sender's (ns since 1970); -1: none
  bool rotation = true;                 ///< pose: all finite, within 10 m, and the matrix a rotation within 1e-3
  Vec3 position = Vec3::Zero();         ///< m
  Quat orientation = Quat::Identity();  ///< unit
  double value = 0.0;
  int code = 0;
  std::string text;
};

/// Cuts a byte stream into messages. What is not well formed becomes one fault each; a stream that has lost its frame
/// (a header that can't be one) cannot be read on.
class Decoder {
 public:
  /// Takes bytes as they arrive and reports every item. @returns false when the stream is lost: close the connection.
  bool take(std::span<const std::byte> bytes, const std::function<void(const Item&)>& tell);
  void reset();

 private:
  std::vector<std::byte> buffer_;
  std::uint64_t skip_ = 0;  ///< bytes of a body that is of no interest and still to come
};

std::vector<std::byte> transformMessage(const std::string& name, std::int64_t time, const Vec3& position,
                                        const Quat& orientation);
std::vector<std::byte> sensorMessage(const std::string& name, std::int64_t time, double value);

}  // namespace calot::recorder::openigtlink

namespace calot::recorder {

struct OpenIgtLinkSettings {
  std::string host = "localhost";
  int port = openigtlink::defaultPort;
  /// Names of the tools that drive the left and the right hand; an empty name: that hand has none.
  std::array<std::string, handCount> tool{"LeftTool", "RightTool"};
};

/// Client of an OpenIGTLink server (3D Slicer, PLUS, `calot devices serve`): poses of named tools by TRANSFORM, TDATA
/// or QTDATA; the opening of a tool's gripper (rad) by SENSOR with the tool's name and "Jaw" behind it; STATUS appears
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
OpenedDevice openOpenIgtLink(const DeviceRequest& request);

struct OpenIgtLinkServerSettings {
  int port = openigtlink::defaultPort;  ///< 0: any that is free
  std::array<std::string, handCount> tool{"LeftTool", "RightTool"};
  double speed = 1.0;  ///< of the motion's time
  bool once = false;   ///< end when the first client has gone
};

/// Serves one client at a time until `stop`, or with `once` until the first one has gone. Each begins at the motion's
/// first sample; at its end the last poses are sent on, ten times a second, until the client goes.
/// @param tell takes a line with the port, and one for each client that comes or goes
/// @throws Error (failure) where the port is taken
void serveOpenIgtLink(const DeviceScript& motion, const OpenIgtLinkServerSettings& settings,
                      const std::atomic<bool>& stop, const std::function<void(const std::string&)>& tell);

}  // namespace calot::recorder
