// SPDX-License-Identifier: GPL-3.0-or-later
// The parts of reading a recording: opening an untrusted file (HDF5 File Format Specification 3.0, II.A), the one shape
// that it may have (schemas/recording-integrity.md, "Shape"), its header, its rows and its keyframes, of either format
// version. Internal to this folder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "recorder/base/identity.h"
#include "recorder/engine/observer.h"
#include "recorder/recording/block.h"
#include "recorder/recording/hdf5.h"
#include "recorder/recording/layout.h"
#include "recorder/recording/reader.h"

namespace calot::recorder {

/// Size and writer of an HDF5 file according to its first bytes.
struct Superblock {
  unsigned version = 0;
  bool writing = false;         ///< its writer did not close it
  std::uint64_t endOfFile = 0;  ///< size it had when it was closed (bytes); 0 where this version does not say it simply
};
/// @throws Error damaged: there is no file, it is empty, or it is no HDF5 file.
Superblock readSuperblock(const std::filesystem::path& path);

/// 0 where it cannot be asked for.
std::uint64_t sizeOfFile(const std::filesystem::path& path);

/// Opens a file for reading: the SWMR way if its writer did not close it, plainly otherwise. Refuses one that has not
/// the shape of a recording (checkShape) before any of its data is read.
hdf5::Id openForReading(const std::filesystem::path& path, Access access);

/// Looks at every link and every data set's description, and reads no data: links to other places, second names of an
/// object, data kept in other files or made of other data sets, filters from elsewhere, values of variable length,
/// chunks that unfold to more than 4 MiB, and extents that the file cannot hold.
/// Skips objects that it cannot describe; the reader reports them. The caller holds the HDF5 session.
/// @throws Error damaged naming the object
void checkShape(const std::filesystem::path& path, const hdf5::Id& file, std::uint64_t fileBytes);

/// Closes a file that was built in memory. @return its bytes, as of a file that nobody writes; empty where that fails
std::string closedImage(hdf5::Id& file);

/// Root attributes, scene, names; whether there is a /device.
/// @throws Error damaged, naming the place.
AttemptHeader readHeader(const std::filesystem::path& path, const hdf5::Id& file, std::uint64_t fileBytes);

/// The station's key and signature, where there is a /signature. @throws Error damaged: of the wrong type or shape.
std::optional<RecordedSignature> readSignature(const std::filesystem::path& path, const hdf5::Id& file);

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
