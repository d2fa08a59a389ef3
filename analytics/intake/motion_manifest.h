// SPDX-License-Identifier: GPL-3.0-or-later
// A table of motion files with who made them: what `calot import --manifest` reads; and registering its participants,
// of whom nothing that a cohort knows is replaced.
#pragma once

#include <cstddef>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "analytics/cohort/cohort_database.h"
#include "analytics/import_motion.h"
#include "recorder/base/errors.h"
#include "recorder/sources/tracked_motion.h"

namespace calot::analytics {

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
/// @param otherwise what an empty cell or an absent column stands for. @param columns the map for rows without one
/// @param[out] faults one for each wrong row (damaged), naming line and column; with any, the manifest is not whole
/// @throws Error as readCsvTable() and ManifestTable; (invalid) where there is no column `file`; as
/// recorder::readColumnMap for `columns`.
MotionManifest readMotionManifest(const std::string& path, const MotionDeclaration& otherwise,
                                  const std::string& columns, std::vector<Error>& faults);

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

}  // namespace calot::analytics
