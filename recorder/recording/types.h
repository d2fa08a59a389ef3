// SPDX-License-Identifier: GPL-3.0-or-later
// HDF5 types and property lists of the recording. Internal to this folder.
#pragma once

#include <string>

#include "recorder/recording/hdf5.h"
#include "recorder/recording/layout.h"

namespace calot::recorder::hdf5 {

/// The stored type of an element.
Id elementType(Element element);

/// Fixed-length UTF-8 string, padded with NUL; one byte at least.
Id stringType(std::size_t bytes);

/// Access with V110 bounds. @param metadataAttempts for SWMR readers; 0: the library's default.
Id fileAccess(unsigned metadataAttempts);

/// Access to a data set through a chunk cache that holds two of its chunks: whole chunks are written once.
Id datasetAccess(std::size_t chunkBytes);

}  // namespace calot::recorder::hdf5
