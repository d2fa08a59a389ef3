// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/recording/block.h"

#include <fmt/format.h>
#include <sodium.h>
#include <cassert>
#include <cmath>

namespace calot::recorder {

namespace {

/// Takes every field from the front of the bytes.
struct TakeFields {
  std::span<const std::byte> bytes;
  std::string fault = {};

  template <class T>
  void operator()(const char* /*name*/, const char* /*unit*/, T& value) {
    if constexpr (std::is_same_v<T, bool>) {
      const auto flag = takeValue<std::uint8_t>(bytes);
      if (flag > 1) fault = "has a flag that is neither 0 nor 1";
      value = flag == 1;
    } else if constexpr (std::is_same_v<T, Quat>) {
      const auto wxyz = takeValue<std::array<double, 4>>(bytes);
      value = Quat(wxyz[0], wxyz[1], wxyz[2], wxyz[3]);
    } else {
      value = takeValue<T>(bytes);
    }
  }
};

std::string take(std::span<const std::byte> bytes, auto& out) {
  TakeFields fields{bytes};
  visitRow(out, fields);
  return fields.fault;
}

}  // namespace

std::string parseRow(std::span<const std::byte> bytes, Event& out) { return take(bytes, out); }
std::string parseRow(std::span<const std::byte> bytes, KeyframeRow& out) { return take(bytes, out); }
std::string parseRow(std::span<const std::byte> bytes, RawCounts& out) { return take(bytes, out); }

std::string parseRow(std::span<const std::byte> bytes, StatusRow& out) {
  const std::string fault = take(bytes, out);
  if (out.wallNanoseconds < 0) return "was written before 1970";
  const bool known =
      fault.empty() && out.outcome <= Outcome::technicalFailure && out.completed == (out.outcome != Outcome::running);
  return known ? "" : "has an unknown outcome";
}

std::string parseRow(std::span<const std::byte> bytes, RawSample& out) {
  if (std::string fault = take(bytes, out); !fault.empty()) return fault;
  const DeviceSample& s = out.sample;
  if (out.used && !s.valid) return "was used and is not valid";
  if (s.valid && !(s.position.allFinite() && s.orientation.coeffs().allFinite() && std::isfinite(s.gripper)))
    return "is valid and not finite";
  return {};
}

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
  assert(!layout.exactForces && !layout.procedure);  // only versions of old had them
  for (std::size_t t = 0; t < layout.ticksPerStep; ++t) {
    AppendVisitor visit{layout, block.column};
    const TickOutcome tick = asStored(record.ticks[t]);
    visitTick(record.samples[t], tick, visit);
  }
  AppendVisitor visit{layout, block.column, layout.tickColumns};
  const std::uint64_t forces = forceDigest(record.ticks);
  if (layout.brief) shorten(record.digest, block.brief);
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
  std::uint64_t row = at * layout.ticksPerStep;
  const auto place = [&](std::size_t column) {
    return block.column[column].data() + static_cast<std::size_t>(row) * layout.columns[column].rowBytes();
  };
  using Visitor = RowVisitor<decltype(place)>;
  out.samples.resize(layout.ticksPerStep);
  out.ticks.resize(layout.ticksPerStep);
  for (std::size_t t = 0; t < layout.ticksPerStep; ++t, ++row) {
    const std::uint64_t tick = out.step * layout.ticksPerStep + t;
    Visitor visit{layout, place, tick, 0, true, {}};
    visitTick(out.samples[t], out.ticks[t], visit);
    if (!visit.fault.empty()) return visit.fault;
    for (const HandTick& hand : out.ticks[t].hand) {
      if (hand.contactSet < -1 || hand.contactSet > static_cast<std::int64_t>(out.step))
        return fmt::format("/ticks: contact_set[{}] names a step that is not there", tick);
    }
  }
  row = at;
  Visitor visit{layout, place, out.step, layout.tickColumns, false, {}};
  visitStep(out.digest, out.brief, out.forces, out.lateness, out.result, out.procedure, visit);
  out.result.step = out.step;
  const bool ranAway = (out.result.misses & miss::runaway) != 0;
  return visit.fault.empty() && !ranAway ? visit.unfinite : visit.fault;
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
  void value(T number) { bytes(&number, sizeof number); }
  void value(const std::string& text) {
    value(static_cast<std::uint32_t>(text.size()));
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

void appendNames(Hash& hash, const std::vector<std::string>& names) {
  hash.value(static_cast<std::uint64_t>(names.size()));
  for (const std::string& name : names) hash.value(name);
}

void appendCounts(Hash& hash, const StatusRow& row) {
  hash.value(row.ticks);
  hash.value(row.steps);
  hash.value(row.events);
  hash.value(row.keyframes);
  hash.value(row.keyframeWords);
  hash.value(static_cast<std::uint8_t>(row.completed ? 1 : 0));
  hash.value(static_cast<std::uint8_t>(row.outcome));
}

}  // namespace

ChainHead chainStart(const AttemptHeader& header) {
  Hash hash;
  const std::string label = "calot-recording-chain-1";
  hash.bytes(label.data(), label.size());
  forEachAttribute(header, [&](const char* name, const auto& value) {
    hash.value(name);
    hash.value(value);
  });
  hash.value(static_cast<std::uint64_t>(header.assets.size()));
  for (const Asset& asset : header.assets) {
    hash.value(asset.name);
    hash.value(static_cast<std::uint64_t>(asset.bytes.size()));
    hash.bytes(asset.bytes.data(), asset.bytes.size());
  }
  Tissues::forEach([&]<class Kind>(std::type_identity<Kind>, TissueId) {
    if constexpr (Kind::hasStructures) {
      if (Kind::results.since <= header.stepResultVersion) appendNames(hash, Kind::namesOf(header));
    }
  });
  appendNames(hash, header.layout.components);
  hash.value(static_cast<std::uint64_t>(header.layout.fields.size()));
  for (const DigestLayout::Field& field : header.layout.fields) {
    hash.value(field.component);
    hash.value(field.name);
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
    hash.value(column.path);
    const auto stream = static_cast<std::size_t>(column.stream);
    hash.value(first[stream]);
    hash.value(block.rows[stream]);
    hash.bytes(block.column[c].data(), block.column[c].size());
  }
  appendCounts(hash, after);
  return hash.head();
}

}  // namespace calot::recorder
