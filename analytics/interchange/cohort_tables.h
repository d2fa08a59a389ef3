// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace calot::analytics {

struct ExportedTable {
  std::string name;
  std::uint64_t rows = 0;
};

/// Writes every table of a cohort database, as it is, into a new folder: TABLE.csv and TABLE.json of each, and
/// codebook.csv and codebook.json over all columns and checkpoints. One moment of the database; noted in it for
/// withdrawals before the folder gets its name. Not de-identified: writeBundle() is.
/// In CSV nothing is an empty cell and bytes are hexadecimal; numbers have as many digits as give them back.
/// @throws Error as CohortDatabase and FolderOutput do.
std::vector<ExportedTable> exportCohort(const std::string& database, const std::string& folder, bool force = false);

}  // namespace calot::analytics
