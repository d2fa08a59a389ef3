// SPDX-License-Identifier: GPL-3.0-or-later
// A State as an HDF5 file of named arrays, for looking at and for comparing two builds (`calot state`, `calot diff`).
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "recorder/engine/state_fields.h"

namespace calot::recorder {

/// Attributes: `format` ("calot-state"), `simulation_version`, `step`. One data set a field,
/// "/000/organ.liver/position": the number keeps the order of the digests; reals are f8, whole numbers u8; nothing is
/// compressed, all has fletcher32.
/// @throws Error failure: it cannot be written; invalid: it is there and force is not set.
void writeStateFile(const std::filesystem::path& file, std::uint64_t step, std::uint32_t simulationVersion,
                    const std::vector<StateField>& fields, bool force);

struct StateFile {
  std::uint64_t step = 0;
  std::uint32_t simulationVersion = 0;
  std::vector<StateField> fields;  ///< in order
};

/// Reads it in a child process. @throws Error damaged, naming the file and the place.
StateFile readStateFile(const std::filesystem::path& file);

}  // namespace calot::recorder
