// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>
#include <vector>

namespace calot::analytics {

/// A numbered step of the cohort database's schema (schemas/cohort/NNNN_name.sql).
struct Migration {
  const char* name;
  const char* sql;
};

/// All, in order; applying the first n gives schema version n.
const std::vector<Migration>& cohortMigrations();

/// assets/reference/cholecystectomy-2014-table2.json.
std::string_view publishedTable2();

}  // namespace calot::analytics
