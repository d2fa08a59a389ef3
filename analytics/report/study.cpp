// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/report/study.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "analytics/checkpoints/registry.h"
#include "analytics/cohort/embedded.h"
#include "analytics/statistics/descriptive.h"
#include "recorder/errors.h"

namespace calot::analytics {
namespace {

/// Why an attempt stays out, or empty. The order is the flow table's.
const std::vector<std::string>& exclusionReasons() {
  static const std::vector<std::string> reasons{"excluded by hand",  "recording diverged or damaged",
                                                "not verified yet",  "recording incomplete",
                                                "technical failure", "synthetic (performer)",
                                                "practice",          "branch of another attempt",
                                                "golden recording",  "no group"};
  return reasons;
}

std::string groupOf(const AttemptRow& a, Grouping grouping) {
  if (grouping == Grouping::group) return a.group;
  return a.operatorKind == recorder::OperatorKind::performer ? a.profile : "";
}

std::string whyOut(const AttemptRow& a, const StudyOptions& options) {
  const std::vector<std::string>& reason = exclusionReasons();
  if (a.excluded) return reason[0];
  if (a.verification.verdict == Verdict::diverged || a.verification.verdict == Verdict::damaged) return reason[1];
  if (a.verification.verdict == Verdict::notChecked) return reason[2];
  if (!a.complete || a.outcome == recorder::Outcome::running) return reason[3];
  if (a.outcome == recorder::Outcome::technicalFailure) return reason[4];
  if (a.synthetic && !options.includeSynthetic) return reason[5];
  if (a.mode == recorder::Mode::practice && !options.includePractice) return reason[6];
  if (!a.parent.empty() && !options.includeBranches) return reason[7];
  if (a.purpose == "golden") return reason[8];
  if (groupOf(a, options.grouping).empty()) return reason[9];
  return {};
}

/// Whose value it is: a person, or one performer's run.
std::string unitOf(const AttemptRow& a) { return a.participant.empty() ? "attempt " + a.uuid : a.participant; }

/// skilled before intermediate before unskilled, expert before novice; else by name.
bool before(const std::string& a, const std::string& b) {
  const auto rank = [](const std::string& s) {
    const std::vector<std::string> known{"expert", "skilled", "intermediate", "novice", "unskilled"};
    return std::find(known.begin(), known.end(), s) - known.begin();
  };
  return rank(a) != rank(b) ? rank(a) < rank(b) : a < b;
}

std::string joined(const std::vector<std::string>& parts) {
  std::string text;
  for (const std::string& part : parts) text += (text.empty() ? "" : ", ") + part;
  return text;
}

std::array<std::string, 2> chooseGroups(const std::map<std::string, std::uint64_t>& present,
                                        const StudyOptions& options, const std::string& path, const Study& study) {
  std::vector<std::string> names;
  names.reserve(present.size());
  for (const auto& item : present) names.push_back(item.first);
  std::sort(names.begin(), names.end(), before);
  if (!options.groups.empty()) {
    if (options.groups.size() != 2 || options.groups[0] == options.groups[1]) {
      throw Error(ExitCode::usage, "study: --groups takes two different names");
    }
    for (const std::string& name : options.groups) {
      if (present.count(name) == 0) {
        throw Error(ExitCode::no, fmt::format("{}: no attempts for the study in group \"{}\" (there are: {})", path,
                                              name, names.empty() ? "none" : joined(names)));
      }
    }
    return {options.groups[0], options.groups[1]};
  }
  if (names.size() == 2) return {names[0], names[1]};
  if (names.size() > 2) {
    throw Error(ExitCode::no,
                fmt::format("{}: {} groups ({}); name two with --groups A,B", path, names.size(), joined(names)));
  }
  std::string left;
  for (const FlowRow& row : study.flow)
    left += fmt::format("{}{} {}", left.empty() ? "" : ", ", row.attempts, row.reason);
  throw Error(ExitCode::no, fmt::format("{}: a study needs two groups, {} left of {} attempts{}", path,
                                        names.empty() ? "none is" : "only " + names[0] + " is", study.recruited,
                                        left.empty() ? "" : " (left out: " + left + ")"));
}

struct Cell {
  double sum = 0.0;
  std::uint64_t count = 0;
};

/// Values of one checkpoint and subject, by group and participant.
struct Column {
  std::array<std::map<std::string, Cell>, 2> participant;
  std::array<std::map<std::string, std::string>, 2> reason;  ///< of participants without a value so far
  std::set<std::uint32_t> versions;
  std::set<std::string> origins;
};

GroupSummary summarise(const std::vector<double>& values, const std::map<std::string, std::string>& reasons) {
  GroupSummary s;
  s.n = values.size();
  s.missing = reasons.size();
  std::map<std::string, int> counts;
  for (const auto& item : reasons) ++counts[item.second];
  int most = 0;
  for (const auto& item : counts) {
    if (item.second > most) {
      most = item.second;
      s.missingReason = item.first;
    }
  }
  const auto take = [](const Answer<double>& answer) { return answer ? std::optional<double>(*answer) : std::nullopt; };
  s.mean = take(mean(values));
  s.standardDeviation = take(standardDeviation(values));
  s.median = take(median(values));
  s.lowerQuartile = take(quantile(values, 0.25));
  s.upperQuartile = take(quantile(values, 0.75));
  return s;
}

StudyRow makeRow(const std::string& name, const std::string& subject, const Column& column, const std::string& unit) {
  StudyRow row;
  row.checkpoint = name;
  row.subject = subject;
  row.title = name;
  row.unit = unit;
  double factor = 1.0;
  if (const CheckpointDefinition* d = findCheckpoint(name)) {
    row.title = d->title;
    row.unit = d->displayUnit;
    row.direction = d->direction;
    factor = d->displayFactor;
  }
  row.versions.assign(column.versions.begin(), column.versions.end());
  row.origins.assign(column.origins.begin(), column.origins.end());
  for (std::size_t g = 0; g < 2; ++g) {
    for (const auto& item : column.participant[g]) {
      row.participants[g].push_back(item.first);
      row.values[g].push_back(item.second.sum / static_cast<double>(item.second.count) * factor);
    }
    row.group[g] = summarise(row.values[g], column.reason[g]);
  }
  row.test = mannWhitney(row.values[0], row.values[1]);
  row.effect = superiority(row.values[0], row.values[1]);
  row.shift = hodgesLehmann(row.values[0], row.values[1]);
  row.shiftInterval = hodgesLehmannInterval(row.values[0], row.values[1]);
  return row;
}

void addPublished(Study& study) {
  const nlohmann::json table = nlohmann::json::parse(publishedTable2());
  study.publishedSource = table.at("source").get<std::string>();
  for (const auto& published : table.at("rows")) {
    for (StudyRow& row : study.rows) {
      if (row.checkpoint != published.at("matches").get<std::string>() ||
          row.subject != published.at("subject").get<std::string>())
        continue;
      if (row.unit != published.at("unit").get<std::string>()) continue;
      row.publishedExpert = published.at("expert").get<double>();
      row.publishedNovice = published.at("novice").get<double>();
    }
  }
}

}  // namespace

Study makeStudy(const CohortDatabase& database, const StudyOptions& options) {
  return makeStudy(database.listAttempts(), database.allValues(), options, database.path());
}

Study makeStudy(const std::vector<AttemptRow>& recruited, const std::vector<AttemptValue>& values,
                const StudyOptions& options, const std::string& name) {
  Study study;
  study.heading = "exploratory";
  std::map<std::string, std::uint64_t> out, present;
  std::vector<AttemptRow> attempts;
  for (const AttemptRow& a : recruited) {
    ++study.recruited;
    if (const std::string reason = whyOut(a, options); !reason.empty()) {
      ++out[reason];
      continue;
    }
    ++present[groupOf(a, options.grouping)];
    attempts.push_back(a);
  }
  for (const std::string& reason : exclusionReasons()) {
    if (out.count(reason) > 0) study.flow.push_back({reason, out[reason]});
  }
  study.groups = chooseGroups(present, options, name, study);

  std::map<std::string, std::pair<std::size_t, std::string>> member;  // attempt -> group index, participant
  std::set<std::string> keys;
  std::array<std::set<std::string>, 2> people;
  std::uint64_t elsewhere = 0;
  for (const AttemptRow& a : attempts) {
    const std::string group = groupOf(a, options.grouping);
    const auto at = std::find(study.groups.begin(), study.groups.end(), group);
    if (at == study.groups.end()) {
      ++elsewhere;
      continue;
    }
    const auto g = static_cast<std::size_t>(at - study.groups.begin());
    member[a.uuid] = {g, unitOf(a)};
    people[g].insert(unitOf(a));
    ++study.attempts[g];
    ++study.analysed;
    keys.insert(a.comparabilityKey);
    study.synthetic = study.synthetic || a.synthetic;
  }
  if (elsewhere > 0) study.flow.push_back({"another group", elsewhere});
  for (std::size_t g = 0; g < 2; ++g) study.participants[g] = people[g].size();
  for (const std::string& person : people[0]) {
    if (people[1].count(person) > 0) {
      throw Error(ExitCode::no,
                  fmt::format("{}: participant \"{}\" is in both groups, which must be independent", name, person));
    }
  }
  study.keys.assign(keys.begin(), keys.end());
  if (study.keys.size() > 1) {
    if (!options.mixKeys) {
      throw Error(
          ExitCode::no,
          fmt::format(
              "{}: the attempts don't compare, they have {} comparability keys ({}); choose, or ask for --mix-keys",
              name, study.keys.size(), [&] {
                std::string list;
                for (const auto& key : study.keys) list += (list.empty() ? "" : "; ") + key;
                return list;
              }()));
    }
    study.remarks.push_back(
        fmt::format("Attempts of {} comparability keys are mixed, as asked: differences between groups may be "
                    "differences of scene, device or version.",
                    study.keys.size()));
  }

  std::map<std::pair<std::string, std::string>, Column> columns;
  std::vector<std::pair<std::string, std::string>> order;
  std::map<std::pair<std::string, std::string>, std::string> unit;
  for (const AttemptValue& item : values) {
    const auto at = member.find(item.attempt);
    if (at == member.end()) continue;
    const std::pair<std::string, std::string> key{item.value.name, item.value.subject};
    if (columns.count(key) == 0) order.push_back(key);
    Column& column = columns[key];
    unit[key] = item.value.unit;
    const auto& [g, person] = at->second;
    if (!item.value.value) {
      if (column.participant[g].count(person) == 0) column.reason[g].emplace(person, item.value.reason);
      continue;
    }
    column.versions.insert(item.value.version);
    column.origins.insert(nameOf(item.value.origin));
    Cell& cell = column.participant[g][person];
    cell.sum += *item.value.value;
    ++cell.count;
    column.reason[g].erase(person);
  }
  const auto place = [](const std::string& checkpoint) {
    const auto& registry = checkpointRegistry();
    return std::find_if(registry.begin(), registry.end(),
                        [&](const CheckpointEntry& e) { return e.definition.name == checkpoint; }) -
           registry.begin();
  };
  std::stable_sort(order.begin(), order.end(),
                   [&](const auto& a, const auto& b) { return place(a.first) < place(b.first); });
  for (const auto& key : order) {
    const Column& column = columns[key];
    if (column.versions.size() > 1) {
      if (!options.mixKeys) {
        throw Error(
            ExitCode::no,
            fmt::format(
                "{}: checkpoint {} has values of {} versions; assess the older recordings again, or ask for --mix-keys",
                name, key.first, column.versions.size()));
      }
      study.remarks.push_back(
          fmt::format("Values of {} versions of {} are mixed, as asked.", column.versions.size(), key.first));
    }
    study.rows.push_back(makeRow(key.first, key.second, column, unit[key]));
  }
  addPublished(study);
  return study;
}

}  // namespace calot::analytics
