// SPDX-License-Identifier: GPL-3.0-or-later
// What the parts of CohortDatabase share.
#pragma once

#include <memory>
#include <string>

#include "analytics/cohort/cohort_database.h"
#include "analytics/cohort/connection.h"

namespace calot::analytics {

struct CohortDatabase::Storage {
  std::string path;
  std::unique_ptr<SQLite::Database> db;
};

}  // namespace calot::analytics
