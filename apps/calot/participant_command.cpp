// SPDX-License-Identifier: GPL-3.0-or-later
// calot participant: who took part, behind a pseudonym.
#include <fmt/format.h>

#include <iostream>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "analytics/cohort/cohort_database.h"
#include "apps/calot/cohort_lists.h"
#include "apps/calot/commands.h"
#include "apps/calot/withdraw_command.h"
#include "apps/common/exit_code.h"
#include "recorder/base/errors.h"

namespace calot::apps {
namespace {

struct ParticipantOptions {
  std::string pseudonym, database, group, arm, site;
  std::vector<std::string> experience, consent;
};

/// "name<mark>value" pairs. @throws Error (invalid).
std::map<std::string, std::string> pairs(const std::vector<std::string>& items, char mark, const char* option,
                                         const char* form) {
  std::map<std::string, std::string> result;
  for (const std::string& item : items) {
    const std::size_t at = item.find(mark);
    if (at == std::string::npos || at == 0 || at + 1 == item.size()) {
      throw Error(ErrorKind::invalid, fmt::format("{} {}: expected {}", option, item, form));
    }
    if (!result.emplace(item.substr(0, at), item.substr(at + 1)).second) {
      throw Error(ErrorKind::invalid, fmt::format("{} {}: {} is given twice", option, item, item.substr(0, at)));
    }
  }
  return result;
}

std::map<std::string, std::string> experienceOf(const ParticipantOptions& o) {
  return pairs(o.experience, '=', "--experience", "CRITERION=VALUE");
}
std::map<std::string, std::string> consentOf(const ParticipantOptions& o) {
  return pairs(o.consent, ':', "--consent", "PURPOSE:YYYY-MM-DD");
}

void addOptions(CLI::App* command, const std::shared_ptr<ParticipantOptions>& options) {
  command->add_option("participant", options->pseudonym, "Pseudonym, never a name")->required();
  command->add_option("--cohort", options->database, "Cohort database")->required();
  command->add_option("--group", options->group, "Study group");
  command->add_option("--arm", options->arm, "Study arm");
  command->add_option("--site", options->site, "Site");
  command->add_option("--experience", options->experience, "Recorded criterion, CRITERION=VALUE; may be repeated")
      ->allow_extra_args(false);
  command->add_option("--consent", options->consent, "Consent given, PURPOSE:YYYY-MM-DD; may be repeated")
      ->allow_extra_args(false);
}

}  // namespace

void addParticipant(CLI::App& app, Run& run) {
  CLI::App* command = app.add_subcommand("participant", "List, add, change or withdraw participants of a cohort");
  command->require_subcommand(1);
  addParticipantList(*command, run);
  addWithdraw(*command, run);

  const auto added = std::make_shared<ParticipantOptions>();
  CLI::App* add = command->add_subcommand("add", "Add a participant; makes the cohort database if there is none");
  addOptions(add, added);
  add->callback([added, &run] {
    run = [added] {
      const analytics::Participant participant{added->pseudonym, added->group,         added->arm,
                                               added->site,      experienceOf(*added), consentOf(*added)};
      analytics::CohortDatabase(added->database, analytics::CohortDatabase::Access::create).addParticipant(participant);
      std::cout << fmt::format("{}: participant {} added\n", added->database, added->pseudonym);
      return static_cast<int>(ExitCode::yes);
    };
  });

  const auto changed = std::make_shared<ParticipantOptions>();
  CLI::App* set = command->add_subcommand("set", "Change what is given of a participant");
  addOptions(set, changed);
  set->callback([set, changed, &run] {
    // Asked of the parser, so that --group "" takes a group away.
    analytics::ParticipantChange change;
    if (set->count("--group") > 0) change.group = changed->group;
    if (set->count("--arm") > 0) change.arm = changed->arm;
    if (set->count("--site") > 0) change.site = changed->site;
    run = [changed, change]() mutable {
      change.experience = experienceOf(*changed);
      change.consent = consentOf(*changed);
      analytics::CohortDatabase(changed->database, analytics::CohortDatabase::Access::write)
          .setParticipant(changed->pseudonym, change);
      std::cout << fmt::format("{}: participant {} changed\n", changed->database, changed->pseudonym);
      return static_cast<int>(ExitCode::yes);
    };
  });
}

}  // namespace calot::apps
