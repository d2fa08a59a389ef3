// SPDX-License-Identifier: GPL-3.0-or-later
// calot participant: who took part, behind a pseudonym.
#include <map>
#include <set>

#include "analytics/cohort/withdraw.h"
#include "analytics/cohort_files.h"
#include "apps/calot/command.h"
#include "apps/calot/replay_report.h"
#include "recorder/base/counted.h"

namespace calot::apps {
namespace {

namespace fs = std::filesystem;
using Access = analytics::CohortDatabase::Access;

struct ParticipantFilter {
  std::string cohort, group;
  bool json = false;
};

struct WithdrawOptions {
  std::string pseudonym, cohort, scope, assessments;
  std::vector<std::string> folders;
  bool noFolders = false, dryRun = false;
};

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
    if (isFilm(e) && e.removed && known.count(e.target) == 0 && fs::is_regular_file(e.target, ignored))
      remove.emplace_back(e.target);
  }
}

/// All of it, before anything is done: what goes, then what stays and has to be looked into.
void printPlan(const WithdrawOptions& o, const analytics::Withdrawal& w, const analytics::WithdrawalFiles& files) {
  for (const std::string& uuid : w.attempts) std::cout << "attempt " << uuid << '\n';
  for (const std::string& uuid : w.branchesOfOthers)
    std::cout << "of these, a branch that another participant made: " << uuid << '\n';
  for (const std::string& uuid : files.unknown) std::cout << "attempt (not in the database) " << uuid << '\n';
  for (const fs::path& file : files.remove) std::cout << "file " << file.string() << '\n';
  for (const std::string& backup : analytics::backupsOf(o.cohort)) std::cout << "backup " << backup << '\n';
  const std::set<fs::path> gone(files.remove.begin(), files.remove.end());
  for (const analytics::ExportRow& e : w.exports) {
    if (!isFilm(e) || (fs::exists(e.target) && gone.count(e.target) == 0))
      fmt::print("was handed out: {} {} ({}); not removed\n", e.kind, e.target, e.utc);
  }
  for (const fs::path& file : files.naming)
    std::cout << "still names it: " << file.string() << "; not removed, look into it\n";
  for (const auto& [uuid, mode] : w.staying) fmt::print("stays: attempt {}, {} of purpose training\n", uuid, mode);
  if (w.scope != analytics::WithdrawalScope::all) {
    if (w.known)
      fmt::print("stays: participant {}, with experience and site; no study takes the attempts\n", w.pseudonym);
    return;
  }
  fmt::print("the name behind {} is not kept by Calot: remove it where it is\n", o.pseudonym);
  std::vector<std::string> words = w.attempts;
  words.insert(words.end(), files.unknown.begin(), files.unknown.end());
  words.push_back(w.pseudonym);
  for (const std::string& place : analytics::placesLeft(o.cohort, w, words))
    fmt::print("still names it: {} {}; written by a person, look into it\n", o.cohort, place);
}

void withdraw(const WithdrawOptions& o) {
  if (o.folders.empty() != o.noFolders)
    throw Error(ErrorKind::invalid, "withdraw: name the folders of recordings (--recordings), or say --no-recordings");
  const auto scope = o.scope == "all" ? analytics::WithdrawalScope::all : analytics::WithdrawalScope::research;
  const std::optional<bool> keep = o.assessments.empty() ? std::nullopt : std::optional(o.assessments == "keep");
  analytics::Withdrawal w = analytics::planWithdrawal(o.cohort, o.pseudonym, scope, keep);
  if (!w.undecided.empty()) {
    throw Error(
        ErrorKind::invalid, Where{o.cohort},
        fmt::format("{} attempts of {} are assessments of purpose training, which studies analyse, and there is "
                    "no consent to a study: say --assessments keep or remove ({})",
                    w.undecided.size(), o.pseudonym, fmt::join(w.undecided, ", ")));
  }
  const std::vector<fs::path> folders(o.folders.begin(), o.folders.end());
  std::vector<fs::path> untouched{o.cohort, o.cohort + "-journal"};
  for (const std::string& backup : analytics::backupsOf(o.cohort)) untouched.emplace_back(backup);
  analytics::WithdrawalFiles files = analytics::findFiles(w, o.cohort, folders, untouched);
  addFilms(w, files.remove);
  if (!w.known && files.remove.empty())
    throw Error(ErrorKind::refused,
                fmt::format("{}: no participant \"{}\", and nothing left of one", o.cohort, o.pseudonym));
  const bool nothing = w.attempts.empty() && files.remove.empty();
  if (nothing && scope == analytics::WithdrawalScope::research && !w.earlierUtc.empty()) {
    throw Error(
        ErrorKind::refused, Where{o.cohort},
        fmt::format("{} withdrew from research on {}, and nothing is left to remove", o.pseudonym, w.earlierUtc));
  }
  printPlan(o, w, files);
  if (nothing) std::cout << "no attempt and no file is there to remove\n";
  if (o.dryRun) {
    std::cout << "nothing was changed (--dry-run)\n";
    return;
  }
  // The rows last: until they are gone, running again finds everything that is left.
  w.attempts.insert(w.attempts.end(), files.unknown.begin(), files.unknown.end());
  analytics::announceWithdrawal(o.cohort, w);
  for (const fs::path& file : files.remove) removeFile(file);
  if (w.known) {
    const std::string tombstone = analytics::withdraw(o.cohort, w);
    fmt::print("{}: {} and {} removed; tombstone {}\n", o.cohort, recorder::counted(w.attempts.size(), "attempt"),
               recorder::counted(files.remove.size(), "file"), tombstone);
  } else {
    analytics::scrub(o.cohort);
    fmt::print("{}: {} removed; the participant was not in the database\n", o.cohort,
               recorder::counted(files.remove.size(), "file"));
  }
}

void addWithdraw(CLI::App& participant, Run& run) {
  const auto [command, o] =
      addCommand(participant, run,
                 {"withdraw", "Remove what there is of a participant, for good",
                  "calot participant withdraw P1 --cohort c.db --scope all --recordings recordings"},
                 withdraw);
  command->add_option("participant", o->pseudonym, "Pseudonym")
      ->transform(CLI::Validator(pseudonymForm, ""))
      ->required();
  command->add_option("--cohort", o->cohort, "Cohort database")->required();
  command->add_option("--scope", o->scope, "research: all but training goes, the participant stays; all: everything")
      ->check(oneOf({"research", "all"}))
      ->required();
  command
      ->add_option("--assessments", o->assessments,
                   "Assessments of purpose training, in scope research: keep or remove (default: remove with a consent "
                   "to a study)")
      ->check(oneOf({"keep", "remove"}));
  command->add_option("--recordings", o->folders, "Folder with recordings and films; may be repeated")
      ->allow_extra_args(false);
  command->add_flag("--no-recordings", o->noFolders, "There is no such folder");
  command->add_flag("--dry-run", o->dryRun, "Say what would go, and change nothing");
}

struct ParticipantOptions {
  const CLI::App* command = nullptr;
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

template <bool isNew>
void enter(const ParticipantOptions& o) {
  const auto experience = pairs(o.experience, '=', "--experience", "CRITERION=VALUE");
  const auto consent = pairs(o.consent, ':', "--consent", "PURPOSE:YYYY-MM-DD");
  analytics::CohortDatabase database(o.database, isNew ? Access::create : Access::write);
  if (isNew) {
    database.addParticipant({o.pseudonym, o.group, o.arm, o.site, experience, consent});
  } else {
    database.setParticipant(o.pseudonym, {givenOf(*o.command, "--group", o.group), givenOf(*o.command, "--arm", o.arm),
                                          givenOf(*o.command, "--site", o.site), experience, consent});
  }
  fmt::print("{}: participant {} {}\n", o.database, o.pseudonym, isNew ? "added" : "changed");
}

void listParticipants(const ParticipantFilter& o) {
  const analytics::CohortDatabase database(o.cohort, Access::read);
  std::map<std::string, std::uint64_t> attempts;
  for (const analytics::AttemptRow& a : database.listAttempts()) ++attempts[a.participant];
  analytics::ReportTable table =
      analytics::tableOf("", {"=participant", "=group", "=arm", "=site", "attempts", "=experience", "=consent"});
  const auto joined = [](const std::map<std::string, std::string>& pairs, char mark) {
    std::string text;
    for (const auto& [name, value] : pairs)
      text += fmt::format("{}{}{}{}", text.empty() ? "" : ", ", name, mark, value);
    return text;
  };
  Json list = Json::array();
  for (const analytics::Participant& p : database.participants()) {
    if (!o.group.empty() && p.group != o.group) continue;
    list.push_back(jsonOf(fieldsOf(p)));
    list.back()["attempts"] = attempts[p.pseudonym];
    table.rows.push_back({p.pseudonym, p.group, p.arm, p.site, std::to_string(attempts[p.pseudonym]),
                          joined(p.experience, '='), joined(p.consent, ':')});
  }
  printResult(o.json, "participant-list", {{"participants", list}}, [&](std::ostream& out) {
    if (!list.empty()) table.print(out, terminalColumns());
    out << fmt::format("{}: {}\n", o.cohort, recorder::counted(list.size(), "participant"));
  });
}

}  // namespace

void addParticipant(CLI::App& app, Run& run) {
  CLI::App& participant = addGroup(app, {"participant", "List, add, change or withdraw participants of a cohort",
                                         "calot participant add P1 --cohort c.db --group novice"});

  const auto [list, l] =
      addCommand(participant, run,
                 {"list", "List the participants of a cohort", "calot participant list --cohort c.db --group novice"},
                 listParticipants);
  addCohortOption(*list, l->cohort)->required();
  list->add_option("--group", l->group, "Only this group's");
  list->add_flag("--json", l->json, "Print JSON");

  addWithdraw(participant, run);

  const auto o = std::make_shared<ParticipantOptions>();
  CLI::App* added = addCommand(participant, run,
                               {"add", "Add a participant; makes the cohort database if there is none",
                                "calot participant add P1 --cohort c.db --group novice --consent study:2026-01-31"},
                               enter<true>, o)
                        .first;
  CLI::App* changed = addCommand(participant, run,
                                 {"set", "Change what is given of a participant",
                                  "calot participant set P1 --cohort c.db --experience laparoscopies=240"},
                                 enter<false>, o)
                          .first;
  o->command = changed;
  for (CLI::App* command : {added, changed}) {
    command->add_option("participant", o->pseudonym, "Pseudonym, never a name")
        ->transform(CLI::Validator(pseudonymForm, ""))
        ->required();
    command->add_option("--cohort", o->database, "Cohort database")->required();
    command->add_option("--group", o->group, "Study group");
    command->add_option("--arm", o->arm, "Study arm");
    command->add_option("--site", o->site, "Site");
    command->add_option("--experience", o->experience, "Recorded criterion, CRITERION=VALUE; may be repeated")
        ->allow_extra_args(false);
    command->add_option("--consent", o->consent, "Consent given, PURPOSE:YYYY-MM-DD; may be repeated")
        ->allow_extra_args(false);
  }
}

}  // namespace calot::apps
