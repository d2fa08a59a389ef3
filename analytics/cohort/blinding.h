// SPDX-License-Identifier: GPL-3.0-or-later
// Blinding (schemas/cohort/0007_blinding.sql): masked groups and locked analyses of protocols; packs of films and a
// form for raters, who know the films by random names alone. The key stands in the cohort database.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "analytics/cohort/cohort_database.h"

namespace calot::analytics {

/// An analysis as it stood when it was locked, after which its groups are named.
struct AnalysisLock {
  std::string protocolSha256;
  std::string protocol;      ///< name and version
  std::string options;       ///< analysisOptions()
  std::string valuesSha256;  ///< analysisDigest()
  std::string software;
  std::string lockedUtc, by;
};

/// True if the protocol's second population is "group 1"; none: never masked. @throws Error as CohortDatabase
std::optional<bool> readGroupMask(const std::string& path, const std::string& protocolSha256);
/// Before groups are named by an analysis that is not the masked one.
/// @param protocolSha256 of the analysis' protocol, or empty
/// @throws Error (refused) where groups are masked for another protocol whose analysis is not locked.
void refuseWhileMasked(const std::string& path, const std::string& protocolSha256);
/// The same, drawn from the system's source of randomness and stored unless there is one already; audited.
bool drawGroupMask(const std::string& path, const std::string& protocolSha256);

std::optional<AnalysisLock> readAnalysisLock(const std::string& path, const std::string& protocolSha256);
/// Stores a lock with the present time, audited; one that is there stays and is returned. @param[out] added whether it
/// is new. @throws Error (invalid) where nobody locks it
AnalysisLock storeAnalysisLock(const std::string& path, const AnalysisLock& lock, bool& added);

/// Number of studies of the protocol that showed named groups before its analysis was locked, by their notes in the
/// audit. @param note of another one, which is added first; or empty
std::uint64_t studyRuns(const std::string& path, const std::string& protocolSha256, const std::string& note = {});

struct PackedFilm {
  std::string name;     ///< random
  std::string attempt;  ///< uuid
};

/// One rater's part of a pack.
struct PackedRater {
  std::string rater;              ///< pseudonym
  std::vector<PackedFilm> films;  ///< in the order in which the rater sees them; those of withdrawn attempts are gone
};

struct RatingPack {
  std::string id;  ///< random, a uuid
  StoredDocument form;
  std::vector<PackedRater> raters;
};

/// Draws names and orders from the system's source of randomness: of each rater others.
RatingPack drawRatingPack(const StoredDocument& form, const std::vector<std::string>& raters,
                          const std::vector<std::string>& attempts);

/// One transaction, audited. @throws Error as CohortDatabase; (refused) for an attempt that is not there.
void storeRatingPack(const std::string& path, const RatingPack& pack);
std::optional<RatingPack> readRatingPack(const std::string& path, const std::string& id);

/// Stores what a rater answered, and that the answers were taken: one transaction.
/// @throws Error (refused) where they were taken before, or an attempt was rated by this rater with this form, and
/// `replace` is not set; as CohortDatabase::storeRating().
void storePackAnswers(const std::string& path, const RatingPack& pack, const std::string& rater,
                      const std::vector<Rating>& ratings, bool replace);

}  // namespace calot::analytics
