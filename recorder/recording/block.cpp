// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/recording/block.h"

#include <fmt/format.h>
#include <sodium.h>
#include <cassert>
#include <cstring>

#include "recorder/recording/layout.h"

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

/// Where a row of a block's columns lies.
struct BlockRow {
  const Layout& layout;
  const Block& block;
  std::uint64_t row = 0;
  const std::byte* operator()(std::size_t column) const {
    return block.column[column].data() + static_cast<std::size_t>(row) * layout.columns[column].rowBytes();
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
    appendRow(event, block.column[layout.events]);
  }
  block.rows[static_cast<std::size_t>(Stream::ticks)] += layout.ticksPerStep;
  block.rows[static_cast<std::size_t>(Stream::steps)] += 1;
  block.rows[static_cast<std::size_t>(Stream::events)] += record.result.events.size();
}

void appendKeyframe(const Layout& layout, const Keyframe& keyframe, std::span<const std::uint64_t> words,
                    std::uint64_t& offset, Block& block) {
  appendRow(KeyframeRow{keyframe.step, offset * 8, keyframe.state.size(), keyframe.haptics.size()},
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
    RowVisitor<BlockRow> visit{layout, BlockRow{layout, block, row}, 0, true, {}};
    visitTick(out.samples[t], out.ticks[t], visit);
    if (!visit.fault.empty()) return named(visit.fault, out.step * layout.ticksPerStep + t);
    for (const HandTick& hand : out.ticks[t].hand) {
      if (hand.contactSet < -1 || hand.contactSet > static_cast<std::int64_t>(out.step)) {
        return fmt::format("/ticks: contact_set[{}] names a step that is not there",
                           out.step * layout.ticksPerStep + t);
      }
    }
  }
  RowVisitor<BlockRow> visit{layout, BlockRow{layout, block, at}, layout.tickColumns, false, {}};
  visitStep(out.digest, out.brief, out.forces, out.lateness, out.result, out.procedure, visit);
  out.result.step = out.step;
  const bool ranAway = (out.result.misses & miss::runaway) != 0;
  return named(visit.fault.empty() && !ranAway ? visit.unfinite : visit.fault, out.step);
}

namespace {

/// BLAKE2b-256 of what is appended; strings after their length (u32), numbers little-endian.
class Hash {
 public:
  Hash() {
    [[maybe_unused]] static const int ready = sodium_init();
    crypto_generichash_init(&state_, nullptr, 0, std::tuple_size_v<ChainHead>);
  }
  void bytes(const void* data, std::size_t size) {
    if (size > 0) crypto_generichash_update(&state_, static_cast<const unsigned char*>(data), size);
  }
  template <class T>
  requires std::is_arithmetic_v<T>
  void number(T value) { bytes(&value, sizeof value); }
  void string(const std::string& text) {
    number(static_cast<std::uint32_t>(text.size()));
    bytes(text.data(), text.size());
  }
  ChainHead head() {
    ChainHead out{};
    crypto_generichash_final(&state_, out.data(), out.size());
    return out;
  }

 private:
  crypto_generichash_state state_;
};

struct HashAttributes {
  Hash& hash;
  void operator()(const char* name, const std::string& value) {
    hash.string(name);
    hash.string(value);
  }
  template <class T>
  requires std::is_arithmetic_v<T>
  void operator()(const char* name, const T& value) {
    hash.string(name);
    hash.number(value);
  }
  template <class T>
  void constant(const char* name, const T& value) {
    (*this)(name, value);
  }
  template <class T, std::size_t N>
  void choice(const char* name, const T& value, const std::array<const char*, N>& names) {
    (*this)(name, std::string(names[static_cast<std::size_t>(value)]));
  }
};

void appendNames(Hash& hash, const std::vector<std::string>& names) {
  hash.number(static_cast<std::uint64_t>(names.size()));
  for (const std::string& name : names) hash.string(name);
}

void appendCounts(Hash& hash, const StatusRow& row) {
  hash.number(row.ticks);
  hash.number(row.steps);
  hash.number(row.events);
  hash.number(row.keyframes);
  hash.number(row.keyframeWords);
  hash.number(static_cast<std::uint8_t>(row.completed ? 1 : 0));
  hash.number(static_cast<std::uint8_t>(row.outcome));
}

}  // namespace

ChainHead chainStart(const AttemptHeader& header) {
  Hash hash;
  const std::string label = "calot-recording-chain-1";
  hash.bytes(label.data(), label.size());
  HashAttributes visit{hash};
  visitAttributes(header, visit);
  hash.number(static_cast<std::uint64_t>(header.assets.size()));
  for (const Asset& asset : header.assets) {
    hash.string(asset.name);
    hash.number(static_cast<std::uint64_t>(asset.bytes.size()));
    hash.bytes(asset.bytes.data(), asset.bytes.size());
  }
  Tissues::forEach([&]<class Kind>(std::type_identity<Kind>, TissueId) {
    if constexpr (Kind::hasStructures) {
      if (Kind::results.since <= header.stepResultVersion) appendNames(hash, Kind::namesOf(header));
    }
  });
  appendNames(hash, header.layout.components);
  hash.number(static_cast<std::uint64_t>(header.layout.fields.size()));
  for (const DigestLayout::Field& field : header.layout.fields) {
    hash.number(field.component);
    hash.string(field.name);
  }
  appendCounts(hash, StatusRow{});
  return hash.head();
}

ChainHead chainNext(const Layout& layout, const StatusRow& before, const Block& block, const StatusRow& after) {
  Hash hash;
  hash.bytes(before.chain.data(), before.chain.size());
  const std::array<std::uint64_t, streamCount> first = countsOf(before);
  for (std::size_t c = 0; c < layout.columns.size(); ++c) {
    const Column& column = layout.columns[c];
    if (!column.chained || column.width == 0) continue;
    hash.string(column.path);
    const auto stream = static_cast<std::size_t>(column.stream);
    hash.number(first[stream]);
    hash.number(block.rows[stream]);
    hash.bytes(block.column[c].data(), block.column[c].size());
  }
  appendCounts(hash, after);
  return hash.head();
}

}  // namespace calot::recorder
