// SPDX-License-Identifier: GPL-3.0-or-later
// calot regrade: recomputes the derived values of a cohort.

#include <map>

#include "analytics/assessment/declared_document.h"
#include "analytics/checkpoints/checkpoint.h"
#include "analytics/regrade.h"
#include "analytics/report/figure_number.h"
#include "apps/calot/command.h"
#include "apps/calot/replay_report.h"
#include "recorder/base/counted.h"

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

ExitCode regrade(const RegradeOptions& o) {
  Progress progress("Regrading", o.json, "recordings");
  const analytics::Regrade regrade = analytics::regrade(
      o.cohort, placesOf(o), o.jobs, [&](std::uint64_t done, std::uint64_t of) { progress.show(done, of); });
  Progress::erase();
  return reportRegrade(o.cohort, regrade, o.json);
}

}  // namespace

void addRegrade(CLI::App& app, Run& run) {
  const auto [command, o] = addCommand(
      app, run,
      {"regrade", "Recompute the derived values of a cohort, and show what changed", "calot regrade c.db recordings"},
      regrade);
  addCohortOption(*command, o->cohort)->required();
  command->add_option("recordings", o->places, "Recordings, or folders that hold them; default: the database's folder");
  addThreads(*command, o->jobs, "Recordings at a time; 0: one for each processor", "--jobs");
  command->add_flag("--json", o->json, "Print JSON");
}

namespace {

using analytics::Regraded;

const char* regradedName(Regraded how) {
  constexpr const char* names[] = {"unchanged", "changed", "missing", "motion", "unreadable", "conflict"};
  return names[static_cast<std::size_t>(how)];
}

std::string shownValue(const std::optional<analytics::CheckpointValue>& v) {
  if (!v) return "-";
  if (!v->value) return v->availability == analytics::Availability::notApplicable ? "n/a" : nameOf(v->availability);
  const analytics::CheckpointDefinition* definition = analytics::findCheckpoint(v->name);
  const std::string unit = definition != nullptr ? definition->displayUnit : v->unit;
  return analytics::figureNumber(definition, *v->value * (definition != nullptr ? definition->displayFactor : 1.0), 6) +
         (unit == "1" ? "" : " " + unit);
}

/// Differences besides the figure.
std::string otherwise(const analytics::ValueChange& c) {
  if (!c.before) return "new";
  if (!c.now) return "no longer computed";
  std::string text;
  const auto add = [&](const std::string& part) { text += (text.empty() ? "" : ", ") + part; };
  if (c.before->version != c.now->version) add(fmt::format("version {} -> {}", c.before->version, c.now->version));
  if (c.before->origin != c.now->origin)
    add(fmt::format("{} -> {}", analytics::nameOf(c.before->origin), analytics::nameOf(c.now->origin)));
  if (c.before->filter != c.now->filter) add("filter");
  if (c.before->unit != c.now->unit) add("unit");
  if (c.before->reason != c.now->reason && !c.now->value) add("reason");
  if (c.before->note != c.now->note) add("note");
  return text;
}

Json regradeJson(const analytics::Regrade& regrade) {
  Json out;
  out["attempts"] = Json::array();
  for (const analytics::RegradedAttempt& a : regrade.attempts) {
    Json row = {{"attempt", a.uuid}, {"file", a.file}, {"result", regradedName(a.how)}};
    if (!a.message.empty()) row["message"] = a.message;
    if (!a.remedies.empty()) row["advice"] = advice(a.remedies);
    row["changes"] = Json::array();
    for (const analytics::ValueChange& c : a.changes) {
      Json change = {{"name", c.any().name}, {"subject", c.any().subject}};
      change["before"] = c.before ? jsonOf(std::vector{*c.before}).front() : Json();
      change["now"] = c.now ? jsonOf(std::vector{*c.now}).front() : Json();
      row["changes"].push_back(change);
    }
    out["attempts"].push_back(row);
  }
  out["not_read"] = Json::array();
  for (const Error& fault : regrade.notRead) out["not_read"].push_back(messageOf(fault));
  return out;
}

void printRegrade(const analytics::Regrade& regrade) {
  std::map<Regraded, std::uint64_t> counts;
  std::vector<std::string> order;
  std::map<std::string, std::uint64_t> attemptsOf;
  analytics::ReportTable table = analytics::tableOf("", {"=attempt", "=checkpoint", "before", "now", "="});
  for (const analytics::RegradedAttempt& a : regrade.attempts) {
    ++counts[a.how];
    for (const analytics::ValueChange& c : a.changes) {
      const std::string title = analytics::figureName(c.any().name, c.any().subject);
      if (attemptsOf[title]++ == 0) order.push_back(title);
      table.rows.push_back({a.uuid.substr(0, 8), title, shownValue(c.before), shownValue(c.now), otherwise(c)});
    }
  }
  if (!table.rows.empty()) {
    table.print(std::cout);
    std::cout << '\n';
    for (const std::string& title : order)
      fmt::print("{}: changed in {} of {}\n", title, attemptsOf[title],
                 recorder::counted(regrade.attempts.size(), "attempt"));
  }
  fmt::print("{}: {} changed, {} unchanged", recorder::counted(regrade.attempts.size(), "attempt"),
             counts[Regraded::changed], counts[Regraded::unchanged]);
  for (const Regraded how : {Regraded::missing, Regraded::motion, Regraded::unreadable, Regraded::conflict}) {
    if (counts[how] > 0) fmt::print(", {} {}", counts[how], regradedName(how));
  }
  std::cout << '\n';
  for (const Error& fault : regrade.notRead) std::cout << "not read: " << messageOf(fault) << '\n';
  std::cout << std::flush;
}

}  // namespace

ExitCode reportRegrade(const std::string& cohort, const analytics::Regrade& regrade, bool json) {
  json ? printResult("regrade", regradeJson(regrade)) : printRegrade(regrade);
  std::vector<ExitCode> codes;
  for (const analytics::RegradedAttempt& a : regrade.attempts) {
    codes.push_back(codeOf(a.fault));
    if (a.fault)
      fmt::print(stderr, "calot: {}: attempt {}: {}: {}\n", cohort, a.uuid, regradedName(a.how),
                 advised(a.message, a.remedies));
  }
  return worstOf(codes);
}

}  // namespace calot::apps
