// SPDX-License-Identifier: GPL-3.0-or-later
// Reading and checking the rows of a recording. Internal to this folder.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "recorder/recording/block.h"
#include "recorder/recording/hdf5.h"
#include "recorder/recording/layout.h"
#include "recorder/recording/reader.h"

namespace calot::recorder {

/// The data sets of the columns, with type and shape checked.
class ColumnReader {
 public:
  ColumnReader(std::filesystem::path path, const hdf5::Id& file, const Layout& layout, std::uint64_t fileBytes);

  /// How many rows of /status the file claims; at least one.
  [[nodiscard]] std::uint64_t statusRows() const { return statusRows_; }
  [[nodiscard]] StatusRow readStatus(std::uint64_t row) const;
  /// The counts of raw samples that belong to a row of /status, checked against those of the row before it (or of an
  /// empty one). Nothing where there is no /device. @throws Error damaged; `out` is as it was.
  void readRawCounts(const StatusRow& before, std::uint64_t row, StatusRow& out) const;

  /// Rows of every column between two rows of /status but for raw samples, after checking that they fit each other and
  /// the data sets.
  /// @param withKeyframes false leaves /keyframes/bytes out.
  void readBlock(const StatusRow& before, const StatusRow& after, bool withKeyframes, Block& block) const;

  /// Raw samples between two rows of /status, each checked. @throws Error damaged naming data set and row.
  void readRaw(const StatusRow& before, const StatusRow& after, Block& block) const;

  /// Checks that a row of /status can follow another. @throws Error damaged naming its number.
  void checkFollows(const StatusRow& before, const StatusRow& after, std::uint64_t row) const;

  void readRows(std::size_t column, std::uint64_t first, std::uint64_t rows, std::vector<std::byte>& out) const;

 private:
  struct Source {
    hdf5::Id dataset, type;
    std::uint64_t rows = 0;
  };
  Source open(const hdf5::Id& file, const Column& column) const;
  void read(const Source& source, const Column& column, std::uint64_t first, std::uint64_t rows,
            std::vector<std::byte>& out) const;

  std::filesystem::path path_;
  const Layout& layout_;
  std::uint64_t fileBytes_;
  std::vector<Source> source_;
  Column statusColumn_, rawCountsColumn_;
  Source status_, rawCounts_;
  std::uint64_t statusRows_ = 0;
};

}  // namespace calot::recorder
