// SPDX-License-Identifier: GPL-3.0-or-later
// Opening untrusted files: their first 48 bytes (HDF5 File Format Specification 3.0, II.A), and the one shape that
// files of recordings have (schemas/recording-integrity.md, "Shape"). Internal to this folder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>

#include "recorder/recording/hdf5.h"
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

}  // namespace calot::recorder
