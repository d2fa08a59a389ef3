// SPDX-License-Identifier: GPL-3.0-or-later
// calot participant: who took part, behind a pseudonym.
#include <fmt/format.h>
#include <iostream>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "analytics/cohort/cohort_database.h"
#include "analytics/cohort/withdraw.h"
#include "analytics/cohort_files.h"
#include "apps/calot/cohort_lists.h"
#include "apps/calot/commands.h"
#include "apps/calot/wrong_word.h"
#include "apps/common/exit_code.h"
#include "recorder/base/errors.h"

namespace calot::apps {
namespace {

/// `calot participant withdraw`.
void addWithdraw(CLI::App& participant, Run& run);

namespace fs = std::filesystem;

struct WithdrawOptions {
  std::string pseudonym, cohort, scope;
  std::vector<std::string> folders;
  bool noFolders = false, dryRun = false;
};

void checkStores(const WithdrawOptions& o) {
  if (o.folders.empty() != o.noFolders)
    throw Error(ErrorKind::invalid, "withdraw: name the folders of recordings (--recordings), or say --no-recordings");
}

void removeFile(const fs::path& file) {
  std::error_code error;
  fs::remove(file, error);
  if (error) {
    throw Error(ErrorKind::failure, Where{file.string()},
                fmt::format("cannot be removed: {}; what comes after it was not touched, run again when it can",
                            error.message()));
  }
}

/// Pictures and films that were drawn of the attempts, wherever they are.
bool isFilm(const analytics::ExportRow& e) { return e.kind == "film" || e.kind == "picture"; }

void addFilms(const analytics::Withdrawal& w, std::vector<fs::path>& remove) {
  const std::set<fs::path> known(remove.begin(), remove.end());
  for (const analytics::ExportRow& e : w.exports) {
    std::error_code ignored;
    if (isFilm(e) && known.count(e.target) == 0 && fs::is_regular_file(e.target, ignored))
      remove.emplace_back(e.target);
  }
}

/// All of it, before anything is done: what goes, then what stays and has to be looked into.
void tell(const WithdrawOptions& o, const analytics::Withdrawal& w, const analytics::WithdrawalFiles& files) {
  for (const std::string& uuid : w.attempts) std::cout << "attempt " << uuid << '\n';
  for (const std::string& uuid : w.branchesOfOthers)
    std::cout << "of these, a branch that another participant made: " << uuid << '\n';
  for (const std::string& uuid : files.unknown) std::cout << "attempt (not in the database) " << uuid << '\n';
  for (const fs::path& file : files.remove) std::cout << "file " << file.string() << '\n';
  for (const std::string& backup : analytics::backupsOf(o.cohort)) std::cout << "backup " << backup << '\n';
  const std::set<fs::path> gone(files.remove.begin(), files.remove.end());
  for (const analytics::ExportRow& e : w.exports) {
    if (!isFilm(e) || (fs::exists(e.target) && gone.count(e.target) == 0))
      std::cout << fmt::format("was handed out: {} {} ({}); not removed\n", e.kind, e.target, e.utc);
  }
  for (const fs::path& file : files.naming)
    std::cout << "still names it: " << file.string() << "; not removed, look into it\n";
  if (w.scope != analytics::WithdrawalScope::all) return;
  std::cout << fmt::format("the name behind {} is not kept by Calot: remove it where it is\n", o.pseudonym);
  std::vector<std::string> words = w.attempts;
  words.insert(words.end(), files.unknown.begin(), files.unknown.end());
  words.push_back(w.pseudonym);
  for (const std::string& place : analytics::placesLeft(o.cohort, w, words))
    std::cout << fmt::format("still names it: {} {}; written by a person, look into it\n", o.cohort, place);
}

int withdraw(const WithdrawOptions& o) {
  checkStores(o);
  const auto scope = o.scope == "all" ? analytics::WithdrawalScope::all : analytics::WithdrawalScope::research;
  analytics::Withdrawal w = analytics::planWithdrawal(o.cohort, o.pseudonym, scope);
  const std::vector<fs::path> folders(o.folders.begin(), o.folders.end());
  std::vector<fs::path> keep{o.cohort, o.cohort + "-wal", o.cohort + "-shm"};
  for (const std::string& backup : analytics::backupsOf(o.cohort)) keep.emplace_back(backup);
  analytics::WithdrawalFiles files = analytics::findFiles(w, o.cohort, folders, keep);
  addFilms(w, files.remove);
  if (!w.known && files.remove.empty())
    throw Error(ErrorKind::refused,
                fmt::format("{}: no participant \"{}\", and nothing left of one", o.cohort, o.pseudonym));
  tell(o, w, files);
  if (o.dryRun) {
    std::cout << "nothing was changed (--dry-run)\n";
    return static_cast<int>(ExitCode::yes);
  }
  // The database last: until its rows are gone, running again finds everything that is left.
  for (const fs::path& file : files.remove) removeFile(file);
  w.attempts.insert(w.attempts.end(), files.unknown.begin(), files.unknown.end());
  if (w.known) {
    const std::string tombstone = analytics::withdraw(o.cohort, w);
    std::cout << fmt::format("{}: {} attempts and {} files removed; tombstone {}\n", o.cohort, w.attempts.size(),
                             files.remove.size(), tombstone);
  } else {
    analytics::scrub(o.cohort);
    std::cout << fmt::format("{}: {} files removed; the participant was not in the database\n", o.cohort,
                             files.remove.size());
  }
  return static_cast<int>(ExitCode::yes);
}

void addWithdraw(CLI::App& participant, Run& run) {
  const auto o = std::make_shared<WithdrawOptions>();
  CLI::App* command = participant.add_subcommand("withdraw", "Remove what there is of a participant, for good");
  command->add_option("participant", o->pseudonym, "Pseudonym")->required();
  command->add_option("--cohort", o->cohort, "Cohort database")->required();
  command->add_option("--scope", o->scope, "research: all but training goes, the participant stays; all: everything")
      ->check(oneOf({"research", "all"}))
      ->required();
  command->add_option("--recordings", o->folders, "Folder with recordings and films; may be repeated")
      ->allow_extra_args(false);
  command->add_flag("--no-recordings", o->noFolders, "There is no such folder");
  command->add_flag("--dry-run", o->dryRun, "Say what would go, and change nothing");
  command->callback([o, &run] { run = [o] { return withdraw(*o); }; });
}

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
