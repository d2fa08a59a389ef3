// SPDX-License-Identifier: GPL-3.0-or-later
// De-identified export of a cohort (docs/reference/cohort.md, "Handing out").
#pragma once

#include <cstdint>
#include <string>
#include <vector>

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

}  // namespace calot::analytics
