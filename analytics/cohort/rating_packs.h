// SPDX-License-Identifier: GPL-3.0-or-later
// Packs of films and a form for raters, who know the films by random names alone. The key stands in the cohort database
// (schemas/cohort/0007_blinding.sql).
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analytics/cohort/assessment_database.h"

namespace calot::analytics {

struct PackedFilm {
  std::string name;     ///< random
  std::string attempt;  ///< uuid
};

/// One rater's part of a pack.
struct PackedRater {
  std::string rater;              ///< pseudonym
  std::string takenUtc = {};      ///< when the answers were stored; empty: not yet
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
/// `replace` is not set; as AssessmentDatabase::storeRating().
void storePackAnswers(const std::string& path, const RatingPack& pack, const std::string& rater,
                      const std::vector<Rating>& ratings, bool replace);

}  // namespace calot::analytics
