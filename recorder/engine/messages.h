// SPDX-License-Identifier: GPL-3.0-or-later
// Messages of an engine's protocol as bytes: kind, length, payload (schemas/engine.md).
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>

#include "recorder/engine/wire.h"

namespace calot::recorder {

/// Bytes that a message's payload may have.
inline constexpr std::uint64_t maxPayload = std::uint64_t{1} << 30U;
/// kind (u4) and length (u8)
inline constexpr std::size_t messageHead = 12;

struct MessageHead {
  std::uint32_t kind = 0;
  std::uint64_t length = 0;
};

/// @pre messageHead bytes
inline MessageHead parseHead(std::span<const std::byte> bytes) {
  MessageHead head;
  std::memcpy(&head.kind, bytes.data(), sizeof head.kind);
  std::memcpy(&head.length, bytes.data() + sizeof head.kind, sizeof head.length);
  return head;
}

/// A payload alone.
template <class Payload>
wire::Bytes encodePayload(const Payload& payload) {
  wire::Bytes bytes;
  ByteWriter(bytes).write(payload);
  return bytes;
}

/// Appends a whole message.
template <class Payload>
void appendMessage(const Payload& payload, wire::Bytes& out) {
  const std::size_t at = out.size();
  ByteWriter writer(out);
  writer.write(Payload::kind);
  writer.write(std::uint64_t{0});
  writer.write(payload);
  const std::uint64_t length = out.size() - at - messageHead;
  std::memcpy(out.data() + at + sizeof(std::uint32_t), &length, sizeof length);
}

template <class Payload>
wire::Bytes encode(const Payload& payload) {
  wire::Bytes bytes;
  appendMessage(payload, bytes);
  return bytes;
}

/// @return false where bytes are missing or left over
template <class Payload>
[[nodiscard]] bool decode(std::span<const std::byte> payload, Payload& out) {
  ByteReader reader(payload);
  reader.read(out);
  return reader.complete();
}

}  // namespace calot::recorder
