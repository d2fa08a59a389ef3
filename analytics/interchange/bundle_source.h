// SPDX-License-Identifier: GPL-3.0-or-later
// Data for a bundle, and original names that it must not contain.
#pragma once

#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "analytics/cohort/assessment_database.h"
#include "analytics/cohort/cohort_database.h"
#include "analytics/cohort/registers.h"
#include "analytics/interchange/cohort_bundle.h"
#include "analytics/interchange/original_names.h"

namespace calot::analytics {

/// All data for the bundle, read from the database.
struct BundleSource {
  std::vector<AttemptRow> attempts;
  std::map<std::string, Participant> participants;
  std::map<std::string, std::vector<CheckpointValue>> values;
  std::vector<Rating> ratings;
  Registers registers;
  std::vector<ExternalMetric> metrics;  ///< of external values
};

BundleSource readBundleSource(const std::string& database);

/// Reasons for which attempts are withheld, in the order in which they are checked.
const std::vector<std::string>& bundleReasons();
/// Index of the first reason that applies; equal to the number of reasons if the attempt is exported.
std::size_t whyLeftOut(const AttemptRow& attempt, const BundleSource& source, const BundleOptions& options);

/// Names of people, places, times and files.
OriginalNames originalsOf(const BundleSource& source);
/// Words that this program gave, and that a place or a thing may by chance be called by, too.
std::set<std::string> vocabularyOf(const BundleSource& source);

}  // namespace calot::analytics
