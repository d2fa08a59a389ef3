// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/calot/regrade_report.h"

#include <fmt/format.h>

#include <iostream>
#include <map>
#include <optional>
#include <vector>

#include "analytics/checkpoints/registry.h"
#include "analytics/report/report_document.h"
#include "apps/calot/results.h"
#include "apps/calot/value_report.h"
#include "apps/common/advice.h"

namespace calot::apps {
namespace {

using analytics::Regraded;
using nlohmann::ordered_json;

const char* nameOf(Regraded how) {
  switch (how) {
    case Regraded::unchanged:
      return "unchanged";
    case Regraded::changed:
      return "changed";
    case Regraded::missing:
      return "missing";
    case Regraded::motion:
      return "motion";
    case Regraded::unreadable:
      return "unreadable";
    case Regraded::conflict:
      return "conflict";
  }
  return "";
}

std::string titleOf(const analytics::CheckpointValue& v) {
  return v.subject.empty() ? v.name : v.name + " " + v.subject;
}

std::string shown(const std::optional<analytics::CheckpointValue>& v) {
  if (!v) return "-";
  if (!v->value) return v->availability == analytics::Availability::notApplicable ? "n/a" : nameOf(v->availability);
  const analytics::CheckpointDefinition* definition = analytics::findCheckpoint(v->name);
  return analytics::significant(*v->value * (definition != nullptr ? definition->displayFactor : 1.0), 6) + " " +
         (definition != nullptr ? definition->displayUnit : v->unit);
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

ordered_json regradeJson(const analytics::Regrade& regrade) {
  ordered_json out;
  out["attempts"] = ordered_json::array();
  for (const analytics::RegradedAttempt& a : regrade.attempts) {
    ordered_json row = {{"attempt", a.uuid}, {"file", a.file}, {"result", nameOf(a.how)}};
    if (!a.message.empty()) row["message"] = a.message;
    if (!a.remedies.empty()) row["advice"] = advice(a.remedies);
    row["changes"] = ordered_json::array();
    for (const analytics::ValueChange& c : a.changes) {
      ordered_json change = {{"name", c.any().name}, {"subject", c.any().subject}};
      change["before"] = c.before ? apps::jsonOf(std::vector{*c.before}).front() : ordered_json();
      change["now"] = c.now ? apps::jsonOf(std::vector{*c.now}).front() : ordered_json();
      row["changes"].push_back(change);
    }
    out["attempts"].push_back(row);
  }
  out["not_read"] = ordered_json::array();
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
      const std::string title = titleOf(c.any());
      if (attemptsOf[title]++ == 0) order.push_back(title);
      table.rows.push_back({a.uuid.substr(0, 8), title, shown(c.before), shown(c.now), otherwise(c)});
    }
  }
  if (!table.rows.empty()) {
    table.print(std::cout);
    std::cout << '\n';
    for (const std::string& title : order)
      std::cout << fmt::format("{}: changed in {} of {} attempts\n", title, attemptsOf[title], regrade.attempts.size());
  }
  std::cout << fmt::format("{} attempts: {} changed, {} unchanged", regrade.attempts.size(), counts[Regraded::changed],
                           counts[Regraded::unchanged]);
  for (const Regraded how : {Regraded::missing, Regraded::motion, Regraded::unreadable, Regraded::conflict}) {
    if (counts[how] > 0) std::cout << fmt::format(", {} {}", counts[how], nameOf(how));
  }
  std::cout << '\n';
  for (const Error& fault : regrade.notRead) std::cout << "not read: " << messageOf(fault) << '\n';
  std::cout << std::flush;
}

}  // namespace

ExitCode reportRegrade(const std::string& cohort, const analytics::Regrade& regrade, const char* command, bool json) {
  if (json) {
    printResult(command, regradeJson(regrade));
  } else {
    printRegrade(regrade);
  }
  std::vector<ExitCode> codes;
  for (const analytics::RegradedAttempt& a : regrade.attempts) {
    codes.push_back(codeOf(a.fault));
    if (a.fault)
      fmt::print(stderr, "calot: {}: attempt {}: {}: {}\n", cohort, a.uuid, nameOf(a.how),
                 advised(a.message, a.remedies));
  }
  return worstOf(codes);
}

}  // namespace calot::apps
