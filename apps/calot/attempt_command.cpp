// SPDX-License-Identifier: GPL-3.0-or-later
// calot attempt: what a person decides about an attempt.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "analytics/cohort/cohort_database.h"
#include "apps/calot/cohort_lists.h"
#include "apps/calot/command.h"
#include "apps/calot/help.h"
#include "apps/common/program.h"
#include "recorder/base/errors.h"

namespace calot::apps {
namespace {

struct AttemptOptions {
  std::string attempt, cohort, reason, by, tag;
  std::string change = "add";  ///< or "remove"
  bool json = false;
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
        database.excludeAttempts({uuid}, o->reason, o->by);
      } else {
        database.includeAttempts({uuid}, o->reason, o->by);
      }
      std::cout << fmt::format("{}: attempt {} {}\n", o->cohort, uuid, exclude ? "excluded" : "included again");
      return static_cast<int>(ExitCode::yes);
    };
  });
}

int tag(const AttemptOptions& o) {
  analytics::CohortDatabase database(o.cohort, analytics::CohortDatabase::Access::write);
  const std::string uuid = database.attemptNamed(o.attempt);
  const bool add = o.change == "add";
  const std::size_t changed =
      add ? database.tagAttempts({uuid}, o.tag, o.by) : database.untagAttempts({uuid}, o.tag, o.by);
  if (!add && changed == 0)
    throw Error(ErrorKind::refused, Where{o.cohort}, fmt::format("attempt {} has no tag \"{}\"", uuid, o.tag));
  const std::vector<std::string> tags = database.attempt(uuid)->tags;
  if (o.json) {
    printResult("attempt-tag", {{"attempt", uuid}, {"tags", tags}, {"changed", changed > 0}});
  } else {
    std::cout << fmt::format("{}: attempt {}: {}\n", o.cohort, uuid,
                             tags.empty() ? "no tags" : fmt::format("tags {}", fmt::join(tags, ", ")));
  }
  return static_cast<int>(ExitCode::yes);
}

void addTag(CLI::App& parent, Run& run) {
  const auto o = std::make_shared<AttemptOptions>();
  CLI::App* command = parent.add_subcommand("tag", "Put a word on an attempt to find it by, or take it off");
  command->add_option("attempt", o->attempt, "Its uuid, or what it begins with")->required();
  command->add_option("change", o->change, "add, or remove")->required()->check(oneOf({"add", "remove"}));
  command->add_option("tag", o->tag, "The word: 1 to 40 characters, no blanks or commas")->required();
  command->add_option("--cohort", o->cohort, "Cohort database")->required();
  command->add_option("--by", o->by, "Who decides")->required();
  command->add_flag("--json", o->json, "Print JSON");
  command->callback([o, &run] { run = [o] { return tag(*o); }; });
}

}  // namespace

void addAttempt(CLI::App& app, Run& run) {
  CLI::App* command =
      app.add_subcommand("attempt", "List and tag attempts, keep them out of studies, or take them in again");
  command->require_subcommand(1);
  addAttemptList(*command, run);
  addDecision(*command, run, true);
  addDecision(*command, run, false);
  addTag(*command, run);
}

}  // namespace calot::apps
