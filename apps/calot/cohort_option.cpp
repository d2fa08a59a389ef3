// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/calot/cohort_option.h"

#include <algorithm>

namespace calot::apps {
namespace {

/// The parser fills positional arguments in order and cannot know that a later option makes one of them unnecessary.
bool hasCohortOption = false;

}  // namespace

void lookForCohort(const std::vector<std::string>& words) {
  hasCohortOption = std::any_of(words.begin(), words.end(), [](const std::string& word) {
    return word == "--cohort" || word.starts_with("--cohort=");
  });
}

CLI::Option* addCohortOption(CLI::App& command, std::string& database, const std::string& help) {
  return command.add_option(hasCohortOption ? "--cohort" : "cohort,--cohort", database, help);
}

}  // namespace calot::apps
