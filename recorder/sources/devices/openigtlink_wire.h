// SPDX-License-Identifier: GPL-3.0-or-later
// OpenIGTLink messages as bytes (protocol versions 1 and 2, http://openigtlink.org/developers/spec): a header of 58
// bytes, then a body with a CRC-64. Lengths on the wire are millimetres, quaternions x y z w, floats of 32 bits.
// Internal to this folder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

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
