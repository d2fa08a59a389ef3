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

namespace tables {

/// A filled form, and the form itself where it is not there yet; begins no transaction. @throws Error as
/// AssessmentDatabase::storeRating().
void putRating(SQLite::Database& db, const std::string& path, const StoredDocument& form, const Rating& rating,
               bool replace);

}  // namespace tables

}  // namespace calot::analytics
