// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace calot::analytics {

/// What a look at a whole cohort database found.
struct CohortCheck {
  int schema = 0;
  std::uint64_t participants = 0, attempts = 0, values = 0;
  std::vector<std::string> faults;  ///< one line each; empty: it is sound
};

/// SQLite's integrity check (with the constraints of every column), foreign keys, attempts without a recording, and
/// signatures that are not of the recording's head. Changes nothing. @throws Error as CohortDatabase does.
CohortCheck checkCohort(const std::string& path);

}  // namespace calot::analytics
