// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "analytics/assessment/rating_form.h"
#include "analytics/cohort/blinding.h"

namespace calot::analytics {

/// Answers saved by a rater's page, with the films' names resolved.
struct PackAnswers {
  RatingPack pack;
  RatingForm form;
  std::string rater;
  std::vector<Rating> ratings;
  std::size_t notJudged = 0;  ///< films of which the rater could judge no item
  std::size_t withdrawn = 0;  ///< films of attempts that were withdrawn since
};

/// Reads and checks the file that a rating page saved: {"format": "calot-answers", "formatVersion": 1, "pack", "rater",
/// "films": [{"film", "scores": {ITEM: "SCORE" or "-"}}]}; a "seal", which earlier pages wrote, is not read.
/// @param find the pack of that id, if there is one
/// @throws Error (damaged) for a malformed file; (refused) for a pack or rater that is not known, a film that is
/// missing or there twice.
PackAnswers readPackAnswers(const std::filesystem::path& file,
                            const std::function<std::optional<RatingPack>(const std::string& id)>& find);

}  // namespace calot::analytics
