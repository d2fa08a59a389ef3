// SPDX-License-Identifier: GPL-3.0-or-later
// What a bundle is made of, and what must not be in it.
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

/// Everything that the bundle is made of, read from the database.
struct BundleSource {
  std::vector<AttemptRow> attempts;
  std::map<std::string, Participant> participants;
  std::map<std::string, std::vector<CheckpointValue>> values;
  std::vector<Rating> ratings;
  Registers registers;
};

BundleSource readBundleSource(const std::string& database);

/// Why attempts are not handed out, in the order in which it is asked.
const std::vector<std::string>& bundleReasons();
/// Number of the reason that holds first; as many as there are reasons: the attempt is handed out.
std::size_t whyLeftOut(const AttemptRow& attempt, const BundleSource& source, const BundleOptions& options);

/// Names of people, places, times and files.
OriginalNames originalsOf(const BundleSource& source);
/// Words that this program gave, and that a place or a thing may by chance be called by, too.
std::set<std::string> vocabularyOf(const BundleSource& source);

}  // namespace calot::analytics
