// SPDX-License-Identifier: GPL-3.0-or-later
// The first 48 bytes of a file of the latest format (HDF5 File Format Specification 3.0, II.A). Internal to this
// folder.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

namespace calot::recorder {

/// hashlittle() of lookup3 (R. Jenkins, 2006), initial value 0: the checksum of HDF5's metadata.
std::uint32_t lookup3(std::span<const unsigned char> bytes);

/// Clears the flag of an active writer in the superblock (version 2 or 3, 8-byte offsets) of a file's image.
/// @return false if it is no such superblock.
bool markClosed(std::span<unsigned char> image);

}  // namespace calot::recorder
