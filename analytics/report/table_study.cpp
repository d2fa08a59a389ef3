// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/report/table_study.h"

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <initializer_list>
#include <iterator>
#include <set>

#include "analytics/report/study_population.h"
#include "analytics/report/study_protocol.h"
#include "analytics/report/study_rows.h"
#include "recorder/base/counted.h"
#include "recorder/base/errors.h"
#include "recorder/base/text_words.h"

namespace calot::analytics {
namespace {

using recorder::shown;

using Rows = std::map<std::string, std::vector<const TableRecord*>>;  ///< by participant

/// The rule reduces several rows of a participant to one value; without a rule they are refused.
/// @param[out] several set where there were any @return how many rows went out because the first counts
std::uint64_t applyRule(std::array<Rows, 2>& rows, const CsvTable& table, const TableStudyOptions& options,
                        bool& several) {
  std::uint64_t later = 0;
  std::size_t repeated = 0;
  const std::vector<const TableRecord*>* example = nullptr;
  for (Rows& group : rows) {
    for (auto& [person, list] : group) {
      if (list.size() < 2) continue;
      ++repeated;
      if (!options.attemptRule && (example == nullptr || list[1]->line < (*example)[1]->line)) example = &list;
      if (options.attemptRule != AttemptRule::first) continue;
      later += list.size() - 1;
      list.erase(list.begin() + 1, list.end());
    }
  }
  several = several || repeated > 0;
  if (example == nullptr) return later;
  throw Error(
      ErrorKind::refused, Where{table.path, fmt::format("line {}", (*example)[1]->line)},
      fmt::format("participant \"{}\" has {} rows{} ({} with several), which are not independent",
                  shown((*example)[0]->participant), example->size(),
                  options.occasion.empty() ? "" : " at one occasion", recorder::counted(repeated, "participant")),
      {Remedy::chooseOccasion, Remedy::chooseAttemptRule});
}

void nameAbsent(Study& study, const std::map<std::string, std::string>& groupOf,
                const std::vector<TableRecord>& records) {
  std::map<std::string, std::set<std::string>> seen;
  for (const TableRecord& r : records) seen[r.participant].insert(r.occasion);
  std::set<std::string> occasions;
  for (const auto& [person, group] : groupOf) occasions.insert(seen[person].begin(), seen[person].end());
  for (const auto& [person, group] : groupOf) {
    for (const std::string& occasion : occasions) {
      if (seen[person].count(occasion) == 0) study.absent.push_back({person, group, occasion});
    }
  }
  if (study.absent.empty()) return;
  constexpr std::size_t most = 10;
  std::string list;
  for (std::size_t i = 0; i < std::min(most, study.absent.size()); ++i) {
    const AbsentRow& a = study.absent[i];
    list += fmt::format("{}{} ({}) at {}", i == 0 ? "" : "; ", a.participant, a.group, a.occasion);
  }
  if (study.absent.size() > most) list += fmt::format("; and {} more", study.absent.size() - most);
  study.remarks.push_back(fmt::format("Absent rows: {}.", list));
}

BaselineAdjustment adjustment(const StudyRow& row, const StudyRow& before) {
  BaselineAdjustment result;
  std::array<std::vector<double>, 2> baseline, outcome;
  for (std::size_t g = 0; g < 2; ++g) {
    for (std::size_t i = 0; i < row.values[g].size(); ++i) {
      const auto& people = before.participants[g];
      const auto at = std::lower_bound(people.begin(), people.end(), row.participants[g][i]);
      if (at == people.end() || *at != row.participants[g][i]) {
        ++result.withoutBaseline[g];
        continue;
      }
      baseline[g].push_back(before.values[g][static_cast<std::size_t>(at - people.begin())]);
      outcome[g].push_back(row.values[g][i]);
    }
    result.n[g] = outcome[g].size();
  }
  result.analysis = covarianceAnalysis({baseline[0], outcome[0]}, {baseline[1], outcome[1]});
  return result;
}

/// Values of one outcome in the rows of either group.
StudySample sampleOf(const std::array<Rows, 2>& rows, std::size_t outcome) {
  StudySample sample;
  for (std::size_t g = 0; g < 2; ++g) {
    for (const auto& [person, list] : rows[g]) {
      for (const TableRecord* r : list) {
        if (r->values[outcome]) {
          sample.values[g].push_back({person, r->line, *r->values[outcome]});
        } else {
          sample.missing[g][person].push_back({Availability::notAvailable, "empty cell"});
        }
      }
    }
  }
  return sample;
}

[[noreturn]] void fail(const std::string& what, std::initializer_list<Remedy> remedies) {
  throw Error(ErrorKind::invalid, "study: " + what, remedies);
}

void checkOptions(const TableStudyOptions& options) {
  if (options.outcomes.empty() && options.protocol)
    fail("the table has no column for any hypothesis of the protocol", {Remedy::nameOutcome});
  checkColumns(options, true);
  if (options.baselineOccasion.empty()) return;
  if (options.occasion.empty())
    fail("a baseline needs the occasion that it is the baseline of", {Remedy::nameOccasion});
  if (options.occasion == options.baselineOccasion)
    fail("the baseline's occasion is the outcome's", {Remedy::nameOccasion});
}

/// Options after applying the protocol.
TableStudyOptions chosen(const CsvTable& table, TableStudyOptions options) {
  if (!options.protocol) return options;
  chooseByProtocol(options, *options.protocol);
  if (!options.outcomes.empty()) return options;
  for (const DirectedHypothesis& h : options.protocol->hypotheses) {
    if (table.has(figureOf(h))) options.outcomes.push_back(figureOf(h));
  }
  return options;
}

}  // namespace

Study makeTableStudy(const CsvTable& table, const TableStudyOptions& asked) {
  const TableStudyOptions options = chosen(table, asked);
  checkOptions(options);
  const std::vector<Outcome> outcomes = outcomesOf(table, options);
  const std::vector<TableRecord> records = recordsOf(table, options, outcomes);
  askForOccasion(table, records, options.occasion);
  askForOccasion(table, records, options.baselineOccasion);

  Study study;
  study.heading = "exploratory";
  study.source = "table";
  study.counted = "rows";
  study.where = std::filesystem::path(table.path).filename().string();
  study.recruited = records.size();
  std::uint64_t otherGroup = 0, otherOccasion = 0, asBaseline = 0;
  const RowsByGroup byGroup = rowsByGroup(records);
  study.groups = chooseGroups(byGroup.present, options, table.path, byGroup.left);
  study.better = betterOf(study.groups, options);
  study.unequalSpread = options.unequalSpread;
  if (options.protocol) {
    study.synthetic = options.protocol->performers;
    describeProtocolOfTable(study, *options.protocol);
  }

  std::map<std::string, std::string> groupOf;
  std::array<Rows, 2> rows, baseline;
  for (const TableRecord& r : records) {
    const auto at = std::find(study.groups.begin(), study.groups.end(), r.group);
    if (at == study.groups.end()) {
      if (!r.group.empty()) ++otherGroup;
      continue;
    }
    if (const auto [known, added] = groupOf.emplace(r.participant, r.group); !added && known->second != r.group) {
      throw Error(ErrorKind::refused, Where{table.path, fmt::format("line {}", r.line)},
                  fmt::format("participant \"{}\" is in both groups ({}, {}), which must be independent",
                              shown(r.participant), shown(known->second), shown(r.group)));
    }
    const auto g = static_cast<std::size_t>(at - study.groups.begin());
    if (options.occasion.empty() || r.occasion == options.occasion) {
      rows[g][r.participant].push_back(&r);
    } else if (!options.baselineOccasion.empty() && r.occasion == options.baselineOccasion) {
      ++asBaseline;
      baseline[g][r.participant].push_back(&r);
    } else {
      ++otherOccasion;
    }
  }
  bool several = false;
  const std::uint64_t later = applyRule(rows, table, options, several);
  (void)applyRule(baseline, table, options, several);
  study.attemptRule = !several                                    ? "one row each"
                      : options.attemptRule == AttemptRule::first ? "the first of a participant's rows in the table"
                                                                  : "the mean of a participant's rows";
  addReasons(study.flow, {{"no group", byGroup.ungrouped},
                          {"another group", otherGroup},
                          {"the baseline, for adjustment", asBaseline},
                          {"another occasion", otherOccasion},
                          {"later row of a participant (the first counts)", later}});
  for (std::size_t g = 0; g < 2; ++g) {
    study.participants[g] = rows[g].size();
    for (const auto& [person, list] : rows[g]) {
      study.attempts[g] += list.size();
      study.people[person] = {g, list.size()};
    }
    study.analysedPeople[study.groups[g]] = rows[g].size();
    study.analysed += study.attempts[g];
  }
  if (!options.occasion.empty()) study.remarks.push_back(fmt::format("Compared at occasion {}.", options.occasion));
  if (!options.occasionColumns.empty()) nameAbsent(study, groupOf, records);

  for (std::size_t o = 0; o < outcomes.size(); ++o) {
    StudyRow row;
    row.checkpoint = row.title = outcomes[o].name;
    row.direction = outcomes[o].direction;
    if (options.protocol) declareRow(row, study, *options.protocol);
    StudySample sample = sampleOf(rows, o);
    for (const auto& [person, group] : groupOf) {
      const std::size_t g = group == study.groups[0] ? 0 : 1;
      if (rows[g].count(person) == 0)
        sample.missing[g][person].push_back({Availability::notAvailable, "no row at " + options.occasion});
    }
    fillRow(row, sample);
    compareGroups(row, study, {});
    if (!options.baselineOccasion.empty()) {
      StudyRow before;
      fillRow(before, sampleOf(baseline, o));
      row.adjusted = adjustment(row, before);
    }
    study.rows.push_back(std::move(row));
  }
  finishRows(study, options, options.protocol ? &*options.protocol : nullptr);
  return study;
}

namespace {

/// Squares of what is larger, and their sums, might not be finite.
constexpr double largest = 1e100;

constexpr const char* missingWord = "NA";  // R's

/// Names are printed: a line break or another control character could forge output.
void askForPlainName(const CsvTable& table, std::size_t line, const std::string& column, const std::string& name) {
  const auto control = [](char c) { return (c >= 0 && c < ' ') || c == '\x7F'; };
  if (std::any_of(name.begin(), name.end(), control))
    failAt(table, line, column, fmt::format("\"{}\" holds a line break or a control character", shown(name)));
}

}  // namespace

void failAt(const CsvTable& table, std::size_t line, const std::string& column, const std::string& what) {
  throw Error(ErrorKind::damaged, Where{table.path, fmt::format("line {}", line)},
              fmt::format("column \"{}\": {}", shown(column), what));
}

std::vector<Outcome> outcomesOf(const CsvTable& table, const TableStudyOptions& options) {
  std::vector<Outcome> outcomes;
  for (const std::string& text : options.outcomes) {
    Outcome outcome{text, Direction::none, 0};
    // A column may itself be called "a:lower".
    if (const std::size_t colon = text.rfind(':'); !table.has(text) && colon != std::string::npos) {
      const std::string word = text.substr(colon + 1);
      if (word != "lower" && word != "higher") {
        throw Error(
            ErrorKind::invalid,
            fmt::format("study: outcome \"{}\": behind the colon stands what is better, lower or higher", shown(text)));
      }
      outcome = {text.substr(0, colon), word == "lower" ? Direction::lower : Direction::higher, 0};
    }
    outcome.column = table.column(outcome.name);
    askForPlainName(table, 1, outcome.name, outcome.name);
    for (const Outcome& other : outcomes) {
      if (other.column == outcome.column)
        throw Error(ErrorKind::invalid, fmt::format("study: outcome \"{}\" is named twice", shown(outcome.name)));
    }
    outcomes.push_back(outcome);
  }
  return outcomes;
}

std::vector<TableRecord> recordsOf(const CsvTable& table, const TableStudyOptions& options,
                                   const std::vector<Outcome>& outcomes) {
  const std::size_t participant = table.column(options.participantColumn);
  const std::optional<std::size_t> group =
      options.groupColumn.empty() ? std::nullopt : std::optional(table.column(options.groupColumn));
  std::vector<std::size_t> occasion;
  for (const std::string& name : options.occasionColumns) occasion.push_back(table.column(name));
  std::vector<TableRecord> records;
  records.reserve(table.rows.size());
  for (const CsvRow& row : table.rows) {
    TableRecord record{row.line, row.cells[participant], group ? row.cells[*group] : std::string(), "", {}};
    if (record.participant.empty())
      failAt(table, row.line, options.participantColumn, "is empty; every row needs its participant");
    askForPlainName(table, row.line, options.participantColumn, record.participant);
    askForPlainName(table, row.line, options.groupColumn, record.group);
    for (std::size_t i = 0; i < occasion.size(); ++i) {
      if (row.cells[occasion[i]].empty())
        failAt(table, row.line, options.occasionColumns[i], "is empty; every row needs its occasion");
      askForPlainName(table, row.line, options.occasionColumns[i], row.cells[occasion[i]]);
      record.occasion += (i == 0 ? "" : "/") + row.cells[occasion[i]];
    }
    for (const Outcome& outcome : outcomes) {
      const std::string& cell = row.cells[outcome.column];
      std::optional<double> value;
      if (!cell.empty() && cell != missingWord) {
        std::string fault;
        value = recorder::readFiniteNumber(table.withPoint(cell), fault);
        if (fault.empty() && std::abs(*value) > largest)
          failAt(table, row.line, outcome.name, fmt::format("\"{}\" is larger than {}", shown(cell), largest));
        if (!fault.empty())
          failAt(table, row.line, outcome.name, fault + "; leave the cell empty, or NA, where a value is missing");
      }
      record.values.push_back(value);
    }
    records.push_back(std::move(record));
  }
  return records;
}

void checkColumns(const TableStudyOptions& options, bool needsGroup) {
  if (options.participantColumn.empty())
    fail("which column of the table names the participant is not said", {Remedy::nameParticipantColumn});
  if (options.groupColumn.empty() && needsGroup)
    fail("which column of the table names the group is not said", {Remedy::nameGroupColumn});
  if (options.outcomes.empty()) fail("a table needs at least one outcome", {Remedy::nameOutcome});
  if (options.occasionColumns.empty() && !(options.occasion + options.baselineOccasion).empty())
    fail("an occasion needs the column that names occasions", {Remedy::nameOccasionColumn});
}

RowsByGroup rowsByGroup(const std::vector<TableRecord>& records) {
  RowsByGroup rows;
  for (const TableRecord& r : records) ++(r.group.empty() ? rows.ungrouped : rows.present[r.group]);
  if (rows.ungrouped > 0) rows.left = fmt::format(" ({} rows have none)", rows.ungrouped);
  return rows;
}

void addReasons(std::vector<FlowRow>& flow, const std::vector<FlowRow>& counted) {
  std::copy_if(counted.begin(), counted.end(), std::back_inserter(flow),
               [](const FlowRow& row) { return row.attempts > 0; });
}

void askForOccasion(const CsvTable& table, const std::vector<TableRecord>& records, const std::string& occasion) {
  std::set<std::string> known;
  for (const TableRecord& r : records) known.insert(r.occasion);
  if (occasion.empty() || known.count(occasion) > 0) return;
  std::string list;
  for (const std::string& name : known) list += (list.empty() ? "" : ", ") + shown(name);
  throw Error(ErrorKind::invalid, Where{table.path},
              fmt::format("there is no occasion \"{}\" (there are: {})", shown(occasion), list));
}

}  // namespace calot::analytics
