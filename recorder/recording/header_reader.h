// SPDX-License-Identifier: GPL-3.0-or-later
// Reading and checking what a recording says of itself. Internal to this folder.
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "recorder/identity.h"
#include "recorder/recording/block.h"
#include "recorder/recording/hdf5.h"
#include "recorder/recording/layout.h"
#include "recorder/recording/reader.h"

namespace calot::recorder {

/// What the first bytes of an HDF5 file say of its size and its writer.
struct Superblock {
  unsigned version = 0;
  bool writing = false;         ///< its writer did not close it
  std::uint64_t endOfFile = 0;  ///< size it had when it was closed (bytes); 0 where this version does not say it simply
};
/// @throws Error damaged: there is no file, it is empty, or it is no HDF5 file.
Superblock readSuperblock(const std::filesystem::path& path);

/// Opens a file for reading: the SWMR way if its writer did not close it, plainly otherwise.
hdf5::Id openForReading(const std::filesystem::path& path, Access access);

/// Root attributes, scene, names.
AttemptHeader readHeader(const std::filesystem::path& path, const hdf5::Id& file, std::uint64_t fileBytes);

/// The data sets of the columns, with type and shape checked.
class ColumnReader {
 public:
  ColumnReader(std::filesystem::path path, const hdf5::Id& file, const Layout& layout, std::uint64_t fileBytes);

  /// How many rows of /status the file claims; at least one.
  [[nodiscard]] std::uint64_t statusRows() const { return statusRows_; }
  [[nodiscard]] StatusRow readStatus(std::uint64_t row) const;

  /// Rows of every column between two rows of /status, after checking that they fit each other and the data sets.
  /// @param withKeyframes false leaves /keyframes/bytes out.
  void readBlock(const StatusRow& before, const StatusRow& after, bool withKeyframes, Block& block) const;

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
  Column statusColumn_;
  Source status_;
  std::uint64_t statusRows_ = 0;
};

}  // namespace calot::recorder
