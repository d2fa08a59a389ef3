// SPDX-License-Identifier: GPL-3.0-or-later
// Writes one share's values file; a run that was cut short is taken up by the next (schemas/values.md).
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <set>

#include "analytics/shards/checked_lines.h"
#include "analytics/shards/values_header.h"
#include "analytics/shards/values_row.h"

namespace calot::analytics {

/// Lines are appended to PATH.part, which takes its name when finish() has written the last one. What an earlier run of
/// the same header wrote, is kept; one of another header (another plan, other definitions) is begun again.
class ValuesWriter {
 public:
  /// @param replace a complete file of another header, or of this one
  /// @throws Error: invalid, where the file is there and is of another header; failure, where another program is
  /// writing it.
  ValuesWriter(std::filesystem::path path, ValuesHeader header, bool replace);

  /// The whole file is there already: there is nothing to do.
  [[nodiscard]] bool complete() const { return complete_; }
  /// Positions of recordings that an earlier run has done.
  [[nodiscard]] const std::set<std::uint64_t>& done() const { return done_; }

  /// After it returned, the row outlives the program. @pre !complete() @throws Error (failure)
  void append(const ValuesRow& row);
  /// @pre as many rows were written as the header says @throws Error (failure)
  void finish();

 private:
  /// @returns how many bytes of the unfinished file are good.
  std::uint64_t takeUp(const std::filesystem::path& part);
  [[nodiscard]] bool isComplete() const;

  std::filesystem::path path_;
  ValuesHeader header_;
  std::unique_ptr<LineAppender> out_;
  std::set<std::uint64_t> done_;
  bool complete_ = false;
};

}  // namespace calot::analytics
