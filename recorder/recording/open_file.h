// SPDX-License-Identifier: GPL-3.0-or-later
// Opening untrusted files. Internal to this folder.
#pragma once

#include <cstdint>
#include <filesystem>

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
/// the shape of a recording (shape.h) before any of its data is read.
hdf5::Id openForReading(const std::filesystem::path& path, Access access);

}  // namespace calot::recorder
