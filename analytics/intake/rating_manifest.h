// SPDX-License-Identifier: GPL-3.0-or-later
// A table of completed forms, a row each: what `calot rate --manifest` reads.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "analytics/cohort/assessment_database.h"
#include "analytics/cohort/cohort_database.h"
#include "recorder/base/errors.h"

namespace calot::analytics {

struct RatingRow {
  std::size_t line = 0;
  std::size_t form = 0;  ///< of RatingManifest::forms
  Rating rating;
};

struct RatingManifest {
  std::string path;
  std::vector<StoredDocument> forms;
  std::vector<RatingRow> rows;
};

/// Path of a form's file, by its name or path. @throws Error
using FindForm = std::function<std::filesystem::path(const std::string& name)>;

/// Reads a table and checks every row against its form and the cohort's attempts. Columns: `form`; `attempt` (uuid or
/// the beginning of one), `file` (name of the recording or motion file), or `participant` (who filled in a
/// questionnaire, or whose only attempt was rated); `rater`; and one an item of the forms, empty, - or NA where it was
/// left blank.
/// @param form of rows without one. @param[out] faults one for each wrong row, naming line and column
/// @throws Error as readCsvTable() and ManifestTable; as `find` and readRatingForm().
RatingManifest readRatingManifest(const std::string& path, const std::string& form, const FindForm& find,
                                  const CohortDatabase& cohort, std::vector<Error>& faults);

struct StoredRatings {
  std::size_t added = 0, unchanged = 0, replaced = 0;
};

/// Stores what is new, all of it or nothing. The same answers again change nothing.
/// @param replace other answers of the same rater or participant; else they are refused before anything is stored, one
/// fault each. @throws Error as AssessmentDatabase::storeRating().
StoredRatings storeRatings(AssessmentDatabase& database, const RatingManifest& manifest, bool replace,
                           std::vector<Error>& faults);

}  // namespace calot::analytics
