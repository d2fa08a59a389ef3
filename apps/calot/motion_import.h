// SPDX-License-Identifier: GPL-3.0-or-later
// What `calot import` does with each motion file, named on the command line or by a manifest.
#pragma once

#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "analytics/cohort/cohort_database.h"
#include "analytics/import_motion.h"
#include "apps/calot/metric_options.h"
#include "apps/common/exit_code.h"
#include "recorder/sources/column_map.h"
#include "recorder/sources/tracked_motion.h"

namespace calot::apps {

/// What came of one file.
struct ImportedFile {
  ExitCode code = ExitCode::yes;
  std::string how = "not stored", error;
  std::optional<recorder::TrackedMotion> motion;
  std::vector<analytics::CheckpointValue> values;
  analytics::MetricOutcomes external;

  void addExternal() { values.insert(values.end(), external.values.begin(), external.values.end()); }
};

/// @param map of a CSV file, or null. @throws Error as the readers; (invalid) for a CSV file without a map.
recorder::TrackedMotion readMotion(const std::filesystem::path& file, const recorder::ColumnMap* map);

/// Runs `read`, then `store`. A damaged file, or a conflict when it is stored, is the file's own result; what ends
/// every file (a wrong command line, a database that cannot be used) is thrown.
ImportedFile importFile(const std::function<recorder::TrackedMotion()>& read,
                        const std::function<void(ImportedFile&)>& store);

/// Computes the users' own metrics of `file.motion`, makes or opens the cohort if it is not open yet, stores all values
/// and says in `file` what came of it.
void storeImported(const std::string& cohort, std::optional<analytics::CohortDatabase>& database,
                   const analytics::MotionDeclaration& declaration, const std::vector<analytics::MetricScript>& metrics,
                   ImportedFile& file);

/// A row of the output with --json.
nlohmann::ordered_json jsonOf(const std::string& file, const ImportedFile& result);

struct ManifestOptions {
  std::string manifest, cohort, columns;
  analytics::MotionDeclaration otherwise;  ///< where the manifest says nothing
  MetricOptions metrics;
  bool json = false;
};

/// `calot import --manifest`. @return the exit code
int importManifest(const ManifestOptions& options);

}  // namespace calot::apps
