// SPDX-License-Identifier: GPL-3.0-or-later
// Manifests: tables that say, a row each, what is taken into a cohort. `calot import --manifest` takes motion files
// with who made them, and registers these participants without replacing what the cohort knows; `calot rate --manifest`
// takes completed forms.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "analytics/assess.h"
#include "analytics/cohort/cohort_database.h"
#include "recorder/base/csv.h"
#include "recorder/base/dates.h"
#include "recorder/base/errors.h"
#include "recorder/base/names.h"
#include "recorder/sources/column_map.h"

namespace calot::analytics {

/// Cells by the names of their columns, some of which may be absent.
class ManifestTable {
 public:
  /// @param known columns that a manifest of its kind may have; a name that ends with ":" stands for all that begin so.
  /// A column "note" is passed over. @throws Error (invalid) for a column that is not known, so that
  /// a misspelt one is not lost without a word, or one that is there twice.
  ManifestTable(CsvTable table, const std::vector<std::string>& known);

  [[nodiscard]] const std::string& path() const { return table_.path; }
  [[nodiscard]] const std::vector<std::string>& columns() const { return table_.columns; }
  [[nodiscard]] const std::vector<CsvRow>& rows() const { return table_.rows; }
  [[nodiscard]] bool has(const std::string& column) const { return table_.has(column); }
  /// Empty where there is no such column.
  [[nodiscard]] std::string cell(const CsvRow& row, const std::string& column) const;
  /// A file that a cell names; relative ones lie beside the manifest.
  [[nodiscard]] std::filesystem::path fileNamed(const std::string& cell) const;

  /// As CsvTable::withPoint().
  [[nodiscard]] std::string withPoint(const std::string& cell) const { return table_.withPoint(cell); }

  /// "M.csv: line 4: column "mode": FAULT" (damaged).
  [[nodiscard]] Error fault(const CsvRow& row, const std::string& column, const std::string& what,
                            const std::vector<Remedy>& remedies = {}) const;

 private:
  CsvTable table_;
};

/// Answers of whoever made a table.
struct TableReading {
  recorder::SimilarNames names = recorder::SimilarNames::ask;
  recorder::DateStyle dates = {};
};

/// An attempt as tables name it: by its uuid, or the first eight letters of it or more; in capitals, too.
/// @throws Error (refused) for less; as CohortDatabase::attemptNamed()
std::string attemptInTable(const CohortDatabase& cohort, const std::string& cell);

/// True if a name holds a line break or another control character, which could forge output.
bool holdsControl(const std::string& name);

struct MotionRow {
  std::size_t line = 0;
  std::filesystem::path file;
  std::string columns;  ///< key of MotionManifest::maps; empty: 76 columns of text
  MotionDeclaration declaration;
};

struct MotionManifest {
  std::string path;
  std::vector<MotionRow> rows;
  std::map<std::string, Participant> participants;  ///< by pseudonym, with what all of their rows say
  std::map<std::string, std::size_t> lineOf;        ///< of a participant's first row
  std::map<std::string, recorder::ColumnMap> maps;  ///< by file
};

/// Reads a manifest and checks every row: no file is read beyond whether it is there. Columns: `file`, `columns`,
/// `participant`, `group`, `arm`, `site`, `experience` ("laparoscopies=240; level=attending"), `experience:CRITERION`,
/// `consent` ("study:2026-01-31"), and those of declareMotion(). Files and maps are relative to the manifest.
/// Dates are as recorder::readMoment() has them.
/// @param otherwise what an empty cell or an absent column stands for. @param columns the map for rows without one
/// @param enrolled participants of the cohort, whose spelling of names counts
/// @param[out] faults one for each wrong row (damaged), naming line and column; with any, the manifest is not whole
/// @throws Error as readCsvTable(), recorder::spellNames() and ManifestTable; (invalid) where there is no column
/// `file`; as recorder::readColumnMap for `columns`.
MotionManifest readMotionManifest(const std::string& path, const MotionDeclaration& otherwise,
                                  const std::string& columns, const TableReading& reading,
                                  const std::vector<Participant>& enrolled, std::vector<Error>& faults);

/// A cohort's participants when this was made, and those added through it.
class Enrolment {
 public:
  explicit Enrolment(const CohortDatabase& database);

  /// Adds a participant, or fills what the cohort has empty; nothing and no audit row where there is nothing new.
  /// @param database that of the constructor. @throws Error (refused) where the cohort says something else of the
  /// participant; as CohortDatabase.
  void add(CohortDatabase& database, const Participant& wanted);

  /// A manifest's participants that the cohort describes in another way, each naming the line.
  [[nodiscard]] std::vector<Error> conflicts(const MotionManifest& manifest) const;

 private:
  /// Entries of a participant that the cohort lacks; all of them if it lacks the participant.
  [[nodiscard]] Participant additionsOf(const Participant& wanted) const;

  std::string path_;
  std::map<std::string, Participant> known_;
};

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
/// @throws Error as readCsvTable(), recorder::spellNames() and ManifestTable; as `find` and readRatingForm().
RatingManifest readRatingManifest(const std::string& path, const std::string& form, const FindForm& find,
                                  const CohortDatabase& cohort, recorder::SimilarNames similar,
                                  std::vector<Error>& faults);

struct StoredRatings {
  std::size_t added = 0, unchanged = 0, replaced = 0;
};

/// Stores what is new, all of it or nothing. The same answers again change nothing.
/// @param replace other answers of the same rater or participant; else they are refused before anything is stored, one
/// fault each. @throws Error as CohortDatabase::storeRating().
StoredRatings storeRatings(CohortDatabase& database, const RatingManifest& manifest, bool replace,
                           std::vector<Error>& faults);

}  // namespace calot::analytics
