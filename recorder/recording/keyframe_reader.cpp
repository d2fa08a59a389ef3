// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/recording/keyframe_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <utility>

#include "recorder/recording/keyframe_code.h"

namespace calot::recorder {

namespace {

/// How many bytes of decoded keyframes are kept for the next ones.
constexpr std::size_t maxKnownBytes = std::size_t{64} << 20U;

}  // namespace

KeyframeReader::KeyframeReader(std::filesystem::path path, const Layout& layout, const ColumnReader& columns,
                               const StatusRow& last)
    : path_(std::move(path)), layout_(layout), columns_(columns), totalWords_(last.keyframeWords) {
  if (layout.minimal && (last.keyframes | last.keyframeWords) != 0)
    throw hdf5::damaged(path_, "/status", "counts keyframes, and a golden recording has none");
  const auto refuse = [this](std::uint64_t row, const char* why) {
    throw hdf5::damaged(path_, "/keyframes/index", fmt::format("row {} {}", row, why));
  };
  std::vector<std::byte> bytes;
  columns.readRows(layout.keyframeIndex, 0, last.keyframes, bytes);
  const std::uint64_t total = totalWords_ * 8;
  for (std::size_t i = 0; i < last.keyframes; ++i) {
    const KeyframeRow k = parseKeyframeRow(std::span(bytes).subspan(i * keyframeBytes));
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
  {
    const hdf5::Session session;
    columns_.readRows(layout_.keyframeWords, first, end - first, bytes);
  }
  bytes.erase(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(row.offset % 8));
  bytes.resize(static_cast<std::size_t>(row.stateBytes + row.hapticsBytes));
  return bytes;
}

std::vector<std::byte> KeyframeReader::words(std::size_t index) const {
  const std::uint64_t first = rows_[index].offset / 8;
  const std::uint64_t end = index + 1 < rows_.size() ? rows_[index + 1].offset / 8 : totalWords_;
  std::vector<std::byte> bytes;
  const hdf5::Session session;
  columns_.readRows(layout_.keyframeWords, first, end - first, bytes);
  return bytes;
}

Error KeyframeReader::refused(std::size_t index, const std::string& why) const {
  return hdf5::damaged(path_, "/keyframes/bytes", fmt::format("the keyframe of step {} {}", rows_[index].step, why));
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
    const std::vector<std::byte> bytes = words(at);
    std::vector<std::uint64_t> code(bytes.size() / 8);
    std::memcpy(code.data(), bytes.data(), code.size() * 8);
    way.push_back({at, std::move(code)});
    const CodedKeyframe coded(way.back().words, at);
    if (!coded.fault().empty()) throw refused(at, coded.fault());
    if (!coded.base()) break;
    at = static_cast<std::size_t>(*coded.base());
  }
  for (; !way.empty(); way.pop_back()) {
    const std::size_t at = way.back().index;
    const CodedKeyframe coded(way.back().words, at);
    const std::span<const std::byte> base =
        coded.base() ? std::span<const std::byte>(known_.at(static_cast<std::size_t>(*coded.base())).bytes)
                     : std::span<const std::byte>{};
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
