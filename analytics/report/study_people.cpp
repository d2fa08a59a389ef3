// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/report/study_people.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <set>
#include <utility>

#include "analytics/statistics/descriptive.h"
#include "recorder/base/text_words.h"

namespace calot::analytics {
namespace {

constexpr const char* notRecorded = "not recorded";
constexpr std::size_t maxGroups = 6;  // with a column

FlowRow& rowOf(std::vector<FlowRow>& flow, const std::string& reason) {
  const auto at = std::find_if(flow.begin(), flow.end(), [&](const FlowRow& row) { return row.reason == reason; });
  return at != flow.end() ? *at : flow.emplace_back(FlowRow{reason, 0});
}

}  // namespace

void countPeople(AnalysedData& data, const std::vector<AttemptRow>& recruited, const IncludedAttempts& included,
                 const StudyOptions& options, const AttemptsOfUnits& analysed) {
  const auto named = [](const std::string& group) { return group.empty() ? "no group" : group; };
  std::map<std::string, std::string> groups;  // of units
  for (const AttemptRow& a : recruited) groups[unitOf(a)] = named(groupOf(a, options.grouping));
  FlowRow idle{"no attempt", 0};
  for (const Participant& p : options.people) {
    if (groups.count(p.pseudonym) > 0 || options.grouping != Grouping::group) continue;
    ++idle.people[named(p.group)];
    ++data.recruitedPeople[named(p.group)];
  }
  for (const auto& [unit, group] : groups) {
    ++data.recruitedPeople[group];
    if (analysed.units.count(unit) > 0) {
      ++data.analysedPeople[group];
      continue;
    }
    const auto reasons = included.reasons.find(unit);
    std::string last = "another group";
    for (const FlowRow& row : data.flow) {
      if (reasons != included.reasons.end() && reasons->second.count(row.reason) > 0) last = row.reason;
    }
    ++rowOf(data.flow, last).people[group];
  }
  if (!idle.people.empty()) data.flow.insert(data.flow.begin(), std::move(idle));
}

ReportTable flowTable(const AnalysedData& data, std::span<const std::string> groups) {
  if (groups.size() > maxGroups) groups = {};
  ReportTable table = tableOf("Flow", {"=", "participants"});
  for (const std::string& group : groups) table.columns.emplace_back(cutTo(group, 12), Align::right);
  table.columns.emplace_back("others", Align::right);
  table.columns.emplace_back(data.counted, Align::right);
  const auto text = [](std::uint64_t n) { return n == 0 ? std::string() : fmt::format("{}", n); };
  const auto add = [&](const std::string& stage, const std::map<std::string, std::uint64_t>& people,
                       std::uint64_t attempts) {
    std::uint64_t all = 0, shown = 0;
    for (const auto& item : people) all += item.second;
    std::vector<std::string> row{stage, text(all)};
    for (const std::string& group : groups) {
      const auto at = people.find(group);
      const std::uint64_t n = at == people.end() ? 0 : at->second;
      shown += n;
      row.push_back(text(n));
    }
    row.push_back(groups.empty() ? "" : text(all - shown));
    row.push_back(text(attempts));
    table.rows.push_back(std::move(row));
  };
  add("in the " + data.source, data.recruitedPeople, data.recruited);
  for (const FlowRow& row : data.flow) add("left out: " + row.reason, row.people, row.attempts);
  add("analysed: " + data.attemptRule, data.analysedPeople, data.analysed);
  dropEmptyColumns(table);
  return table;
}

void addTraits(StudyPerson& person, const std::vector<const AttemptRow*>& attempts, const StudyOptions& options) {
  const std::string& who = attempts.front()->participant;
  const auto at = std::lower_bound(options.people.begin(), options.people.end(), who,
                                   [](const Participant& p, const std::string& name) { return p.pseudonym < name; });
  if (at != options.people.end() && at->pseudonym == who) person.traits = at->experience;
  for (const AttemptRow* a : attempts) {
    for (const auto& [name, value] : std::initializer_list<std::pair<const char*, const std::string*>>{
             {"site", &a->site}, {"arm", &a->arm}, {"device", &a->device}, {"station", &a->station}}) {
      std::string& all = person.traits[name];
      if (all.find(*value) == std::string::npos) all += (all.empty() ? "" : " and ") + *value;
    }
  }
  std::erase_if(person.traits, [](const auto& trait) { return trait.second.empty(); });
}

namespace {

constexpr std::array<const char*, 5> settingNames{"handedness", "site", "arm", "device", "station"};

/// A trait of all people, by group.
struct Trait {
  std::array<std::map<std::string, std::uint64_t>, 2> counts;  ///< people by value
  std::array<std::vector<double>, 2> numbers;
  std::set<std::string> values;
  bool numeric = true;  ///< every value that is recorded

  [[nodiscard]] std::string text(std::size_t group) const {
    std::string words;
    if (const Summary s = summaryOf(numbers[group]); numeric && s.n > 0)
      words = fmt::format("{} [{}, {}]", significant(*s.median, 3), significant(*s.lowerQuartile, 3),
                          significant(*s.upperQuartile, 3));
    for (const auto& [value, count] : counts[group]) {
      if (value == notRecorded || !numeric) words += fmt::format("{}{} {}", words.empty() ? "" : ", ", value, count);
    }
    return words;
  }
};

Trait traitOf(const Study& study, const std::string& name) {
  Trait trait;
  for (const auto& [unit, person] : study.people) {
    const auto at = person.traits.find(name);
    const std::string value = at == person.traits.end() ? notRecorded : at->second;
    ++trait.counts[person.group][value];
    trait.values.insert(value);
    if (value == notRecorded) continue;
    std::string fault;
    trait.numbers[person.group].push_back(recorder::readFiniteNumber(value, fault));
    trait.numeric = trait.numeric && fault.empty();
  }
  return trait;
}

/// Share of the people that both groups have in common by a trait: the sum of the smaller shares of each value.
double overlap(const Study& study, const Trait& trait) {
  double common = 0.0;
  for (const auto& [value, count] : trait.counts[0]) {
    const auto at = trait.counts[1].find(value);
    if (at == trait.counts[1].end()) continue;
    common += std::min(static_cast<double>(count) / static_cast<double>(study.participants[0]),
                       static_cast<double>(at->second) / static_cast<double>(study.participants[1]));
  }
  return common;
}

}  // namespace

ReportTable peopleTable(const Study& study) {
  ReportTable table = tableOf("Participants (Table 1)", {"=", "=" + study.groups[0], "=" + study.groups[1]});
  std::set<std::string> criteria;
  for (const auto& item : study.people) {
    for (const auto& trait : item.second.traits) criteria.insert(trait.first);
  }
  for (const char* name : settingNames) criteria.erase(name);
  std::vector<std::string> names(criteria.begin(), criteria.end());
  names.insert(names.end(), settingNames.begin(), settingNames.end());
  for (const std::string& name : names) {
    const Trait trait = traitOf(study, name);
    const bool alike = trait.values.size() < 2 && (name == "device" || name == "station");
    if (!alike && !trait.values.empty() && trait.values != std::set<std::string>{notRecorded})
      table.rows.push_back({name, trait.text(0), trait.text(1)});
  }
  if (table.rows.empty()) return table;
  const auto add = [&](const std::string& name, const std::array<std::uint64_t, 2>& n) {
    table.rows.insert(table.rows.begin(), std::vector{name, fmt::format("{}", n[0]), fmt::format("{}", n[1])});
  };
  add(study.counted, study.attempts);
  add("participants", study.participants);
  return table;
}

std::vector<std::string> peopleWarnings(const Study& study) {
  constexpr double littleOverlap = 0.4;
  std::vector<std::string> warnings;
  for (const char* name : {"site", "device", "station"}) {
    const Trait trait = traitOf(study, name);
    const double common = overlap(study, trait);
    if (trait.values.size() < 2 || common > littleOverlap) continue;
    warnings.push_back(
        fmt::format("Warning: {} {} group ({}: {}; {}: {}). A difference between the groups may be one of {}{}.", name,
                    common > 0.0 ? "goes with" : "is confounded with", study.groups[0], trait.text(0), study.groups[1],
                    trait.text(1), name, common > 0.0 ? "" : ", and these data cannot separate the two"));
  }
  double least = HUGE_VAL, most = 0.0;
  for (const auto& item : study.people) {
    least = std::min(least, static_cast<double>(item.second.attempts));
    most = std::max(most, static_cast<double>(item.second.attempts));
  }
  if (most > least) {
    warnings.push_back(fmt::format(
        "Warning: numbers of {0} are unequal, {1:g} to {2:g} a participant ({3} in {4}, {5} in {6}). A mean "
        "of more {0} varies less and holds more practice.",
        study.counted, least, most, study.attempts[0], study.groups[0], study.attempts[1], study.groups[1]));
  }
  return warnings;
}

}  // namespace calot::analytics
