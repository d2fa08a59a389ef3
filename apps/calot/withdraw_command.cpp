// SPDX-License-Identifier: GPL-3.0-or-later
// calot participant withdraw: everything of a person goes.
#include "apps/calot/withdraw_command.h"

#include <fmt/format.h>

#include <iostream>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "analytics/cohort/key_file.h"
#include "analytics/cohort/withdraw.h"
#include "analytics/cohort_files.h"
#include "apps/calot/passphrase.h"
#include "apps/calot/wrong_word.h"
#include "apps/common/exit_code.h"
#include "recorder/base/errors.h"

namespace calot::apps {
namespace {

namespace fs = std::filesystem;

struct WithdrawOptions {
  std::string pseudonym, cohort, scope, key, passphraseFile;
  std::vector<std::string> folders;
  bool noFolders = false, noKey = false, dryRun = false;
};

void checkStores(const WithdrawOptions& o) {
  if (o.folders.empty() != o.noFolders)
    throw Error(ErrorKind::invalid, "withdraw: name the folders of recordings (--recordings), or say --no-recordings");
  if (o.scope == "all" && o.key.empty() != o.noKey)
    throw Error(ErrorKind::invalid, "withdraw: name the key file (--key), or say --no-key");
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
void tell(const WithdrawOptions& o, const analytics::Withdrawal& w, const analytics::WithdrawalFiles& files,
          bool named) {
  for (const std::string& uuid : w.attempts) std::cout << "attempt " << uuid << '\n';
  for (const std::string& uuid : w.branchesOfOthers)
    std::cout << "of these, a branch that another participant made: " << uuid << '\n';
  for (const std::string& uuid : files.unknown) std::cout << "attempt (not in the database) " << uuid << '\n';
  for (const fs::path& file : files.remove) std::cout << "file " << file.string() << '\n';
  for (const std::string& backup : analytics::backupsOf(o.cohort)) std::cout << "backup " << backup << '\n';
  if (named) std::cout << "entry of the key file " << o.key << '\n';
  const std::set<fs::path> gone(files.remove.begin(), files.remove.end());
  for (const analytics::ExportRow& e : w.exports) {
    if (!isFilm(e) || (fs::exists(e.target) && gone.count(e.target) == 0))
      std::cout << fmt::format("was handed out: {} {} ({}); not removed\n", e.kind, e.target, e.utc);
  }
  for (const fs::path& file : files.naming)
    std::cout << "still names it: " << file.string() << "; not removed, look into it\n";
  if (w.scope != analytics::WithdrawalScope::all) return;
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
  if (!o.key.empty()) keep.emplace_back(o.key);
  for (const std::string& backup : analytics::backupsOf(o.cohort)) keep.emplace_back(backup);
  analytics::WithdrawalFiles files = analytics::findFiles(w, o.cohort, folders, keep);
  addFilms(w, files.remove);
  std::unique_ptr<analytics::KeyFile> key;
  if (!o.key.empty()) key = std::make_unique<analytics::KeyFile>(o.key, readPassphrase(o.passphraseFile));
  const bool named = key && scope == analytics::WithdrawalScope::all && key->names().count(o.pseudonym) > 0;
  if (!w.known && files.remove.empty() && !named)
    throw Error(ErrorKind::refused,
                fmt::format("{}: no participant \"{}\", and nothing left of one", o.cohort, o.pseudonym));
  tell(o, w, files, named);
  if (o.dryRun) {
    std::cout << "nothing was changed (--dry-run)\n";
    return static_cast<int>(ExitCode::yes);
  }
  // The database last: until its rows are gone, running again finds everything that is left.
  for (const fs::path& file : files.remove) removeFile(file);
  if (named) key->remove(o.pseudonym);
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

}  // namespace

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
  command->add_option("--key", o->key, "Key file");
  command->add_flag("--no-key", o->noKey, "There is no key file");
  command->add_option("--passphrase-file", o->passphraseFile, "File whose first line is the key file's passphrase");
  command->add_flag("--dry-run", o->dryRun, "Say what would go, and change nothing");
  command->callback([o, &run] { run = [o] { return withdraw(*o); }; });
}

}  // namespace calot::apps
