// SPDX-License-Identifier: GPL-3.0-or-later
// calot verify: a station's recordings, verified and assessed as they come into a folder.

#include <chrono>

#include "analytics/checkpoints/replay_words.h"
#include "analytics/intake/intake.h"
#include "apps/calot/command.h"
#include "apps/calot/replay_report.h"
#include "recorder/base/counted.h"
#include "recorder/kept/kept_engine.h"

namespace calot::apps {
namespace {

using analytics::IntakeItem;
using analytics::TakenIn;
using std::chrono::milliseconds;

/// How long a request to stop may go unnoticed at worst.
constexpr milliseconds longestWait{1000};

struct VerifyOptions {
  std::vector<std::string> folders;
  std::string cohort, journal;
  unsigned threads = 1;
  double quiet = 1.0, settle = 60.0, rescan = 30.0;  ///< s
  bool once = false, inside = false, json = false;
};

const char* wordFor(TakenIn how) {
  constexpr const char* names[] = {"added", "extended", "unchanged", "known", "damaged", "refused", "failed"};
  return names[static_cast<std::size_t>(how)];
}

/// An error's message and advice, without the file's name, which the line begins with.
std::string faultText(const IntakeItem& item) {
  return advised(recorder::messageWithout(item.file, *item.fault), item.fault->remedies());
}

std::string textOf(const IntakeItem& item) {
  if (item.how == TakenIn::failed) return fmt::format("failed, again in {} s: {}", item.retryIn, faultText(item));
  if (item.fault) return fmt::format("{}: {}", wordFor(item.how), faultText(item));
  if (item.how == TakenIn::known) return "known, verified before";
  const recorder::ReplayReport& report = item.judged.report;
  const std::string verdict =
      report.fault() ? advised(analytics::wordsFor(report), report.remedies) : std::string("verified");
  return fmt::format("{}{}, {}", verdict, report.complete ? "" : ", incomplete", wordFor(item.how));
}

ExitCode codeOfItem(const IntakeItem& item) {
  if (item.fault) return codeOf(item.fault->kind());
  return item.how == TakenIn::known ? ExitCode::yes : codeOf(item.judged.report.fault());
}

void printItem(const IntakeItem& item, const VerifyOptions& o) {
  std::string keyFault;
  if (item.judged.record && !item.fault) keyFault = keyFaultOf(*item.judged.record, o.cohort);
  if (o.json) {
    Json row = {{"file", item.file}, {"result", wordFor(item.how)}, {"attempt", item.attempt}};
    if (!item.judged.report.path.empty()) row["report"] = reportJson(item.judged.report);
    if (item.fault) row["message"] = faultText(item);
    if (item.how == TakenIn::failed) row["retry_in_seconds"] = item.retryIn;
    if (!keyFault.empty()) row["key"] = keyFault;
    printResultLine("verify", row);
  } else {
    printText(fmt::format("{}: {}{}{}\n", item.file, textOf(item), keyFault.empty() ? "" : "; warning: ", keyFault));
  }
  // Whoever reads a pipe sees each line as it comes.
  if (std::fflush(stdout) != 0) throw Error(ErrorKind::failure, "standard output cannot be written");
}

milliseconds fromSeconds(double seconds) { return milliseconds(static_cast<std::int64_t>(1000.0 * seconds)); }

/// Nothing is left to wait for but what is still being written.
ExitCode endOnce(const analytics::IntakeRest& rest, std::vector<ExitCode> codes) {
  if (rest.growing > 0)
    fmt::print(stderr, "calot: warning: left, not finished yet: {}\n", recorder::counted(rest.growing, "recording"));
  if (rest.retries > 0) codes.push_back(ExitCode::failure);
  return worstOf(codes);
}

ExitCode verify(const VerifyOptions& o) {
  using Clock = std::chrono::steady_clock;
  stopOnSignals();
  analytics::IntakeSettings settings;
  settings.folders = {o.folders.begin(), o.folders.end()};
  settings.cohort = o.cohort;
  settings.journal = o.journal.empty() ? o.cohort + ".intake" : o.journal;
  settings.threads = o.threads;
  settings.apart = !o.inside && !recorder::enginePlaces().own.empty();
  settings.quiet = fromSeconds(o.quiet);
  settings.settle = fromSeconds(o.settle);
  for (const std::filesystem::path& folder : settings.folders) {
    std::error_code ignored;
    if (!std::filesystem::is_directory(folder, ignored))
      throw Error(ErrorKind::damaged, Where{folder.string()}, "is not a folder that can be watched");
  }
  analytics::FolderWatch watch(settings.folders);
  analytics::Intake intake(settings);
  std::vector<ExitCode> codes;
  while (true) {
    Progress progress("Verifying", o.json);
    const analytics::IntakeRest rest = intake.look(
        [&](const IntakeItem& item) {
          printItem(item, o);
          if (o.once) codes.push_back(codeOfItem(item));
        },
        stopRequested());
    Progress::erase();
    if (stopRequested()) return worstOf(codes);
    if (o.once && rest.settling == 0) return endOnce(rest, codes);
    // Files that settle are looked at again soon, growing and failed ones at the next scan.
    const milliseconds next = rest.settling > 0 ? std::max(settings.quiet, milliseconds(50)) : fromSeconds(o.rescan);
    const Clock::time_point until = Clock::now() + next;
    for (bool changed = false; !changed && !stopRequested() && Clock::now() < until;) {
      const auto left = std::chrono::duration_cast<milliseconds>(until - Clock::now()) + milliseconds(1);
      changed = watch.wait(std::min(left, longestWait));
    }
    if (stopRequested()) return worstOf(codes);
  }
}

}  // namespace

void addVerify(CLI::App& app, Run& run) {
  const auto [command, o] =
      addCommand(app, run,
                 {"verify", "Verifies and assesses recordings as they come into folders, and stores them.",
                  "calot verify --watch incoming --cohort c.db"},
                 verify);
  command->add_option("--watch", o->folders, "folders that recordings come into, with what is below")->required();
  command->add_option("--cohort", o->cohort, "cohort database; made where there is none")->required();
  command->add_option("--journal", o->journal,
                      "file that remembers what was decided; default: the database's name and .intake");
  command->add_flag("--once", o->once, "take what is there, and end");
  addThreads(*command, o->threads, "segments between keyframes that are verified at a time; 0: one a processor");
  addNumber(*command, "--quiet", o->quiet, "seconds for which a finished recording has not changed before it is taken",
            0.0, 3600.0);
  addNumber(*command, "--settle", o->settle,
            "seconds for which one that is not finished or cannot be read has not changed before it is judged", 0.0,
            86400.0);
  addNumber(*command, "--rescan", o->rescan, "seconds between looks at the folders where no change is noticed", 0.1,
            86400.0);
  command->add_flag("--inside", o->inside, "re-simulate in this program, not in confined ones");
  command->add_flag("--json", o->json, "print a line of JSON for each recording");
}

}  // namespace calot::apps
