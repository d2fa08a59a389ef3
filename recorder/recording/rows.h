// SPDX-License-Identifier: GPL-3.0-or-later
// Packed rows of the compound data sets (schemas/recording.md), each kind listed once. Internal to this folder.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "recorder/engine/observer.h"
#include "recorder/recording/device_sample.h"
#include "recorder/recording/reader.h"

namespace calot::recorder {

/// T, or a constant one.
template <class T, class Row>
concept SameAs = std::is_same_v<std::remove_const_t<T>, Row>;

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

struct KeyframeRow {
  std::uint64_t step = 0;
  std::uint64_t offset = 0;  ///< of its first byte in /keyframes/bytes
  std::uint64_t stateBytes = 0;
  std::uint64_t hapticsBytes = 0;
};

/// The row of /device/counts that belongs to a row of /status.
struct RawCounts {
  std::array<std::uint64_t, handCount> samples{}, dropped{};
};

// Each kind of row lists its fields once, in their order and without gaps: bytes, stored type and exported table follow
// from the list. A visitor is called with (name, unit, value).

template <class Visitor>
void visitRow(SameAs<Event> auto& e, Visitor& visit) {
  visit("step", "", e.step);
  visit("kind", "", e.kind);
  visit("hand", "", e.hand);
  visit("subject", "", e.subject);
  visit("position", "m", e.position);
  visit("value", "", e.value);
}

template <class Visitor>
void visitRow(SameAs<KeyframeRow> auto& k, Visitor& visit) {
  visit("step", "", k.step);
  visit("offset", "", k.offset);
  visit("state_bytes", "", k.stateBytes);
  visit("haptics_bytes", "", k.hapticsBytes);
}

template <class Visitor>
void visitRow(SameAs<StatusRow> auto& s, Visitor& visit) {
  visit("ticks", "", s.ticks);
  visit("steps", "", s.steps);
  visit("events", "", s.events);
  visit("keyframes", "", s.keyframes);
  visit("keyframe_words", "", s.keyframeWords);
  visit("completed", "", s.completed);
  visit("outcome", "", s.outcome);
  visit("wall_nanoseconds", "ns", s.wallNanoseconds);
  visit("chain", "", s.chain);
}

template <class Visitor>
void visitRow(SameAs<RawSample> auto& r, Visitor& visit) {
  visit("device_time", "ns", r.sample.deviceTime);
  visit("host_time", "ns", r.sample.hostTime);
  visit("sequence", "", r.sample.sequence);
  visit("tick", "", r.tick);
  visit("position", "m", r.sample.position);
  visit("orientation", "", r.sample.orientation);
  visit("gripper", "rad", r.sample.gripper);
  visit("buttons", "", r.sample.buttons);
  visit("valid", "", r.sample.valid);
  visit("used", "", r.used);
}

template <class Visitor>
void visitRow(SameAs<RawCounts> auto& c, Visitor& visit) {
  visit("left", "", c.samples[0]);
  visit("right", "", c.samples[1]);
  visit("left_dropped", "", c.dropped[0]);
  visit("right_dropped", "", c.dropped[1]);
}

/// Appends the bytes of a row.
template <class Row>
void appendRow(const Row& row, std::vector<std::byte>& out) {
  const auto put = [&out]<class T>(const char* /*name*/, const char* /*unit*/, const T& value) {
    if constexpr (std::is_same_v<T, Quat>) {
      for (const double v : {value.w(), value.x(), value.y(), value.z()}) appendValue(out, v);
    } else if constexpr (std::is_same_v<T, Vec3>) {
      appendBytes(out, value.data(), 3 * sizeof(double));
    } else {
      appendValue(out, value);
    }
  };
  visitRow(row, put);
}

/// Reads a row. @return an empty string, or what no writer makes: a flag that is neither 0 nor 1, an unknown outcome, a
/// valid sample whose pose is not finite, a used one that is not valid @pre the bytes are there
std::string parseRow(std::span<const std::byte> bytes, Event& out);
std::string parseRow(std::span<const std::byte> bytes, KeyframeRow& out);
std::string parseRow(std::span<const std::byte> bytes, StatusRow& out);
std::string parseRow(std::span<const std::byte> bytes, RawSample& out);
std::string parseRow(std::span<const std::byte> bytes, RawCounts& out);

}  // namespace calot::recorder
