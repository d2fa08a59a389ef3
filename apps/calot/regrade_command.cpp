// SPDX-License-Identifier: GPL-3.0-or-later
// calot regrade: the derived values of a cohort, computed anew.
#include <fmt/format.h>

#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "analytics/regrade.h"
#include "apps/calot/cohort_option.h"
#include "apps/calot/commands.h"
#include "apps/calot/environment.h"
#include "apps/calot/regrade_report.h"
#include "apps/calot/results.h"
#include "recorder/base/errors.h"

namespace calot::apps {
namespace {

struct RegradeOptions {
  std::string cohort;
  std::vector<std::string> places;
  unsigned jobs = 0;
  bool json = false;
};

std::vector<std::filesystem::path> placesOf(const RegradeOptions& o) {
  if (!o.places.empty()) return {o.places.begin(), o.places.end()};
  const std::filesystem::path folder = std::filesystem::path(o.cohort).parent_path();
  return {folder.empty() ? std::filesystem::path(".") : folder};
}

int regrade(const RegradeOptions& o) {
  Progress progress("regrading, recordings", o.json);
  const analytics::Regrade regrade = analytics::regrade(
      o.cohort, placesOf(o), o.jobs, [&](std::uint64_t done, std::uint64_t of) { progress.show(done, of); });
  Progress::erase();
  return static_cast<int>(reportRegrade(o.cohort, regrade, "regrade", o.json));
}

}  // namespace

void addRegrade(CLI::App& app, Run& run) {
  const auto o = std::make_shared<RegradeOptions>();
  CLI::App* command =
      app.add_subcommand("regrade", "Compute the derived values of a cohort anew, and show what changed");
  addCohortOption(*command, o->cohort)->required();
  command->add_option("recordings", o->places, "Recordings, or folders that hold them; default: the database's folder");
  command->add_option("--jobs", o->jobs, "Recordings at a time; 0: one for each processor")
      ->check(CLI::Range(0U, 64U))
      ->capture_default_str();
  command->add_flag("--json", o->json, "Print JSON");
  command->callback([o, &run] { run = [o] { return regrade(*o); }; });
}

}  // namespace calot::apps
