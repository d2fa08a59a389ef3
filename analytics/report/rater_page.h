// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "analytics/assessment/rating_form.h"

namespace calot::analytics {

/// Content of a rater's page: neither attempt nor participant, group or figures.
struct RatingPage {
  std::string pack, rater;
  RatingForm form;
  std::vector<std::string> films;  ///< random names, in the order to watch; each is films/NAME.mp4
};

/// One page in which a rater watches films and fills in a form for each. It loads nothing but its films, sends nothing,
/// and gives the answers as a file to save (docs/how-to/ratings.md, readPackAnswers()).
std::string ratingPageHtml(const RatingPage& page);

/// Parts of the page. Its content security policy names their digests, so that nothing else runs in it.
const char* ratingPageStyle();
const char* ratingPageScript();

}  // namespace calot::analytics
