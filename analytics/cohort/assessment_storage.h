// SPDX-License-Identifier: GPL-3.0-or-later
// What the parts of AssessmentDatabase share.
#pragma once

#include <memory>
#include <string>

#include "analytics/cohort/assessment_database.h"
#include "analytics/cohort/connection.h"

namespace calot::analytics {

struct AssessmentDatabase::Storage {
  std::string path;
  std::unique_ptr<SQLite::Database> db;
};

}  // namespace calot::analytics
