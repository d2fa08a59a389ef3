// SPDX-License-Identifier: GPL-3.0-or-later
// De-identified export of a cohort (docs/reference/cohort.md, "Handing out").
// Data for a bundle, and original names that it must not contain.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "analytics/cohort/assessment_database.h"
#include "analytics/cohort/cohort_database.h"
#include "analytics/cohort/registers.h"
#include "analytics/interchange/bundle_names.h"
#include "analytics/interchange/folder_output.h"
#include "analytics/report/study.h"

namespace calot::analytics {

struct BundleOptions {
  std::string scope = "research";  ///< the purpose to which participants have consented
  bool includeSynthetic = false;   ///< performers' attempts, too
};

struct Bundle {
  std::uint64_t participants = 0, attempts = 0, values = 0;
  std::uint64_t recruited = 0;   ///< attempts in the database
  std::vector<FlowRow> leftOut;  ///< attempts, by reason, in the order in which they are asked
  std::uint64_t smallest = 0;    ///< participants in the smallest group that shares group, arm and site
  std::vector<WrittenFile> files;
  bool synthetic = false;  ///< holds attempts of performers: watermarked
};

/// Writes participants, experience, attempts, values, ratings and questionnaires as CSV, the codebook and a manifest
/// with the SHA-256 of each file into a new folder.
///
/// Includes attempts of participants who have consented to the scope and have not withdrawn, if their recordings are
/// complete and unaltered and nobody excluded them. Pseudonyms, attempts and raters get new random names, kept nowhere;
/// sites, calibrations and comparability keys get numbers. Each participant's dates are moved by one random length of
/// time of 30 to 365 days, earlier or later, kept nowhere. Omitted entirely: stations and keys, seeds and chain heads,
/// file names, notes, reasons of exclusion, audit, protocols, norms, words of experience that fewer than three
/// participants share, and recordings. These contain pseudonym, start and station under a content chain that a
/// rewritten copy would break, and hand motion, which may identify a person.
///
/// Before the folder gets its name, every cell and word in it is looked up among the originals, and what is handed out
/// is noted in the database for withdrawals: where the one finds something or the other fails, there is no bundle.
/// @throws Error as CohortDatabase and FolderOutput do; Error (refused) where nothing is left to hand out, or an
/// original name is found, with the file and what kind of name it is.
Bundle writeBundle(const std::string& database, const std::string& folder, const BundleOptions& options,
                   bool force = false);

/// manifest.json of a bundle: its content, what was withheld, and how names and dates were changed. @param bundle with
/// all of its files but this one. @param scope to which the participants have consented.
std::string bundleManifest(const Bundle& bundle, const std::string& scope);

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
