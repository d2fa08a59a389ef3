// SPDX-License-Identifier: GPL-3.0-or-later
// Packed rows of the compound data sets (schemas/recording.md). Internal to this folder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include "recorder/engine/observer.h"
#include "recorder/recording/device_sample.h"
#include "recorder/recording/reader.h"

namespace calot::recorder {

inline void appendBytes(std::vector<std::byte>& out, const void* data, std::size_t size) {
  const auto* bytes = static_cast<const std::byte*>(data);
  out.insert(out.end(), bytes, bytes + size);
}

template <class T>
void appendValue(std::vector<std::byte>& out, const T& value) {
  appendBytes(out, &value, sizeof value);
}

/// Takes a value from the front. @pre the bytes are there.
template <class T>
T takeValue(std::span<const std::byte>& bytes) {
  T value;
  std::memcpy(&value, bytes.data(), sizeof value);
  bytes = bytes.subspan(sizeof value);
  return value;
}

void appendEvent(const Event& event, std::vector<std::byte>& out);
Event parseEvent(std::span<const std::byte> row);

struct KeyframeRow {
  std::uint64_t step = 0;
  std::uint64_t offset = 0;  ///< of its first byte in /keyframes/bytes
  std::uint64_t stateBytes = 0;
  std::uint64_t hapticsBytes = 0;
};
void appendKeyframeRow(const KeyframeRow& row, std::vector<std::byte>& out);
KeyframeRow parseKeyframeRow(std::span<const std::byte> row);

void appendStatus(const StatusRow& row, std::vector<std::byte>& out);
/// @return an empty string, or what of it cannot be.
std::string parseStatus(std::span<const std::byte> bytes, StatusRow& row);

/// The row of /device/counts that belongs to a row of /status.
void appendRawCounts(const StatusRow& row, std::vector<std::byte>& out);
void parseRawCounts(std::span<const std::byte> bytes, StatusRow& row);

void appendRawSample(const RawSample& raw, std::vector<std::byte>& out);
/// @return an empty string, or what no writer makes: a flag that is neither 0 nor 1, a valid sample whose pose is not
/// finite, a used one that is not valid.
std::string parseRawSample(std::span<const std::byte> row, Hand hand, RawSample& out);

}  // namespace calot::recorder
