// SPDX-License-Identifier: GPL-3.0-or-later
// calot regrade: the derived values of a cohort, computed anew; here, or in shares on many machines.
#include <fmt/format.h>

#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "analytics/regrade.h"
#include "analytics/regrade_shares.h"
#include "apps/calot/cohort_option.h"
#include "apps/calot/commands.h"
#include "apps/calot/environment.h"
#include "apps/calot/regrade_report.h"
#include "apps/calot/results.h"
#include "apps/calot/share_options.h"
#include "recorder/base/errors.h"

namespace calot::apps {
namespace {

struct RegradeOptions {
  std::string cohort;
  std::vector<std::string> places;
  ShareOptions share;
  unsigned jobs = 0;
  bool json = false;
};

std::vector<std::filesystem::path> placesOf(const RegradeOptions& o) {
  if (!o.places.empty()) return pathsOf(o.places);
  const std::filesystem::path folder = std::filesystem::path(o.cohort).parent_path();
  return {folder.empty() ? std::filesystem::path(".") : folder};
}

void showRegrade(const analytics::Regrade& regrade, bool json) {
  Progress::erase();
  if (json) {
    printResult("regrade", regradeJson(regrade));
  } else {
    printRegrade(regrade);
  }
}

int computeRegradeShare(const RegradeOptions& o) {
  Progress progress(fmt::format("shard {}, recordings", o.share.shard), o.json);
  const analytics::ComputedShare share = analytics::computeRegradeShare(
      o.cohort, placesOf(o), analytics::shardNamed(o.share.shard), o.share.valuesTo, o.jobs, o.share.force,
      [&](std::uint64_t done, std::uint64_t of) { progress.show(done, of); });
  printShare(o.share, share, o.json);
  return static_cast<int>(ExitCode::yes);
}

int takeRegradeShares(const RegradeOptions& o) {
  if (!o.places.empty())
    throw Error(ErrorKind::invalid, "--take: recordings are not needed; values come from the files alone");
  Progress progress("taking, recordings", o.json);
  const analytics::TakenRegrade taken = analytics::takeRegrade(
      o.cohort, pathsOf(o.share.take), [&](std::uint64_t done, std::uint64_t of) { progress.show(done, of); });
  if (taken.missing.of > 0) showRegrade(taken.regrade, o.json);  // else every file was refused
  if (taken.withdrawn > 0) {
    fmt::print(stderr, "calot: warning: {}: values of {} attempts were left out: withdrawn since\n", o.cohort,
               taken.withdrawn);
  }
  const ExitCode shards = reportShards(o.cohort, taken.refused, taken.missing);
  return static_cast<int>(worstOf({shards, reportFaults(o.cohort, taken.regrade)}));
}

int regrade(const RegradeOptions& o) {
  if (o.share.plan > 0) {
    printPlan(analytics::regradePlan(o.cohort, o.share.plan), o.json);
    return static_cast<int>(ExitCode::yes);
  }
  if (!o.share.shard.empty()) return computeRegradeShare(o);
  if (!o.share.take.empty()) return takeRegradeShares(o);
  Progress progress("regrading, recordings", o.json);
  const analytics::Regrade regrade = analytics::regrade(
      o.cohort, placesOf(o), o.jobs, [&](std::uint64_t done, std::uint64_t of) { progress.show(done, of); });
  showRegrade(regrade, o.json);
  return static_cast<int>(reportFaults(o.cohort, regrade));
}

}  // namespace

void addRegrade(CLI::App& app, Run& run) {
  const auto o = std::make_shared<RegradeOptions>();
  CLI::App* command =
      app.add_subcommand("regrade", "Compute the derived values of a cohort anew, and show what changed");
  addCohortOption(*command, o->cohort)->required();
  command->add_option("recordings", o->places, "Recordings, or folders that hold them; default: the database's folder");
  addSharing(*command, o->share);
  command->add_option("--jobs", o->jobs, "Recordings at a time; 0: one for each processor")
      ->check(CLI::Range(0U, 64U))
      ->capture_default_str();
  command->add_flag("--json", o->json, "Print JSON");
  command->callback([o, &run] { run = [o] { return regrade(*o); }; });
}

}  // namespace calot::apps
