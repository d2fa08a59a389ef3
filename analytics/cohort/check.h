// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace calot::analytics {

/// Result of checking a whole cohort database.
struct CohortCheck {
  int schema = 0;
  std::uint64_t participants = 0, attempts = 0, values = 0;
  std::vector<std::string> faults;  ///< problems, one line each; empty: the database is sound
};

/// SQLite's integrity check (with the constraints of every column), foreign keys, attempts without a recording, and
/// signatures that are not of the recording's head. Changes nothing. @throws Error as CohortDatabase does.
CohortCheck checkCohort(const std::string& path);

/// Before figures of a database are shown. @throws Error (damaged) naming the first fault of checkCohort()
void refuseUnsound(const std::string& path);

}  // namespace calot::analytics
