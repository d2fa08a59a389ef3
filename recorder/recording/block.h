// SPDX-License-Identifier: GPL-3.0-or-later
// Rows of the data sets as bytes: packed rows of compound ones, each kind listed once, and the rows of every column
// that one flush writes. Internal to the recorder. The content chain (schemas/recording.md, "Content chain") has one
// link a flush: BLAKE2b-256 over decoded values.
#pragma once

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <type_traits>
#include <vector>

#include "recorder/engine/observer.h"
#include "recorder/recording/device_sample.h"
#include "recorder/recording/layout.h"
#include "recorder/recording/reader.h"

namespace calot::recorder {

/// T, or a constant one.
template <class T, class Row>
concept SameAs = std::is_same_v<std::remove_const_t<T>, Row>;

inline void appendBytes(std::vector<std::byte>& out, const void* data, std::size_t size) {
  const auto* bytes = static_cast<const std::byte*>(data);
  out.insert(out.end(), bytes, bytes + size);
}

/// Appends a value as it is stored: quaternions as w, x, y, z.
template <class T>
void appendValue(std::vector<std::byte>& out, const T& value) {
  if constexpr (std::is_same_v<T, Quat>) {
    appendValue(out, std::array<double, 4>{value.w(), value.x(), value.y(), value.z()});
  } else {
    appendBytes(out, &value, sizeof value);
  }
}

/// Takes a value from the front. @pre the bytes are there.
template <class T>
T takeValue(std::span<const std::byte>& bytes) {
  T value;
  std::memcpy(static_cast<void*>(&value), bytes.data(), sizeof value);
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

void visitRow(SameAs<Event> auto& e, auto& visit) {
  visit("step", "", e.step);
  visit("kind", "", e.kind);
  visit("hand", "", e.hand);
  visit("subject", "", e.subject);
  visit("position", "m", e.position);
  visit("value", "", e.value);
}

void visitRow(SameAs<KeyframeRow> auto& k, auto& visit) {
  visit("step", "", k.step);
  visit("offset", "", k.offset);
  visit("state_bytes", "", k.stateBytes);
  visit("haptics_bytes", "", k.hapticsBytes);
}

void visitRow(SameAs<StatusRow> auto& s, auto& visit) {
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

void visitRow(SameAs<RawSample> auto& r, auto& visit) {
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

void visitRow(SameAs<RawCounts> auto& c, auto& visit) {
  visit("left", "", c.samples[0]);
  visit("right", "", c.samples[1]);
  visit("left_dropped", "", c.dropped[0]);
  visit("right_dropped", "", c.dropped[1]);
}

void appendRow(const auto& row, std::vector<std::byte>& out) {
  const auto put = [&out](const char* /*name*/, const char* /*unit*/, const auto& value) { appendValue(out, value); };
  visitRow(row, put);
}

/// Reads a row. @return an empty string, or what no writer makes: a flag that is neither 0 nor 1, an unknown outcome, a
/// valid sample whose pose is not finite, a used one that is not valid @pre the bytes are there
std::string parseRow(std::span<const std::byte> bytes, Event& out);
std::string parseRow(std::span<const std::byte> bytes, KeyframeRow& out);
std::string parseRow(std::span<const std::byte> bytes, StatusRow& out);
std::string parseRow(std::span<const std::byte> bytes, RawSample& out);
std::string parseRow(std::span<const std::byte> bytes, RawCounts& out);

/// Appends every visited value to its column. Lists have the length that they have, at most that of the layout.
struct AppendVisitor {
  const Layout& layout;
  std::vector<std::vector<std::byte>>& column;
  std::size_t index = 0;

  void operator()(const char*, const char*, const char*, const auto& value) { appendValue(column[index++], value); }
  void outside(const char*, const char*, const char*, const auto& value) { appendValue(column[index++], value); }
  template <class T>
  void list(const char*, const char*, const char*, const std::vector<T>& values, std::size_t width) {
    appendBytes(column[index++], values.data(), std::min(values.size(), width) * sizeof(T));
  }
  template <class Part, class T>
  void each(const char*, const char*, const char*, const std::vector<Part>& parts, T Part::*member) {
    for (const Part& part : parts) appendValue(column[index], part.*member);
    ++index;
  }
};

/// Reads every visited value from one row of its column, and finds the first that no writer makes. `place(column)` is
/// where that column's row lies.
template <class Place>
struct RowVisitor {
  const Layout& layout;
  Place place;            ///< where the row of a column lies, by the column's number
  std::uint64_t row = 0;  ///< its number, for faults
  std::size_t index = 0;
  bool input = false;  ///< samples must be finite; results too, but where the simulation ran away (unfinite)
  std::string fault;
  std::string unfinite = {};  ///< first result that is no finite number

  void operator()(const char*, const char*, const char*, auto& value) {
    read(at(), value);
    ++index;
  }
  void operator()(const char*, const char*, const char*, Vec3& v) {
    std::memcpy(v.data(), at(), 3 * sizeof(double));
    if (!v.allFinite()) failUnfinite();
    ++index;
  }
  void operator()(const char*, const char*, const char*, Quat& q) {
    std::array<double, 4> wxyz{};
    std::memcpy(wxyz.data(), at(), sizeof wxyz);
    q = Quat(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
    const double norm = std::sqrt(wxyz[0] * wxyz[0] + wxyz[1] * wxyz[1] + wxyz[2] * wxyz[2] + wxyz[3] * wxyz[3]);
    if (input && !(std::abs(norm - 1.0) <= 1e-3)) fail("is not a unit quaternion within 1e-3");
    if (!std::isfinite(norm)) failUnfinite();
    ++index;
  }
  template <class T>
  void outside(const char*, const char*, const char*, T& value) {
    std::memcpy(&value, at(), sizeof value);
    if (!std::isfinite(value)) fail("is not finite");
    if (value < T{}) fail("is negative");
    ++index;
  }
  template <class T>
  void list(const char*, const char*, const char*, std::vector<T>& values, std::size_t width) {
    values.resize(width);
    for (std::size_t i = 0; i < width; ++i) read(at() + i * sizeof(T), values[i]);
    ++index;
  }
  template <class Part, class T>
  void each(const char*, const char*, const char*, std::vector<Part>& parts, T Part::*member) {
    parts.resize(layout.countOf(parts));
    for (std::size_t i = 0; i < parts.size(); ++i) read(at() + i * sizeof(T), parts[i].*member);
    ++index;
  }

 private:
  [[nodiscard]] const std::byte* at() const { return place(index); }
  template <class T>
  void read(const std::byte* from, T& value) {
    const auto code = std::to_integer<unsigned>(*from);
    if constexpr (std::is_same_v<T, bool>) {
      if (code > 1) fail("is neither 0 nor 1");
      value = code != 0;
    } else {
      std::memcpy(&value, from, sizeof value);
    }
    if constexpr (std::is_floating_point_v<T>) {
      if (!std::isfinite(value)) failUnfinite();
    } else if constexpr (std::is_same_v<T, InstrumentKind>) {
      if (!isInstrumentNumber(code)) fail("is not a known instrument");
    } else if constexpr (std::is_same_v<T, Cautery>) {
      if (value > Cautery::onTissue) fail("is not a known state of the cautery");
    } else if constexpr (std::is_same_v<T, Phase>) {
      if (value > Phase::done) fail("is not a known phase");
    }
  }
  void failUnfinite() {
    std::string& whose = input ? fault : unfinite;
    if (whose.empty()) whose = fmt::format("{}[{}] is not finite", layout.columns[index].path, row);
  }
  void fail(const char* why) {
    if (fault.empty()) fault = fmt::format("{}[{}] {}", layout.columns[index].path, row, why);
  }
};

struct Block {
  std::vector<std::vector<std::byte>> column;     ///< as Layout::columns
  std::array<std::uint64_t, streamCount> rows{};  ///< of each stream in this block
  bool last = false;                              ///< nothing comes after it
  bool completed = false;                         ///< the attempt ended with it
  Outcome outcome = Outcome::running;
  std::array<std::uint64_t, handCount> rawDropped{};  ///< raw samples of this block that could not be kept
  std::vector<Keyframe> keyframes;                    ///< of its steps, while they are not yet coded
  BriefDigest brief;                                  ///< of its last step

  /// Reserves capacity for a whole block, so that filling it does not allocate (except for events and keyframes).
  explicit Block(const Layout& layout);
  void clear();
};

/// Rows of each stream that a row of /status covers.
std::array<std::uint64_t, streamCount> countsOf(const StatusRow& row);

/// Appends a step to a block, but for its keyframe. @pre the layout is of the newest format version
void appendStep(const Layout& layout, const StepRecord& record, Block& block);

/// Appends the coded words of a keyframe (keyframe_code.h) and its row of the index. `offset` counts the words of
/// /keyframes/bytes before it and moves on.
void appendKeyframe(const Layout& layout, const Keyframe& keyframe, std::span<const std::uint64_t> words,
                    std::uint64_t& offset, Block& block);

/// Reads step `at` (of this block) back, but for its events. @return an empty string, or which value is out of range.
std::string extractStep(const Layout& layout, const Block& block, std::uint64_t at, RecordedStep& out);

using ChainHead = std::array<std::uint8_t, 32>;

/// Link 0: root attributes, scene, names.
ChainHead chainStart(const AttemptHeader& header);

/// The next link: the rows of a block and the counts of its row of /status. @param before the row before it.
ChainHead chainNext(const Layout& layout, const StatusRow& before, const Block& block, const StatusRow& after);

}  // namespace calot::recorder
