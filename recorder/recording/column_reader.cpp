// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/recording/file_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>
#include <utility>

#include "recorder/recording/hdf5.h"
#include "recorder/recording/keyframe_code.h"

namespace calot::recorder {

using hdf5::damaged;

namespace {

/// How many bytes of decoded keyframes are kept for the next ones.
constexpr std::size_t maxKnownBytes = std::size_t{64} << 20U;

}  // namespace

ColumnReader::ColumnReader(std::filesystem::path path, const hdf5::Id& file, const Layout& layout,
                           std::uint64_t fileBytes)
    : path_(std::move(path)),
      layout_(layout),
      fileBytes_(fileBytes),
      // Open /status first: in a file being written, data sets opened later contain at least the rows it covers.
      status_(open(file, layout.status)),
      rawCounts_(open(file, layout.rawCounts)) {
  for (const Column& column : layout.columns) rows_.push_back(open(file, column));
  if (statusRows() < 1) throw damaged(path_, "/status", "is empty");
  if (statusRows() > fileBytes) throw damaged(path_, "/status", "claims more rows than the file can hold");
}

hdf5::Rows ColumnReader::open(const hdf5::Id& file, const Column& column) const {
  hdf5::Rows rows(file, column);
  if (const std::string fault = rows.measure(); !fault.empty()) throw damaged(path_, column.path, fault);
  return rows;
}

void ColumnReader::read(const hdf5::Rows& source, std::uint64_t first, std::uint64_t rows,
                        std::vector<std::byte>& out) const {
  const Column& column = source.column();
  out.resize(static_cast<std::size_t>(rows) * column.rowBytes());
  if (rows == 0 || column.width == 0) return;
  if (first + rows > source.count()) {
    throw damaged(path_, column.path,
                  fmt::format("holds {} rows where /status vouches for {}", source.count(), first + rows));
  }
  if (const std::string why = source.read(first, rows, out.data()); !why.empty())
    throw damaged(path_, column.path, fmt::format("rows {} to {}: {}", first, first + rows - 1, why));
}

void ColumnReader::readRows(std::size_t column, std::uint64_t first, std::uint64_t rows,
                            std::vector<std::byte>& out) const {
  read(rows_[column], first, rows, out);
}

StatusRow ColumnReader::readStatus(std::uint64_t row) const {
  std::vector<std::byte> bytes;
  read(status_, row, 1, bytes);
  StatusRow out;
  if (const std::string fault = parseRow(bytes, out); !fault.empty())
    throw damaged(path_, "/status", fmt::format("row {} {}", row, fault));
  if (row == 0 && (out.ticks | out.steps | out.events | out.keyframes | out.keyframeWords) != 0) {
    throw damaged(path_, "/status", "row 0 does not start at nothing");
  }
  return out;
}

void ColumnReader::readRawCounts(const StatusRow& before, std::uint64_t row, StatusRow& out) const {
  if (!layout_.deviceSamples) return;
  std::vector<std::byte> bytes;
  read(rawCounts_, row, 1, bytes);
  RawCounts counts;
  static_cast<void>(parseRow(bytes, counts));
  const auto refuse = [&](const char* why) { throw damaged(path_, rawCountsPath, fmt::format("row {} {}", row, why)); };
  for (std::size_t h = 0; h < counts.samples.size(); ++h) {
    if (row == 0 && (counts.samples[h] | counts.dropped[h]) != 0) refuse("does not start at nothing");
    if (counts.samples[h] < before.rawSamples[h] || counts.dropped[h] < before.rawDropped[h])
      refuse("counts less than the row before it");
    if (counts.samples[h] - before.rawSamples[h] > fileBytes_) refuse("claims more rows than the file can hold");
  }
  out.rawSamples = counts.samples;
  out.rawDropped = counts.dropped;
}

void ColumnReader::checkFollows(const StatusRow& before, const StatusRow& after, std::uint64_t row) const {
  const auto refuse = [&](const char* why) { throw damaged(path_, "/status", fmt::format("row {} {}", row, why)); };
  if (before.completed) refuse("comes after the end");
  if (after.ticks < before.ticks || after.steps < before.steps || after.events < before.events ||
      after.keyframes < before.keyframes || after.keyframeWords < before.keyframeWords) {
    refuse("counts less than the row before it");
  }
  const std::uint64_t steps = after.steps - before.steps;
  if (steps > layout_.stepsPerBlock) refuse("vouches for more than a flush can write");
  if (steps == 0 && !after.completed) refuse("vouches for nothing");
  if (after.ticks - before.ticks != steps * layout_.ticksPerStep) refuse("has ticks that do not fit its steps");
  if (after.keyframes - before.keyframes > steps) refuse("has more keyframes than steps");
  // Events have no bound of their own but the file's size; deflate cannot shrink keyframes more than 1032 to 1.
  if ((after.events - before.events) > fileBytes_ || (after.keyframeWords - before.keyframeWords) / 130 > fileBytes_) {
    refuse("claims more rows than the file can hold");
  }
}

void ColumnReader::readBlock(const StatusRow& before, const StatusRow& after, bool withKeyframes, Block& block) const {
  const std::array<std::uint64_t, streamCount> first = countsOf(before);
  block.rows = countsOf(after);
  for (std::size_t s = 0; s < streamCount; ++s) block.rows[s] -= first[s];
  for (const Stream raw : {Stream::rawLeft, Stream::rawRight}) block.rows[static_cast<std::size_t>(raw)] = 0;
  block.rawDropped.fill(0);
  block.completed = after.completed;
  block.outcome = after.outcome;
  for (std::size_t c = 0; c < layout_.columns.size(); ++c) {
    const auto stream = static_cast<std::size_t>(layout_.columns[c].stream);
    if ((c == layout_.keyframeWords && !withKeyframes) || c == layout_.raw[0] || c == layout_.raw[1]) {
      block.column[c].clear();
      continue;
    }
    read(rows_[c], first[stream], block.rows[stream], block.column[c]);
  }
}

void ColumnReader::readRaw(const StatusRow& before, const StatusRow& after, Block& block) const {
  for (std::size_t h = 0; h < layout_.raw.size(); ++h) {
    const Column& column = layout_.columns[layout_.raw[h]];
    std::vector<std::byte>& bytes = block.column[layout_.raw[h]];
    const std::uint64_t rows = after.rawSamples[h] - before.rawSamples[h];
    block.rows[static_cast<std::size_t>(column.stream)] = rows;
    block.rawDropped[h] = after.rawDropped[h] - before.rawDropped[h];
    read(rows_[layout_.raw[h]], before.rawSamples[h], rows, bytes);
    RawSample raw;
    std::optional<std::uint64_t> sequence;
    for (std::uint64_t i = 0; i < rows; ++i) {
      const auto row = std::span(bytes).subspan(static_cast<std::size_t>(i) * rawSampleBytes);
      raw.sample.hand = static_cast<Hand>(h);
      std::string fault = parseRow(row, raw);
      if (raw.tick < before.ticks || raw.tick >= after.ticks) fault = "belongs to a tick outside its flush";
      if (sequence && raw.sample.sequence <= *sequence) fault = "is out of order";
      sequence = raw.sample.sequence;
      if (!fault.empty()) throw damaged(path_, column.path, fmt::format("row {} {}", before.rawSamples[h] + i, fault));
    }
  }
}

KeyframeReader::KeyframeReader(std::filesystem::path path, const Layout& layout, const ColumnReader& columns,
                               const StatusRow& last)
    : path_(std::move(path)), layout_(layout), columns_(columns), totalWords_(last.keyframeWords) {
  if (layout.minimal && (last.keyframes | last.keyframeWords) != 0)
    throw damaged(path_, "/status", "counts keyframes, and a golden recording has none");
  const auto refuse = [this](std::uint64_t row, const char* why) {
    throw damaged(path_, "/keyframes/index", fmt::format("row {} {}", row, why));
  };
  std::vector<std::byte> bytes;
  columns.readRows(layout.keyframeIndex, 0, last.keyframes, bytes);
  const std::uint64_t total = totalWords_ * 8;
  for (std::size_t i = 0; i < last.keyframes; ++i) {
    KeyframeRow k;
    static_cast<void>(parseRow(std::span(bytes).subspan(i * keyframeBytes), k));
    if (k.step >= last.steps || (i > 0 && k.step <= rows_.back().step)) refuse(i, "is out of order");
    // Coded ones are made of their own words and of those before them.
    const std::uint64_t most = layout.codedKeyframes ? total : total - std::min(total, k.offset);
    if (k.offset > total || k.stateBytes > most || k.hapticsBytes > most - k.stateBytes)
      refuse(i, "points outside /keyframes/bytes");
    if (layout.codedKeyframes && (k.offset % 8 != 0 || (i > 0 && k.offset <= rows_.back().offset)))
      refuse(i, "has an offset that does not rise by whole words");
    rows_.push_back(k);
    steps_.push_back(k.step);
  }
}

Keyframe KeyframeReader::read(std::size_t index) {
  const KeyframeRow& row = rows_.at(index);
  const std::vector<std::byte> bytes = layout_.codedKeyframes ? decoded(index) : plain(index);
  const auto haptics = bytes.begin() + static_cast<std::ptrdiff_t>(row.stateBytes);
  return {row.step, {bytes.begin(), haptics}, {haptics, bytes.end()}};
}

std::vector<std::byte> KeyframeReader::plain(std::size_t index) const {
  const KeyframeRow& row = rows_[index];
  const std::uint64_t first = row.offset / 8;
  const std::uint64_t end = (row.offset + row.stateBytes + row.hapticsBytes + 7) / 8;
  std::vector<std::byte> bytes;
  const hdf5::Session session;
  columns_.readRows(layout_.keyframeWords, first, end - first, bytes);
  bytes.erase(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(row.offset % 8));
  bytes.resize(static_cast<std::size_t>(row.stateBytes + row.hapticsBytes));
  return bytes;
}

std::vector<std::uint64_t> KeyframeReader::words(std::size_t index) const {
  const std::uint64_t first = rows_[index].offset / 8;
  const std::uint64_t end = index + 1 < rows_.size() ? rows_[index + 1].offset / 8 : totalWords_;
  std::vector<std::byte> bytes;
  const hdf5::Session session;
  columns_.readRows(layout_.keyframeWords, first, end - first, bytes);
  std::vector<std::uint64_t> words(bytes.size() / 8);
  std::memcpy(words.data(), bytes.data(), bytes.size());
  return words;
}

Error KeyframeReader::refused(std::size_t index, const std::string& why) const {
  return damaged(path_, "/keyframes/bytes", fmt::format("the keyframe of step {} {}", rows_[index].step, why));
}

const std::vector<std::byte>& KeyframeReader::decoded(std::size_t index) {
  // From the one that is wanted back to the first whose base is known, or that has none.
  struct Coded {
    std::size_t index;
    std::vector<std::uint64_t> words;
  };
  std::vector<Coded> way;
  for (std::size_t at = index; !known_.contains(at);) {
    if (way.size() == maxKeyframeWay) throw refused(index, "lies too many others away from one that stands alone");
    way.push_back({at, words(at)});
    const CodedKeyframe coded(way.back().words, at);
    if (!coded.fault().empty()) throw refused(at, coded.fault());
    if (!coded.base()) break;
    at = static_cast<std::size_t>(*coded.base());
  }
  for (; !way.empty(); way.pop_back()) {
    const std::size_t at = way.back().index;
    const CodedKeyframe coded(way.back().words, at);
    std::span<const std::byte> base;
    if (coded.base()) base = known_.at(static_cast<std::size_t>(*coded.base())).bytes;
    Known now{{}, coded.base()};
    const std::string fault = coded.decode(base, rows_[at].stateBytes + rows_[at].hapticsBytes, now.bytes);
    if (!fault.empty()) throw refused(at, fault);
    known_.insert_or_assign(at, std::move(now));
  }
  forgetAllBut(index);
  return known_.at(index).bytes;
}

void KeyframeReader::forgetAllBut(std::size_t index) {
  std::map<std::size_t, Known> kept;
  std::size_t bytes = 0;
  for (std::optional<std::uint64_t> at = index; at;) {
    const auto entry = known_.find(static_cast<std::size_t>(*at));
    if (entry == known_.end()) break;
    at = entry->second.base;
    bytes += entry->second.bytes.size();
    if (bytes > maxKnownBytes && !kept.empty()) break;
    kept.insert(known_.extract(entry));
  }
  known_ = std::move(kept);
}

}  // namespace calot::recorder
