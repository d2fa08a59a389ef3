// SPDX-License-Identifier: GPL-3.0-or-later
// The tables of a cohort database, each column declared once: name, SQLite's type, meaning, unit, values, and the
// member of the struct that holds it. schemas/cohort/*.sql makes them; statements (tables.h), `cohort check`, lists,
// codebook and exports follow from the declaration. A new column takes its line here, its member and a migration.
#pragma once

#include <SQLiteCpp/SQLiteCpp.h>

#include <string_view>
#include <vector>

#include "analytics/cohort/assessment_database.h"
#include "analytics/cohort/blinding.h"
#include "analytics/cohort/registers.h"

namespace calot::analytics {

/// Moves one member between its struct and a statement or a list; empty where no struct holds the column.
struct ColumnMember {
  void (*bind)(SQLite::Statement& statement, int index, const void* row) = nullptr;
  void (*read)(const SQLite::Column& from, void* row) = nullptr;
  FieldValue (*value)(const void* row) = nullptr;
};

struct DeclaredColumn {
  const char* name;
  const char* type;  ///< as in the schema: "REAL", or "REAL NOT NULL"
  const char* meaning;
  ColumnMember member = {};
  const char* unit = "";
  const char* allowed = "";  ///< empty: any value of the type
  const char* missing = "";  ///< what stands where there is none; empty: never missing
  const char* listed = "";   ///< its name in lists (fieldsOf()); empty: `name`
};

struct DeclaredTable {
  const char* name;
  std::vector<DeclaredColumn> columns;
};

/// A table whose members are of `Row`.
template <class Row>
struct TableOf : DeclaredTable {};

const TableOf<Participant>& participantTable();
const TableOf<AttemptRecord>& attemptTable();
const TableOf<AttemptRecord>& recordingTable();
const TableOf<RecordingSignature>& signatureTable();
const TableOf<Verification>& verificationTable();
const TableOf<CheckpointValue>& checkpointValueTable();
const TableOf<ExternalMetric>& externalMetricTable();
const TableOf<CheckpointValue>& externalValueTable();
const TableOf<ValueInterval>& valueIntervalTable();
const TableOf<Station>& stationTable();
const TableOf<RegisteredProtocol>& protocolTable();
const TableOf<StoredDocument>& formTable();
const TableOf<AnalysisLock>& analysisLockTable();
const TableOf<Norm>& normTable();
const TableOf<NormCheckpoint>& normCheckpointTable();
const TableOf<NormEvidence>& normEvidenceTable();

/// All of them, with those that no struct holds.
const std::vector<const DeclaredTable*>& cohortTables();
/// A column of one of them; null where there is none.
const DeclaredColumn* findColumn(std::string_view table, std::string_view column);

}  // namespace calot::analytics
