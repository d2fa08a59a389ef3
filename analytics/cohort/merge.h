// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace calot::analytics {

struct CohortMerge {
  std::uint64_t participants = 0, attempts = 0;  ///< taken in
  std::uint64_t extended = 0;                    ///< attempts of which the other database had more, or had judged
  std::uint64_t rows = 0;                        ///< of all other tables, taken in
  std::uint64_t audit = 0;                       ///< rows of the audit trail, which carry no new content
  std::uint64_t filled = 0;                      ///< entries that were empty here
  std::uint64_t withdrawn = 0;                   ///< attempts that were withdrawn here and stay out
  std::vector<std::string> conflicts;            ///< one line each; then nothing was merged

  [[nodiscard]] bool changed() const { return participants + attempts + extended + rows + filled > 0; }
};

/// Merges one database into another in one transaction. Rows are matched by key (pseudonym, uuid, name), never by row
/// id. For an attempt in both, the longer recording wins and existing values are kept. Idempotent. Rows with different
/// content are conflicts: all are reported and nothing is merged.
/// @throws Error as CohortDatabase does; 2 where both are one file.
CohortMerge mergeCohorts(const std::string& into, const std::string& from);

}  // namespace calot::analytics
