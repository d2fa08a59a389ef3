// SPDX-License-Identifier: GPL-3.0-or-later
// calot attempt: what a person decides about an attempt.
#include <fmt/format.h>

#include <iostream>
#include <memory>
#include <string>

#include "analytics/cohort/cohort_database.h"
#include "apps/calot/cohort_lists.h"
#include "apps/calot/commands.h"
#include "apps/common/exit_code.h"
#include "recorder/errors.h"

namespace calot::apps {
namespace {

struct AttemptOptions {
  std::string attempt, cohort, reason, by;
};

void addDecision(CLI::App& parent, Run& run, bool exclude) {
  const auto o = std::make_shared<AttemptOptions>();
  CLI::App* command = exclude ? parent.add_subcommand("exclude", "Keep an attempt out of studies and norms")
                              : parent.add_subcommand("include", "Take an exclusion back");
  command->add_option("attempt", o->attempt, "Its uuid, or what it begins with")->required();
  command->add_option("--cohort", o->cohort, "Cohort database")->required();
  command->add_option("--reason", o->reason, "Why")->required();
  command->add_option("--by", o->by, "Who decides")->required();
  command->callback([o, exclude, &run] {
    run = [o, exclude] {
      analytics::CohortDatabase database(o->cohort, analytics::CohortDatabase::Access::write);
      const std::string uuid = database.attemptNamed(o->attempt);
      if (exclude) {
        database.excludeAttempt(uuid, o->reason, o->by);
      } else {
        database.includeAttempt(uuid, o->reason, o->by);
      }
      std::cout << fmt::format("{}: attempt {} {}\n", o->cohort, uuid, exclude ? "excluded" : "included again");
      return static_cast<int>(ExitCode::yes);
    };
  });
}

}  // namespace

void addAttempt(CLI::App& app, Run& run) {
  CLI::App* command = app.add_subcommand("attempt", "List attempts, keep them out of studies, or take them in again");
  command->require_subcommand(1);
  addAttemptList(*command, run);
  addDecision(*command, run, true);
  addDecision(*command, run, false);
}

}  // namespace calot::apps
