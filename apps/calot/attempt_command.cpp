// SPDX-License-Identifier: GPL-3.0-or-later
// calot attempt: the attempts of a cohort, and decisions of people about them.

#include <algorithm>

#include "apps/calot/command.h"
#include "apps/calot/replay_report.h"
#include "recorder/base/counted.h"

namespace calot::apps {
namespace {

using Access = analytics::CohortDatabase::Access;
using analytics::AttemptRow;

struct AttemptFilter {
  std::string cohort, participant, group, scene, tag;
  bool all = false, json = false;
};

bool isAsked(const AttemptRow& a, const AttemptFilter& o) {
  return (o.participant.empty() || a.participant == o.participant) && (o.group.empty() || a.group == o.group) &&
         (o.scene.empty() || a.scene == o.scene) &&
         (o.tag.empty() || std::find(a.tags.begin(), a.tags.end(), o.tag) != a.tags.end()) && (o.all || !a.excluded);
}

std::string whoOf(const AttemptRow& a) { return a.participant.empty() ? a.profile : a.participant; }

/// Beginnings of the uuids, as long as it takes to distinguish all of the database: what other commands accept.
std::size_t distinctLength(const std::vector<AttemptRow>& rows) {
  std::vector<std::string> uuids;
  uuids.reserve(rows.size());
  for (const AttemptRow& a : rows) uuids.push_back(a.uuid);
  std::sort(uuids.begin(), uuids.end());
  std::size_t length = 8;
  for (std::size_t i = 1; i < uuids.size(); ++i) {
    const std::string &x = uuids[i - 1], &y = uuids[i];
    const auto differs = std::mismatch(x.begin(), x.end(), y.begin(), y.end());
    length = std::max(length, static_cast<std::size_t>(differs.first - x.begin()) + 1);
  }
  return length;
}

void listAttempts(const AttemptFilter& o) {
  const std::vector<AttemptRow> rows = analytics::CohortDatabase(o.cohort, Access::read).listAttempts();
  const std::size_t length = distinctLength(rows);
  analytics::ReportTable table = analytics::tableOf(
      "", {"=attempt", "=who", "=group", "=scene", "=day (UTC)", "seconds", "=outcome", "=verdict", "=tags"});
  table.leastNeeded = {"day (UTC)", "scene"};
  std::string notes;
  std::size_t synthetic = 0;
  Json list = Json::array();
  for (const AttemptRow& a : rows) {
    if (!isAsked(a, o)) continue;
    list.push_back(jsonOf(fieldsOf(a)));
    const std::string beginning = a.uuid.substr(0, length);
    table.rows.push_back({beginning, whoOf(a), a.group, a.scene, a.startUtc.substr(0, 10),
                          fmt::format("{:.1f}", static_cast<double>(a.steps) * a.stepSeconds), wordFor(a.outcome),
                          nameOf(a.verification.verdict), fmt::format("{}", fmt::join(a.tags, ", "))});
    if (a.excluded) notes += fmt::format("{} is excluded: {}\n", beginning, a.exclusionReason);
    synthetic += a.synthetic ? 1 : 0;
  }
  if (synthetic > 0) notes += fmt::format("{} of them by performers (synthetic)\n", synthetic);
  notes += fmt::format("{}: {}", o.cohort, recorder::counted(list.size(), "attempt"));
  if (const std::size_t left = rows.size() - list.size(); left > 0)
    notes += fmt::format(", {} not listed{}", left, o.all ? "" : " (--all: excluded, too)");
  printResult(o.json, "attempt-list", {{"attempts", list}}, [&](std::ostream& out) {
    if (!list.empty()) table.print(out, terminalColumns());
    out << notes << '\n';
  });
}

struct AttemptOptions {
  std::string attempt, cohort, reason, by, tag;
  std::string change = "add";  ///< or "remove"
  bool json = false;
};

template <bool exclude>
void decide(const AttemptOptions& o) {
  analytics::CohortDatabase database(o.cohort, Access::write);
  const std::string uuid = database.attemptNamed(o.attempt);
  if (exclude) {
    database.excludeAttempts({uuid}, o.reason, o.by);
  } else {
    database.includeAttempts({uuid}, o.reason, o.by);
  }
  fmt::print("{}: attempt {} {}\n", o.cohort, uuid, exclude ? "excluded" : "included again");
}

void tag(const AttemptOptions& o) {
  analytics::CohortDatabase database(o.cohort, Access::write);
  const std::string uuid = database.attemptNamed(o.attempt);
  const bool add = o.change == "add";
  const std::size_t changed =
      add ? database.tagAttempts({uuid}, o.tag, o.by) : database.untagAttempts({uuid}, o.tag, o.by);
  if (!add && changed == 0)
    throw Error(ErrorKind::refused, Where{o.cohort}, fmt::format("attempt {} has no tag \"{}\"", uuid, o.tag));
  const std::vector<std::string> tags = database.attempt(uuid)->tags;
  printResult(o.json, "attempt-tag", {{"attempt", uuid}, {"tags", tags}, {"changed", changed > 0}},
              fmt::format("{}: attempt {}: {}\n", o.cohort, uuid,
                          tags.empty() ? "no tags" : fmt::format("tags {}", fmt::join(tags, ", "))));
}

}  // namespace

void addAttempt(CLI::App& app, Run& run) {
  CLI::App& attempt =
      addGroup(app, {"attempt", "List and tag attempts, keep them out of studies, or take them in again",
                     "calot attempt exclude 3f2a --cohort c.db --reason \"camera failed\" --by \"A. Instructor\""});

  const auto [list, l] = addCommand(
      attempt, run, {"list", "List the attempts of a cohort, by their start", "calot attempt list --cohort c.db"},
      listAttempts);
  addCohortOption(*list, l->cohort)->required();
  list->add_option("--participant", l->participant, "Only this participant's")
      ->transform(CLI::Validator(pseudonymForm, ""));
  list->add_option("--group", l->group, "Only this group's");
  list->add_option("--scene", l->scene, "Only of this scene");
  list->add_option("--tag", l->tag, "Only those that have this tag");
  list->add_flag("--all", l->all, "Those that are excluded, too");
  list->add_flag("--json", l->json, "Print JSON");

  const auto o = std::make_shared<AttemptOptions>();
  CLI::App* exclude =
      addCommand(attempt, run,
                 {"exclude", "Keep an attempt out of studies and norms",
                  "calot attempt exclude 3f2a --cohort c.db --reason \"camera failed\" --by \"A. Instructor\""},
                 decide<true>, o)
          .first;
  CLI::App* include =
      addCommand(attempt, run,
                 {"include", "Take an exclusion back",
                  "calot attempt include 3f2a --cohort c.db --reason \"film found\" --by \"A. Instructor\""},
                 decide<false>, o)
          .first;
  CLI::App* tagged = addCommand(attempt, run,
                                {"tag", "Put a word on an attempt to find it by, or take it off",
                                 "calot attempt tag 3f2a add teaching --cohort c.db --by \"A. Instructor\""},
                                tag, o)
                         .first;
  for (CLI::App* command : {exclude, include, tagged}) {
    command->add_option("attempt", o->attempt, "Its uuid, or the beginning of it")->required();
    if (command == tagged) {
      command->add_option("change", o->change, "add, or remove")->required()->check(oneOf({"add", "remove"}));
      command->add_option("tag", o->tag, "The word: 1 to 40 characters, no blanks or commas")->required();
    }
    command->add_option("--cohort", o->cohort, "Cohort database")->required();
    if (command != tagged) command->add_option("--reason", o->reason, "Reason of the decision")->required();
    command->add_option("--by", o->by, "Person who decides")->required();
  }
  tagged->add_flag("--json", o->json, "Print JSON");
}

}  // namespace calot::apps
