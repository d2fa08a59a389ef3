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

/// Takes everything of one database into another, which is made where there is none, in one transaction. Rows are the
/// same where their keys are: a pseudonym, a uuid, a name; never the numbers of rows. Of an attempt in both, the longer
/// recording counts and the values that are there stay. Doing it again changes nothing. Where both say different things
/// of one row, that is a conflict, every one is reported, and nothing is merged.
/// @throws Error as CohortDatabase does; (invalid) where both are one file.
CohortMerge mergeCohorts(const std::string& into, const std::string& from);

}  // namespace calot::analytics
