// SPDX-License-Identifier: GPL-3.0-or-later
// calot golden: recordings that every build of their simulation version must replay bit for bit.
#include <fmt/format.h>

#include <iostream>
#include <memory>
#include <nlohmann/json.hpp>

#include "apps/calot/commands.h"
#include "apps/calot/environment.h"
#include "apps/calot/golden_files.h"
#include "apps/calot/replay_report.h"
#include "apps/calot/results.h"
#include "apps/common/exit_code.h"
#include "recorder/base/errors.h"
#include "recorder/base/text_output.h"

namespace calot::apps {

namespace {

struct GoldenOptions {
  std::string folder, reason, only;
  JunitOptions junit;
  unsigned threads = 1;
  bool json = false;
};

std::filesystem::path folderOf(const GoldenOptions& o) {
  if (!o.folder.empty()) return o.folder;
  for (const std::filesystem::path& root : assetFolders()) {
    if (std::filesystem::exists(root / "golden" / "golden.json")) return root / "golden";
  }
  throw Error(ErrorKind::damaged, "golden: no asset folder holds golden/golden.json: name one with --folder");
}

int check(const GoldenOptions& o) {
  const std::filesystem::path folder = folderOf(o);
  const GoldenList list = readGoldenList(folder / "golden.json");
  if (!o.junit.file.empty()) recorder::refuseOutput(o.junit.file, o.junit.force);
  std::vector<recorder::ReplayReport> reports;
  nlohmann::json rows = nlohmann::json::array();
  Progress progress("replaying, recordings", o.json);
  for (const GoldenEntry& entry : list.recordings) {
    if (!o.only.empty() && entry.file != o.only) continue;
    const GoldenReplay checked = replayGolden(folder / entry.file, entry, o.threads);
    reports.push_back(checked.report);
    progress.show(reports.size(), list.recordings.size());
    if (o.json) {
      nlohmann::json row = reportJson(checked.report);
      row["changed_checkpoints"] = checked.changed;
      rows.push_back(row);
    } else {
      printReport(checked.report);
      for (const std::string& line : checked.changed) fmt::print("    {}\n", line);
    }
  }
  if (reports.empty()) throw Error(ErrorKind::invalid, fmt::format("golden: --only {}: not in the list", o.only));
  Progress::erase();
  writeJunit(o.junit, "calot golden check", reports);
  if (o.json) printResult("golden-check", {{"recordings", rows}});
  return static_cast<int>(worstOf(reports));
}

int takeValues(const GoldenOptions& o) {
  const std::filesystem::path folder = folderOf(o);
  GoldenList list = readGoldenList(folder / "golden.json");
  list.valuesReason = requiredReason(o.reason);
  Progress progress("replaying, recordings", false);
  for (std::size_t i = 0; i < list.recordings.size(); ++i) {
    GoldenEntry& entry = list.recordings[i];
    const GoldenReplay replay = replayGolden(folder / entry.file, entry, o.threads);
    progress.show(i + 1, list.recordings.size());
    // Only where the simulation does what it did are the checkpoints all that changed.
    if (replay.report.verdict != recorder::ReplayVerdict::exact && replay.changed.empty()) {
      printReport(replay.report);
      return static_cast<int>(worstOf({replay.report}));
    }
    refuseValues(entry, replay.values);
    Progress::erase();
    fmt::print("{}: {} checkpoints, {} changed\n", entry.file, replay.values.size(), replay.changed.size());
    for (const std::string& line : replay.changed) fmt::print("    {}\n", line);
    entry.values = replay.values;
  }
  recorder::writeText(folder / "golden.json", toJson(list), true);
  return static_cast<int>(ExitCode::yes);
}

int update(const GoldenOptions& o) {
  stopOnSignals();
  const std::filesystem::path folder = folderOf(o);
  const GoldenList list = readGoldenList(folder / "golden.json");
  refuseUpdate(folder, list, o.reason);
  updateGolden(folder, list, o.reason, [](const GoldenEntry& before, const GoldenEntry& now) {
    const std::vector<std::string> changed = changedValues(before.values, now.values);
    fmt::print("{}: {} checkpoints, {} changed\n", now.file, now.values.size(), changed.size());
    for (const std::string& line : changed) fmt::print("    {}\n", line);
    std::fflush(stdout);
  });
  return static_cast<int>(ExitCode::yes);
}

}  // namespace

void addGolden(CLI::App& app, Run& run) {
  auto o = std::make_shared<GoldenOptions>();
  CLI::App* command = app.add_subcommand("golden", "Recordings that every build must replay bit for bit.");
  command->require_subcommand(1);
  CLI::App* checking = command->add_subcommand("check", "Replays them; compares checkpoints with those of the list.");
  CLI::App* updating = command->add_subcommand("update", "Makes them anew, after a change of the simulation.");
  CLI::App* values = command->add_subcommand("values", "Replays them; the list takes over what the checkpoints give.");
  for (CLI::App* one : {checking, updating, values})
    one->add_option("--folder", o->folder, "with golden.json; default: golden/ of the assets");
  checking->add_option("--only", o->only, "one file of the list");
  for (CLI::App* one : {checking, values})
    one->add_option("--threads", o->threads, "of the simulation; 0: all")
        ->check(CLI::Range(0U, 64U))
        ->capture_default_str();
  addJunitOptions(*checking, o->junit);
  checking->add_flag("--json", o->json, "print the result as JSON");
  for (CLI::App* one : {updating, values})
    one->add_option("--reason", o->reason, "why they change; kept in the list")->required();
  checking->callback([o, &run] { run = [o] { return check(*o); }; });
  values->callback([o, &run] { run = [o] { return takeValues(*o); }; });
  updating->callback([o, &run] { run = [o] { return update(*o); }; });
}

}  // namespace calot::apps
