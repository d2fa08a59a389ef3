// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/recording/column_reader.h"

#include <fmt/format.h>

#include <array>
#include <optional>
#include <utility>

#include "recorder/recording/types.h"

namespace calot::recorder {

using hdf5::damaged;
using hdf5::Id;

ColumnReader::ColumnReader(std::filesystem::path path, const hdf5::Id& file, const Layout& layout,
                           std::uint64_t fileBytes)
    : path_(std::move(path)), layout_(layout), fileBytes_(fileBytes) {
  // Open /status first: in a file being written, data sets opened later contain at least the rows it covers.
  statusColumn_.path = "/status";
  statusColumn_.element = Element::status;
  status_ = open(file, statusColumn_);
  rawCountsColumn_.path = std::string(rawCountsPath);
  rawCountsColumn_.element = Element::rawCounts;
  rawCountsColumn_.chunkRows = rawChunkRows;
  rawCountsColumn_.width = layout.deviceSamples ? 1 : 0;
  rawCounts_ = open(file, rawCountsColumn_);
  for (const Column& column : layout.columns) source_.push_back(open(file, column));
  statusRows_ = status_.rows;
  if (statusRows_ < 1) throw damaged(path_, "/status", "is empty");
  if (statusRows_ > fileBytes) throw damaged(path_, "/status", "claims more rows than the file can hold");
}

ColumnReader::Source ColumnReader::open(const hdf5::Id& file, const Column& column) const {
  Source s;
  s.type = hdf5::elementType(column.element);
  if (column.width == 0) return s;
  const Id how = hdf5::datasetAccess(column.rowBytes() * static_cast<std::size_t>(column.chunkRows));
  s.dataset = hdf5::dataset(H5Dopen2(file.get(), column.path.c_str(), how.get()));
  if (!s.dataset.valid()) throw damaged(path_, column.path, "is missing or cannot be read");
  const Id type = hdf5::type(H5Dget_type(s.dataset.get()));
  if (H5Tequal(type.get(), s.type.get()) <= 0) throw damaged(path_, column.path, "has the wrong type");
  const Id space = hdf5::space(H5Dget_space(s.dataset.get()));
  const int rank = column.vector ? 2 : 1;
  std::array<hsize_t, 2> extent{};
  if (H5Sget_simple_extent_ndims(space.get()) != rank ||
      H5Sget_simple_extent_dims(space.get(), extent.data(), nullptr) != rank ||
      (column.vector && extent[1] != column.width)) {
    throw damaged(path_, column.path, "has the wrong shape");
  }
  s.rows = extent[0];
  return s;
}

void ColumnReader::read(const Source& source, const Column& column, std::uint64_t first, std::uint64_t rows,
                        std::vector<std::byte>& out) const {
  out.resize(static_cast<std::size_t>(rows) * column.rowBytes());
  if (rows == 0 || column.width == 0) return;
  if (first + rows > source.rows) {
    throw damaged(path_, column.path,
                  fmt::format("holds {} rows where /status vouches for {}", source.rows, first + rows));
  }
  const std::array<hsize_t, 2> start{first, 0};
  const std::array<hsize_t, 2> count{rows, column.width};
  const Id fileSpace = hdf5::space(H5Dget_space(source.dataset.get()));
  const Id memorySpace = hdf5::space(H5Screate_simple(column.vector ? 2 : 1, count.data(), nullptr));
  if (H5Sselect_hyperslab(fileSpace.get(), H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr) < 0 ||
      H5Dread(source.dataset.get(), source.type.get(), memorySpace.get(), fileSpace.get(), H5P_DEFAULT, out.data()) <
          0) {
    throw damaged(path_, column.path, fmt::format("rows {} to {}: {}", first, first + rows - 1, hdf5::reason()));
  }
}

void ColumnReader::readRows(std::size_t column, std::uint64_t first, std::uint64_t rows,
                            std::vector<std::byte>& out) const {
  read(source_[column], layout_.columns[column], first, rows, out);
}

StatusRow ColumnReader::readStatus(std::uint64_t row) const {
  std::vector<std::byte> bytes;
  read(status_, statusColumn_, row, 1, bytes);
  StatusRow out;
  if (const std::string fault = parseStatus(bytes, out); !fault.empty())
    throw damaged(path_, "/status", fmt::format("row {} {}", row, fault));
  if (row == 0 && (out.ticks | out.steps | out.events | out.keyframes | out.keyframeWords) != 0) {
    throw damaged(path_, "/status", "row 0 does not start at nothing");
  }
  return out;
}

void ColumnReader::readRawCounts(const StatusRow& before, std::uint64_t row, StatusRow& out) const {
  if (!layout_.deviceSamples) return;
  std::vector<std::byte> bytes;
  read(rawCounts_, rawCountsColumn_, row, 1, bytes);
  StatusRow counts;
  parseRawCounts(bytes, counts);
  const auto refuse = [&](const char* why) { throw damaged(path_, rawCountsPath, fmt::format("row {} {}", row, why)); };
  for (std::size_t h = 0; h < counts.rawSamples.size(); ++h) {
    if (row == 0 && (counts.rawSamples[h] | counts.rawDropped[h]) != 0) refuse("does not start at nothing");
    if (counts.rawSamples[h] < before.rawSamples[h] || counts.rawDropped[h] < before.rawDropped[h])
      refuse("counts less than the row before it");
    if (counts.rawSamples[h] - before.rawSamples[h] > fileBytes_) refuse("claims more rows than the file can hold");
  }
  out.rawSamples = counts.rawSamples;
  out.rawDropped = counts.rawDropped;
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
    read(source_[c], layout_.columns[c], first[stream], block.rows[stream], block.column[c]);
  }
}

void ColumnReader::readRaw(const StatusRow& before, const StatusRow& after, Block& block) const {
  for (std::size_t h = 0; h < layout_.raw.size(); ++h) {
    const Column& column = layout_.columns[layout_.raw[h]];
    std::vector<std::byte>& bytes = block.column[layout_.raw[h]];
    const std::uint64_t rows = after.rawSamples[h] - before.rawSamples[h];
    block.rows[static_cast<std::size_t>(column.stream)] = rows;
    block.rawDropped[h] = after.rawDropped[h] - before.rawDropped[h];
    read(source_[layout_.raw[h]], column, before.rawSamples[h], rows, bytes);
    RawSample raw;
    std::optional<std::uint64_t> sequence;
    for (std::uint64_t i = 0; i < rows; ++i) {
      const auto row = std::span(bytes).subspan(static_cast<std::size_t>(i) * rawSampleBytes);
      std::string fault = parseRawSample(row, static_cast<Hand>(h), raw);
      if (raw.tick < before.ticks || raw.tick >= after.ticks) fault = "is of a tick outside its flush";
      if (sequence && raw.sample.sequence <= *sequence) fault = "is out of order";
      sequence = raw.sample.sequence;
      if (!fault.empty()) throw damaged(path_, column.path, fmt::format("row {} {}", before.rawSamples[h] + i, fault));
    }
  }
}

}  // namespace calot::recorder
