// SPDX-License-Identifier: GPL-3.0-or-later
// Reading and checking the rows of a recording and its keyframes, of either format version. Internal to this folder.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "recorder/engine/observer.h"
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
  [[nodiscard]] std::uint64_t statusRows() const { return status_.count(); }
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

  /// Rows of one column. @throws Error damaged
  void readRows(std::size_t column, std::uint64_t first, std::uint64_t rows, std::vector<std::byte>& out) const;

 private:
  hdf5::Rows open(const hdf5::Id& file, const Column& column) const;
  void read(const hdf5::Rows& source, std::uint64_t first, std::uint64_t rows, std::vector<std::byte>& out) const;

  std::filesystem::path path_;
  const Layout& layout_;
  std::uint64_t fileBytes_;
  hdf5::Rows status_, rawCounts_;
  std::vector<hdf5::Rows> rows_;  ///< as Layout::columns
};

class KeyframeReader {
 public:
  /// Reads and checks the index. The caller holds the HDF5 session. Layout and columns outlive the reader.
  /// @throws Error damaged
  KeyframeReader(std::filesystem::path path, const Layout& layout, const ColumnReader& columns, const StatusRow& last);

  /// Steps after which there is a keyframe, rising.
  [[nodiscard]] const std::vector<std::uint64_t>& steps() const { return steps_; }

  /// Takes the HDF5 session itself. Keeps what the next ones will be compared with, so that reading in order is cheap.
  /// @throws Error damaged
  Keyframe read(std::size_t index);

 private:
  struct Known {
    std::vector<std::byte> bytes;
    std::optional<std::uint64_t> base;
  };
  [[nodiscard]] std::vector<std::byte> plain(std::size_t index) const;
  [[nodiscard]] std::vector<std::uint64_t> words(std::size_t index) const;
  const std::vector<std::byte>& decoded(std::size_t index);
  /// Keeps what the way to a keyframe needs.
  void forgetAllBut(std::size_t index);
  [[nodiscard]] Error refused(std::size_t index, const std::string& why) const;

  std::filesystem::path path_;
  const Layout& layout_;
  const ColumnReader& columns_;
  std::uint64_t totalWords_;
  std::vector<KeyframeRow> rows_;
  std::vector<std::uint64_t> steps_;
  std::map<std::size_t, Known> known_;
};

}  // namespace calot::recorder
