// SPDX-License-Identifier: GPL-3.0-or-later
// Tables for other programs: those of a cohort, with the meaning of each variable for readers without this program; and
// the motion that checkpoints are computed of.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "analytics/checkpoints/definition.h"
#include "analytics/checkpoints/motion.h"
#include "analytics/cohort/tables.h"
#include "sim/scene/samples.h"

namespace calot::analytics {

struct ExportedTable {
  std::string name;
  std::uint64_t rows = 0;
};

/// Writes every table of a cohort database, as it is, into a new folder: TABLE.csv and TABLE.json of each, and
/// codebook.csv and codebook.json over all columns and checkpoints. One moment of the database; noted in it for
/// withdrawals before the folder gets its name. Not de-identified: writeBundle() is.
/// In CSV nothing is an empty cell and bytes are hexadecimal; numbers have as many digits as give them back.
/// @throws Error as CohortDatabase and FolderOutput do.
std::vector<ExportedTable> exportCohort(const std::string& database, const std::string& folder, bool force = false);

/// A variable: a checkpoint (a row of `checkpoint_value`, or of a bundle's values.csv), or a column of a table.
struct CodebookEntry {
  std::string table = {};      ///< file without ending; of a checkpoint "checkpoint"
  std::string name = {};       ///< of the column or the checkpoint
  std::string title = {};      ///< what it is, a clause
  std::string type = {};       ///< "number", "whole number", "text", "bytes in hexadecimal"
  std::string unit = {};       ///< SI, or empty
  std::string allowed = {};    ///< allowed values; empty: any of its type
  std::string missing = {};    ///< representation of a missing value; empty: never missing
  std::string direction = {};  ///< of a checkpoint: which way is better
  std::string window = {};     ///< of a checkpoint: the part of the attempt that it covers
  std::string subjects = {};   ///< of a checkpoint: its subjects, and aggregation over instruments
  std::string formula = {};    ///< of a checkpoint
  std::string filter = {};     ///< of a checkpoint: resampling and filter with their constants
  std::string origins = {};    ///< of a checkpoint: its possible origins
  std::uint32_t version = 0;
};

/// Every checkpoint of the registry, in its order, then external metrics, whose origin says so.
std::vector<CodebookEntry> checkpointEntries(const std::vector<ExternalMetric>& external = {});

/// Columns of a declared table, in its order.
std::vector<CodebookEntry> columnEntries(const DeclaredTable& table);
/// Columns of a cohort database's table, in its order; unknown columns have an empty title.
std::vector<CodebookEntry> columnEntries(const TableFacts& table);

std::string codebookCsv(const std::vector<CodebookEntry>& entries);
std::string codebookJson(const std::vector<CodebookEntry>& entries);

/// Writes a new folder of
///
/// - `motion_left.csv`, `motion_right.csv`: a row each point on the grid of motionRate: time (s), number of the segment
///   (from 1), filtered position of the tip in the world frame (m), orientation (w, x, y, z; no columns where it is not
///   known), speed (m/s), the position before the filter (m), number of the movement (from 1; empty: in none);
/// - `spans.csv`: by hand what is `mounted`, `lost` (mounted without measurement), a `segment`, a `movement`, from
/// begin up
///   to end (s), and of segments whether they follow a gap that was too long to be bridged;
/// - `motion.json`: filter, and by hand coverage, rate, interval and threshold of movements.
///
/// Numbers are the shortest that give the same bits. @return the files. @throws Error (invalid) where the folder is
/// there; (failure) where it cannot be written
std::vector<std::filesystem::path> writeMotionTables(const std::array<Motion, handCount>& motion,
                                                     const std::filesystem::path& folder, bool force = false);

}  // namespace calot::analytics
