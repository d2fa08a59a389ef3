// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/recording/block.h"

#include <cassert>
#include <cmath>
#include <cstring>

#include <fmt/format.h>

#include "sim/instruments/instruments.h"

namespace calot::recorder {

namespace {

/// Appends every visited value to its column.
struct AppendVisitor {
  const Layout& layout;
  Block& block;
  std::size_t index = 0;

  template <class T>
  void operator()(const char*, const char*, const char*, const T& value) {
    appendValue(block.column[index++], value);
  }
  void operator()(const char*, const char*, const char*, const Vec3& v) {
    appendBytes(block.column[index++], v.data(), 3 * sizeof(double));
  }
  void operator()(const char*, const char*, const char*, const Quat& q) {
    const std::array<double, 4> wxyz{q.w(), q.x(), q.y(), q.z()};
    appendValue(block.column[index++], wxyz);
  }
  template <class T>
  void outside(const char*, const char*, const char*, const T& value) {
    appendValue(block.column[index++], value);
  }
  template <class T>
  void list(const char*, const char*, const char*, const std::vector<T>& values, std::size_t width) {
    assert(values.size() == width);
    for (std::size_t i = 0; i < width; ++i) appendValue(block.column[index], i < values.size() ? values[i] : T{});
    ++index;
  }
  template <class Part, class T>
  void each(const char*, const char*, const char*, const std::vector<Part>& parts, T Part::*member) {
    assert(parts.size() == layout.countOf(parts));
    for (std::size_t i = 0; i < layout.countOf(parts); ++i) {
      appendValue(block.column[index], i < parts.size() ? parts[i].*member : T{});
    }
    ++index;
  }
};

/// Reads every visited value from one row of its column, and finds the first that no writer makes.
struct ExtractVisitor {
  const Layout& layout;
  const Block& block;
  std::uint64_t row = 0;
  std::size_t index = 0;
  bool input =
      false;  ///< samples must be finite; results are what the simulation made of them, and the chain's concern
  std::string fault;

  template <class T>
  void operator()(const char*, const char*, const char*, T& value) {
    std::memcpy(&value, at(), sizeof value);
    check(value);
    ++index;
  }
  void operator()(const char*, const char*, const char*, bool& value) {
    const auto byte = std::to_integer<unsigned>(*at());
    if (byte > 1) fail("is neither 0 nor 1");
    value = byte != 0;
    ++index;
  }
  void operator()(const char*, const char*, const char*, InstrumentKind& value) {
    const auto number = std::to_integer<unsigned>(*at());
    if (!isInstrumentNumber(number)) fail("is no known instrument");
    value = static_cast<InstrumentKind>(number);
    ++index;
  }
  void operator()(const char*, const char*, const char*, Cautery& value) {
    choice(value, Cautery::onTissue, "is no known state of the cautery");
  }
  void operator()(const char*, const char*, const char*, Phase& value) {
    choice(value, Phase::done, "is no known phase");
  }
  void operator()(const char*, const char*, const char*, Vec3& v) {
    std::memcpy(v.data(), at(), 3 * sizeof(double));
    if (input && !v.allFinite()) fail("is not finite");
    ++index;
  }
  void operator()(const char*, const char*, const char*, Quat& q) {
    std::array<double, 4> wxyz{};
    std::memcpy(wxyz.data(), at(), sizeof wxyz);
    q = Quat(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
    const double norm = std::sqrt(wxyz[0] * wxyz[0] + wxyz[1] * wxyz[1] + wxyz[2] * wxyz[2] + wxyz[3] * wxyz[3]);
    if (input && !(std::abs(norm - 1.0) <= 1e-3)) fail("is not a unit quaternion within 1e-3");
    ++index;
  }
  template <class T>
  void outside(const char*, const char*, const char*, T& value) {
    std::memcpy(&value, at(), sizeof value);
    check(value);
    ++index;
  }
  template <class T>
  void list(const char*, const char*, const char*, std::vector<T>& values, std::size_t width) {
    values.resize(width);
    if (width > 0) std::memcpy(values.data(), at(), width * sizeof(T));
    for (const T& v : values) check(v);
    ++index;
  }
  template <class Part, class T>
  void each(const char*, const char*, const char*, std::vector<Part>& parts, T Part::*member) {
    parts.resize(layout.countOf(parts));
    for (std::size_t i = 0; i < parts.size(); ++i) {
      const std::byte* place = at() + i * sizeof(T);
      if constexpr (std::is_same_v<T, bool>) {
        const auto byte = std::to_integer<unsigned>(*place);
        if (byte > 1) fail("is neither 0 nor 1");
        parts[i].*member = byte != 0;
      } else {
        std::memcpy(&(parts[i].*member), place, sizeof(T));
        check(parts[i].*member);
      }
    }
    ++index;
  }

 private:
  [[nodiscard]] const std::byte* at() const {
    return block.column[index].data() + static_cast<std::size_t>(row) * layout.columns[index].rowBytes();
  }
  /// A number from 0 to that of the last name.
  template <class Choice>
  void choice(Choice& value, Choice last, const char* why) {
    const auto code = std::to_integer<unsigned>(*at());
    if (code > static_cast<unsigned>(last)) fail(why);
    value = static_cast<Choice>(code);
    ++index;
  }
  template <class T>
  void check(const T& value) {
    if constexpr (std::is_floating_point_v<T>) {
      if (input && !std::isfinite(value)) fail("is not finite");
    }
  }
  void fail(const char* why) {
    if (fault.empty()) fault = fmt::format("{}[{{row}}] {}", layout.columns[index].path, why);
  }
};

/// Puts the row's number in the file into a fault.
std::string named(const std::string& fault, std::uint64_t row) {
  std::string text = fault;
  if (const auto at = text.find("{row}"); at != std::string::npos) text.replace(at, 5, std::to_string(row));
  return text;
}

}  // namespace

Block::Block(const Layout& layout) : column(layout.columns.size()) {
  for (std::size_t c = 0; c < column.size(); ++c) {
    const Column& spec = layout.columns[c];
    if (spec.stream == Stream::ticks || spec.stream == Stream::steps) {
      column[c].reserve(spec.rowBytes() * static_cast<std::size_t>(spec.chunkRows));
    }
  }
  column[layout.events].reserve(eventBytes * 64);
  for (const std::size_t raw : layout.raw) column[raw].reserve(layout.deviceSamples ? rawSampleBytes * 256 : 0);
}

void Block::clear() {
  for (std::vector<std::byte>& c : column) c.clear();
  rows.fill(0);
  last = false;
  completed = false;
  outcome = Outcome::running;
  rawDropped.fill(0);
  keyframes.clear();
}

std::array<std::uint64_t, streamCount> countsOf(const StatusRow& row) {
  return {row.ticks, row.steps, row.events, row.keyframes, row.keyframeWords, row.rawSamples[0], row.rawSamples[1]};
}

void appendStep(const Layout& layout, const StepRecord& record, Block& block) {
  assert(record.samples.size() == layout.ticksPerStep && record.ticks.size() == layout.ticksPerStep);
  assert(!layout.exactForces);
  for (std::size_t t = 0; t < layout.ticksPerStep; ++t) {
    AppendVisitor visit{layout, block};
    const TickOutcome tick = asStored(record.ticks[t]);
    visitTick(record.samples[t], tick, visit);
  }
  AppendVisitor visit{layout, block, layout.tickColumns};
  const std::uint64_t forces = forceDigest(record.ticks);
  if (layout.brief) shorten(record.digest, block.brief);
  assert(!layout.procedure);  // only versions of old had it
  const RecordedProcedure none;
  visitStep(record.digest, block.brief, forces, record.lateness, record.result, none, visit);
  for (const Event& event : record.result.events) {
    assert(event.step == record.step);
    appendEvent(event, block.column[layout.events]);
  }
  block.rows[static_cast<std::size_t>(Stream::ticks)] += layout.ticksPerStep;
  block.rows[static_cast<std::size_t>(Stream::steps)] += 1;
  block.rows[static_cast<std::size_t>(Stream::events)] += record.result.events.size();
}

void appendKeyframe(const Layout& layout, const Keyframe& keyframe, std::span<const std::uint64_t> words,
                    std::uint64_t& offset, Block& block) {
  appendKeyframeRow({keyframe.step, offset * 8, keyframe.state.size(), keyframe.haptics.size()},
                    block.column[layout.keyframeIndex]);
  std::vector<std::byte>& bytes = block.column[layout.keyframeWords];
  const std::uint64_t padded = (words.size() + keyframeChunkWords - 1) / keyframeChunkWords * keyframeChunkWords;
  const std::size_t before = bytes.size();
  appendBytes(bytes, words.data(), words.size_bytes());
  bytes.resize(before + static_cast<std::size_t>(padded) * 8);
  offset += padded;
  block.rows[static_cast<std::size_t>(Stream::keyframes)] += 1;
  block.rows[static_cast<std::size_t>(Stream::keyframeWords)] += padded;
}

std::string extractStep(const Layout& layout, const Block& block, std::uint64_t at, RecordedStep& out) {
  out.samples.resize(layout.ticksPerStep);
  out.ticks.resize(layout.ticksPerStep);
  for (std::size_t t = 0; t < layout.ticksPerStep; ++t) {
    const std::uint64_t row = at * layout.ticksPerStep + t;
    ExtractVisitor visit{layout, block, row, 0, true, {}};
    visitTick(out.samples[t], out.ticks[t], visit);
    if (!visit.fault.empty()) return named(visit.fault, out.step * layout.ticksPerStep + t);
    for (const HandTick& hand : out.ticks[t].hand) {
      if (hand.contactSet < -1 || hand.contactSet > static_cast<std::int64_t>(out.step)) {
        return fmt::format("/ticks: contact_set[{}] names a step that is not there",
                           out.step * layout.ticksPerStep + t);
      }
    }
  }
  ExtractVisitor visit{layout, block, at, layout.tickColumns, false, {}};
  visitStep(out.digest, out.brief, out.forces, out.lateness, out.result, out.procedure, visit);
  out.result.step = out.step;
  return named(visit.fault, out.step);
}

}  // namespace calot::recorder
