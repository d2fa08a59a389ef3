// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/calot/cohort_lists.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <iostream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "analytics/cohort/cohort_database.h"
#include "analytics/report/report_text.h"
#include "apps/calot/cohort_option.h"
#include "apps/calot/results.h"
#include "apps/calot/terminal_text.h"
#include "apps/common/exit_code.h"

namespace calot::apps {
namespace {

using Access = analytics::CohortDatabase::Access;
using analytics::AttemptRow;
using analytics::Participant;
using Align = analytics::TextTable::Align;
using Json = nlohmann::ordered_json;

struct ListOptions {
  std::string cohort, participant, group, scene, tag;
  bool all = false, json = false;
};

/// Filter of the rows.
bool isAsked(const AttemptRow& a, const ListOptions& o) {
  return (o.participant.empty() || a.participant == o.participant) && (o.group.empty() || a.group == o.group) &&
         (o.scene.empty() || a.scene == o.scene) &&
         (o.tag.empty() || std::find(a.tags.begin(), a.tags.end(), o.tag) != a.tags.end()) && (o.all || !a.excluded);
}

std::string whoOf(const AttemptRow& a) { return a.participant.empty() ? a.profile : a.participant; }

Json jsonOf(const AttemptRow& a) {
  return {{"attempt", a.uuid},        {"participant", a.participant},
          {"group", a.group},         {"synthetic", a.synthetic},
          {"profile", a.profile},     {"scene", a.scene},
          {"mode", wordFor(a.mode)},  {"outcome", wordFor(a.outcome)},
          {"start_utc", a.startUtc},  {"seconds", static_cast<double>(a.steps) * a.stepSeconds},
          {"file", a.fileName},       {"verdict", nameOf(a.verification.verdict)},
          {"excluded", a.excluded},   {"exclusion_reason", a.exclusionReason},
          {"withdrawn", a.withdrawn}, {"tags", a.tags}};
}

/// Beginnings of the uuids, as long as it takes to tell all of the database's apart: what other commands accept.
std::size_t lengthThatTells(const std::vector<AttemptRow>& rows) {
  std::vector<std::string> uuids;
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

int listAttempts(const ListOptions& o) {
  const std::vector<AttemptRow> rows = analytics::CohortDatabase(o.cohort, Access::read).listAttempts();
  const std::size_t length = lengthThatTells(rows);
  analytics::TextTable table({{"attempt", Align::left},
                              {"who", Align::left},
                              {"group", Align::left},
                              {"scene", Align::left},
                              {"day (UTC)", Align::left},
                              {"seconds", Align::right},
                              {"outcome", Align::left},
                              {"verdict", Align::left},
                              {"tags", Align::left}});
  std::string notes;
  std::size_t synthetic = 0;
  Json list = Json::array();
  for (const AttemptRow& a : rows) {
    if (!isAsked(a, o)) continue;
    list.push_back(jsonOf(a));
    const std::string beginning = a.uuid.substr(0, length);
    table.add({beginning, whoOf(a), a.group, a.scene, a.startUtc.substr(0, 10),
               fmt::format("{:.1f}", static_cast<double>(a.steps) * a.stepSeconds), wordFor(a.outcome),
               nameOf(a.verification.verdict), fmt::format("{}", fmt::join(a.tags, ", "))});
    if (a.excluded) notes += fmt::format("{} is excluded: {}\n", beginning, a.exclusionReason);
    synthetic += a.synthetic ? 1 : 0;
  }
  if (o.json) {
    printResult("attempt-list", {{"attempts", list}});
    return static_cast<int>(ExitCode::yes);
  }
  if (!list.empty()) table.print(std::cout, terminalColumns());
  std::cout << notes;
  if (synthetic > 0) std::cout << fmt::format("{} of them by performers (synthetic)\n", synthetic);
  const std::size_t left = rows.size() - list.size();
  std::cout << fmt::format(
      "{}: {} attempts{}\n", o.cohort, list.size(),
      left > 0 ? fmt::format(", {} not listed{}", left, o.all ? "" : " (--all: excluded, too)") : "");
  return static_cast<int>(ExitCode::yes);
}

int listParticipants(const ListOptions& o) {
  const analytics::CohortDatabase database(o.cohort, Access::read);
  std::map<std::string, std::uint64_t> attempts;
  for (const AttemptRow& a : database.listAttempts()) ++attempts[a.participant];
  analytics::TextTable table({{"participant", Align::left},
                              {"group", Align::left},
                              {"arm", Align::left},
                              {"site", Align::left},
                              {"attempts", Align::right},
                              {"experience", Align::left},
                              {"consent", Align::left}});
  const auto joined = [](const std::map<std::string, std::string>& pairs, char mark) {
    std::string text;
    for (const auto& [name, value] : pairs)
      text += fmt::format("{}{}{}{}", text.empty() ? "" : ", ", name, mark, value);
    return text;
  };
  Json list = Json::array();
  for (const Participant& p : database.participants()) {
    if (!o.group.empty() && p.group != o.group) continue;
    list.push_back({{"participant", p.pseudonym},
                    {"group", p.group},
                    {"arm", p.arm},
                    {"site", p.site},
                    {"attempts", attempts[p.pseudonym]},
                    {"experience", p.experience},
                    {"consent", p.consent}});
    table.add({p.pseudonym, p.group, p.arm, p.site, std::to_string(attempts[p.pseudonym]), joined(p.experience, '='),
               joined(p.consent, ':')});
  }
  if (o.json) {
    printResult("participant-list", {{"participants", list}});
    return static_cast<int>(ExitCode::yes);
  }
  if (!list.empty()) table.print(std::cout, terminalColumns());
  std::cout << fmt::format("{}: {} participants\n", o.cohort, list.size());
  return static_cast<int>(ExitCode::yes);
}

}  // namespace

void addAttemptList(CLI::App& attempt, Run& run) {
  const auto o = std::make_shared<ListOptions>();
  CLI::App* command = attempt.add_subcommand("list", "List the attempts of a cohort, by their start");
  addCohortOption(*command, o->cohort)->required();
  command->add_option("--participant", o->participant, "Only this participant's");
  command->add_option("--group", o->group, "Only this group's");
  command->add_option("--scene", o->scene, "Only of this scene");
  command->add_option("--tag", o->tag, "Only those that have this tag");
  command->add_flag("--all", o->all, "Those that are excluded, too");
  command->add_flag("--json", o->json, "Print JSON");
  command->callback([o, &run] { run = [o] { return listAttempts(*o); }; });
}

void addParticipantList(CLI::App& participant, Run& run) {
  const auto o = std::make_shared<ListOptions>();
  CLI::App* command = participant.add_subcommand("list", "List the participants of a cohort");
  addCohortOption(*command, o->cohort)->required();
  command->add_option("--group", o->group, "Only this group's");
  command->add_flag("--json", o->json, "Print JSON");
  command->callback([o, &run] { run = [o] { return listParticipants(*o); }; });
}

}  // namespace calot::apps
