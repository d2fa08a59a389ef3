// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/calot/rate_files.h"

#include <fmt/format.h>

#include <iostream>
#include <nlohmann/json.hpp>
#include <vector>

#include "analytics/assessment/pack_answers.h"
#include "analytics/intake/rating_manifest.h"
#include "apps/calot/environment.h"
#include "apps/calot/motion_import.h"
#include "apps/calot/results.h"
#include "apps/common/exit_code.h"

namespace calot::apps {

int storeRatingManifest(const std::string& cohort, const std::string& manifest, const std::string& form, bool force,
                        bool json) {
  using Access = analytics::CohortDatabase::Access;
  const auto find = [](const std::string& name) { return findAsset(name, "forms", "form"); };
  std::vector<Error> faults;
  const analytics::RatingManifest read =
      analytics::readRatingManifest(manifest, form, find, analytics::CohortDatabase(cohort, Access::read), faults);
  if (!faults.empty()) return refuseRows(faults);
  analytics::AssessmentDatabase database(cohort, Access::write);
  const analytics::StoredRatings stored = analytics::storeRatings(database, read, force, faults);
  if (!faults.empty()) return refuseRows(faults);
  if (json) {
    const nlohmann::ordered_json row{{"manifest", manifest},
                                     {"ratings", read.rows.size()},
                                     {"added", stored.added},
                                     {"unchanged", stored.unchanged},
                                     {"replaced", stored.replaced}};
    printResult("rate-manifest", row);
  } else {
    std::cout << fmt::format("{}: {} ratings: {} added, {} unchanged, {} replaced\n", manifest, read.rows.size(),
                             stored.added, stored.unchanged, stored.replaced);
  }
  return static_cast<int>(ExitCode::yes);
}

int takePackAnswers(const std::string& cohort, const std::string& file, bool force) {
  const analytics::PackAnswers answers =
      analytics::readPackAnswers(file, [&](const std::string& id) { return analytics::readRatingPack(cohort, id); });
  analytics::storePackAnswers(cohort, answers.pack, answers.rater, answers.ratings, force);
  std::cout << fmt::format("{}: {} ratings by {} with {} version {} stored", file, answers.ratings.size(),
                           answers.rater, answers.form.name, answers.form.version);
  if (answers.notJudged > 0) std::cout << fmt::format(", {} films could not be judged", answers.notJudged);
  if (answers.withdrawn > 0) std::cout << fmt::format(", {} films of withdrawn attempts left out", answers.withdrawn);
  std::cout << '\n';
  return static_cast<int>(ExitCode::yes);
}

}  // namespace calot::apps
