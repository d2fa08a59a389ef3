// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/kept/result_reader.h"

#include <fmt/format.h>

#include <algorithm>

#include "recorder/recording/row_visitor.h"

namespace calot::recorder {

namespace {

/// Golden recordings hold no results; engines send them all the same.
AttemptHeader withResults(AttemptHeader header) {
  if (isMinimal(header)) header.purpose.clear();
  return header;
}

}  // namespace

ResultReader::ResultReader(const AttemptHeader& header) : layout_(withResults(header)) {
  const std::size_t end = layout_.tickColumns + layout_.stepColumns;
  first_ = layout_.tickColumns;
  while (first_ < end && !layout_.columns[first_].path.starts_with("/observables")) ++first_;
  offset_.push_back(0);
  for (std::size_t c = first_; c < end; ++c) offset_.push_back(offset_.back() + layout_.columns[c].rowBytes());
}

std::string ResultReader::fault(const std::vector<wire::Column>& declared) const {
  std::vector<wire::Column> ours;
  for (std::size_t c = 0; c + 1 < offset_.size(); ++c) {
    const Column& column = layout_.columns[first_ + c];
    if (column.width > 0)
      ours.push_back({column.path, numberType(column.element), static_cast<std::uint32_t>(column.width)});
  }
  if (ours == declared) return "";
  const auto differing = std::mismatch(ours.begin(), ours.end(), declared.begin(), declared.end());
  return differing.first == ours.end() ? fmt::format("{} is no result of the recording", differing.second->path)
                                       : fmt::format("{} is no result of the engine", differing.first->path);
}

std::string ResultReader::read(std::span<const std::byte> row, StepResult& result, RecordedProcedure& procedure) const {
  if (row.size() != offset_.back())
    return fmt::format("results have {} bytes instead of {}", row.size(), offset_.back());
  const auto place = [&](std::size_t column) { return row.data() + offset_[column - first_]; };
  RowVisitor<decltype(place)> visit{layout_, place, first_, false, {}};
  visitResult(result, visit);
  if (layout_.procedure) visitProcedure(procedure, visit);
  return visit.fault;
}

}  // namespace calot::recorder
