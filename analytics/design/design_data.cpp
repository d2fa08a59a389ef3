// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/design/design_data.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <filesystem>
#include <map>
#include <set>

#include "analytics/report/study_population.h"
#include "analytics/report/table_study.h"
#include "analytics/statistics/descriptive.h"
#include "recorder/base/errors.h"
#include "recorder/base/text_words.h"

namespace calot::analytics {
namespace {

constexpr std::array<DesignEntry, 9> allDesigns{{
    {Design::twoGroups, "two-groups", "Do two groups differ", "Mann-Whitney, A, shift", GroupsNeeded::two, true},
    {Design::severalGroups, "groups", "Do three or more groups differ", "Kruskal-Wallis, Dunn's pairs",
     GroupsNeeded::several, true},
    {Design::strata, "strata", "Do two groups differ within sites", "van Elteren", GroupsNeeded::two, true},
    {Design::repeated, "repeated", "Do two groups change differently over their attempts",
     "each participant's change, Brunner-Munzel", GroupsNeeded::two, false},
    {Design::timeToCriterion, "time-to-criterion", "Who finishes sooner, unfinished attempts included",
     "log-rank, Kaplan-Meier", GroupsNeeded::two, true},
    {Design::learning, "learning", "How fast do groups learn, and who has reached the criterion",
     "curves, attempts to criterion", GroupsNeeded::any, false},
    {Design::correlation, "correlation", "Do figures go with another, such as a rating", "Spearman", GroupsNeeded::none,
     true},
    {Design::agreement, "agreement", "Do two devices or methods measure the same", "Bland-Altman, Deming",
     GroupsNeeded::none, true},
    {Design::reliability, "reliability", "How far are figures repeatable over raters or attempts",
     "variance components, D-study, SEM, SDC", GroupsNeeded::none, false},
}};

}  // namespace

std::span<const DesignEntry> designs() { return allDesigns; }

const DesignEntry& entryOf(Design design) { return allDesigns[static_cast<std::size_t>(design)]; }

std::optional<Design> designOf(std::string_view name) {
  const auto at =
      std::find_if(allDesigns.begin(), allDesigns.end(), [&](const DesignEntry& e) { return e.name == name; });
  return at == allDesigns.end() ? std::nullopt : std::optional(at->design);
}

namespace {

std::string commaList(const std::vector<std::string>& names) {
  std::string text;
  for (const std::string& name : names) text += (text.empty() ? "" : ", ") + recorder::shown(name);
  return text.empty() ? "none" : text;
}

/// A figure is named by its whole name or by its checkpoint's.
bool isFigure(const DesignFigure& figure, const std::string& name) {
  return figure.name == name || (figure.name.rfind(name + " ", 0) == 0 && figure.name.rfind("rating ", 0) != 0);
}

}  // namespace

std::vector<std::string> groupsOfDesign(const std::map<std::string, std::uint64_t>& present,
                                        const DesignChoices& choices, const std::string& path,
                                        const std::string& left) {
  const DesignEntry& entry = entryOf(choices.design);
  std::vector<std::string> there;
  there.reserve(present.size());
  for (const auto& item : present) there.push_back(item.first);
  std::sort(there.begin(), there.end(), groupBefore);
  for (const std::string& name : choices.groups) {
    if (std::count(choices.groups.begin(), choices.groups.end(), name) > 1)
      throw Error(ErrorKind::invalid, fmt::format("study: group \"{}\" is named twice", recorder::shown(name)));
    if (present.count(name) == 0) {
      throw Error(ErrorKind::refused, Where{path},
                  fmt::format("no attempt for the study in group \"{}\" (there are: {}){}", recorder::shown(name),
                              commaList(there), left));
    }
  }
  std::vector<std::string> groups = choices.groups;
  if (groups.empty()) groups = there;
  const bool fits = entry.groups == GroupsNeeded::two       ? groups.size() == 2
                    : entry.groups == GroupsNeeded::several ? groups.size() >= 3
                    : entry.groups == GroupsNeeded::any     ? !groups.empty()
                                                            : true;
  if (fits) return groups;
  const char* needed = entry.groups == GroupsNeeded::two       ? "two groups"
                       : entry.groups == GroupsNeeded::several ? "three or more groups"
                                                               : "a group";
  throw Error(ErrorKind::refused, Where{path},
              fmt::format("the design \"{}\" needs {}; there are {} ({}){}", entry.name, needed, groups.size(),
                          commaList(groups), left),
              groups.size() > 2 ? std::initializer_list<Remedy>{Remedy::nameGroups} : std::initializer_list<Remedy>{});
}

void keepNamedFigures(DesignData& data, const DesignChoices& choices) {
  std::vector<std::string> wanted = choices.family;
  if (!choices.against.empty()) wanted.push_back(choices.against);
  std::vector<std::string> there;
  for (const DesignFigure& f : data.figures) there.push_back(f.name);
  for (const std::string& name : wanted) {
    if (std::none_of(data.figures.begin(), data.figures.end(), [&](const auto& f) { return isFigure(f, name); })) {
      throw Error(ErrorKind::invalid, Where{data.where},
                  fmt::format("there is no figure \"{}\"{} (there are: {})", recorder::shown(name),
                              recorder::didYouMean(name, there), commaList(there)));
    }
  }
  if (choices.family.empty()) return;
  data.figures.erase(std::remove_if(data.figures.begin(), data.figures.end(),
                                    [&](const DesignFigure& f) {
                                      return std::none_of(wanted.begin(), wanted.end(),
                                                          [&](const std::string& name) { return isFigure(f, name); });
                                    }),
                     data.figures.end());
}

void sortValues(DesignFigure& figure) {
  std::stable_sort(figure.values.begin(), figure.values.end(), [](const DesignValue& a, const DesignValue& b) {
    return a.person != b.person ? a.person < b.person : a.order < b.order;
  });
}

OneEach oneEachOf(const DesignFigure& figure) {
  OneEach result;
  std::vector<RepeatedValue> values;
  for (const DesignValue& v : figure.values) values.push_back({v.person, v.order, v.value});
  const Expected<std::vector<ParticipantValue>> each = onePerParticipant(values, AttemptRule::mean);
  if (!each) return result;
  for (const ParticipantValue& p : *each) {
    result.person.push_back(p.participant);
    result.value.push_back(p.value);
  }
  return result;
}

std::vector<std::vector<double>> byGroup(const DesignData& data, const OneEach& values) {
  std::vector<std::vector<double>> groups(std::max<std::size_t>(data.groups.size(), 1));
  for (std::size_t i = 0; i < values.person.size(); ++i)
    groups[data.people[values.person[i]].group].push_back(values.value[i]);
  return groups;
}

namespace {

using recorder::shown;

/// One row that is taken.
struct TakenRow {
  const TableRecord* record = nullptr;
  std::string stratum;
  bool finished = true;
};

std::optional<std::size_t> columnIfNamed(const CsvTable& table, const std::string& name) {
  return name.empty() ? std::nullopt : std::optional(table.column(name));
}

bool finishedIn(const CsvTable& table, const CsvRow& row, const std::optional<std::size_t>& column) {
  if (!column) return true;
  const std::string& cell = row.cells[*column];
  if (cell == "1" || cell == "yes" || cell == "true" || cell == "TRUE") return true;
  if (cell == "0" || cell == "no" || cell == "false" || cell == "FALSE") return false;
  failAt(table, row.line, table.columns[*column],
         fmt::format("\"{}\" is neither 1, yes nor true, nor 0, no or false", shown(cell)));
}

/// By occasion in the order of the table, or by number where all are numbers.
void orderOccasions(DesignData& data, const std::vector<TakenRow>& rows) {
  std::map<std::string, double> numbers;
  for (const TakenRow& row : rows) {
    const std::string& name = row.record->occasion;
    if (std::find(data.occasions.begin(), data.occasions.end(), name) == data.occasions.end())
      data.occasions.push_back(name);
    std::string fault;
    const double number = recorder::readFiniteNumber(name, fault);
    if (fault.empty()) numbers[name] = number;
  }
  data.numbered = numbers.size() == data.occasions.size();
  if (!data.numbered) return;
  std::sort(data.occasions.begin(), data.occasions.end(),
            [&](const std::string& a, const std::string& b) { return numbers[a] < numbers[b]; });
}

/// Rows of each participant in the table's order; without an occasion column they are numbered.
/// @throws Error (refused) for one in two groups or strata, and of designs with one value each for several rows without
/// a rule.
std::map<std::string, std::vector<TakenRow>> rowsByPerson(DesignData& data, const std::vector<TakenRow>& taken,
                                                          const CsvTable& table, const DesignChoices& choices) {
  const DesignEntry& entry = entryOf(choices.design);
  const bool byOccasion = choices.design == Design::agreement && choices.against.empty();
  std::map<std::string, std::vector<TakenRow>> people;
  for (const TakenRow& row : taken) people[row.record->participant].push_back(row);
  std::uint64_t later = 0;
  bool several = false;
  for (auto& [person, list] : people) {
    std::set<std::string> seen;
    std::vector<TakenRow> first;
    for (const TakenRow& row : list) {
      const Where where{table.path, fmt::format("line {}", row.record->line)};
      if (!data.groups.empty() && row.record->group != list[0].record->group)
        throw Error(ErrorKind::refused, where,
                    fmt::format("participant \"{}\" is in two groups ({}, {}), which must be independent",
                                shown(person), shown(list[0].record->group), shown(row.record->group)));
      if (row.stratum != list[0].stratum)
        throw Error(ErrorKind::refused, where,
                    fmt::format("participant \"{}\" is in two strata ({}, {})", shown(person), shown(list[0].stratum),
                                shown(row.stratum)));
      if (seen.insert(byOccasion ? row.record->occasion : std::string()).second) {
        first.push_back(row);
      } else if (entry.oneEach && !choices.attemptRule) {
        throw Error(ErrorKind::refused, where,
                    fmt::format("participant \"{}\" has several rows{}, which are not independent", shown(person),
                                byOccasion ? " at " + shown(row.record->occasion) : ""),
                    {Remedy::chooseOccasion, Remedy::chooseAttemptRule});
      }
    }
    if (!entry.oneEach || first.size() == list.size()) continue;
    several = true;
    if (choices.attemptRule != AttemptRule::first) continue;
    later += list.size() - first.size();
    list = first;
  }
  data.attemptRule = !entry.oneEach                              ? "all rows of each"
                     : !several                                  ? "one row each"
                     : choices.attemptRule == AttemptRule::first ? "the first of a participant's rows in the table"
                                                                 : "the mean of a participant's rows";
  if (later > 0) data.flow.push_back({"later row of a participant (the first counts)", later});
  return people;
}

std::size_t placeOf(const std::vector<std::string>& names, const std::string& name) {
  return static_cast<std::size_t>(std::find(names.begin(), names.end(), name) - names.begin());
}

}  // namespace

DesignData tableDesignData(const CsvTable& table, const TableStudyOptions& asked, const DesignChoices& choices) {
  TableStudyOptions options = asked;
  const GroupsNeeded needed = entryOf(choices.design).groups;
  checkColumns(options, needed == GroupsNeeded::two || needed == GroupsNeeded::several);
  if (options.groupColumn.empty() && !choices.groups.empty())
    throw Error(ErrorKind::invalid, "study: groups need the column that names them", {Remedy::nameGroupColumn});
  DesignChoices kept = choices;
  if (!choices.against.empty()) {
    if (table.has(choices.against) || choices.against.find(':') != std::string::npos) {
      const std::size_t colon = choices.against.rfind(':');
      kept.against = table.has(choices.against) ? choices.against : choices.against.substr(0, colon);
    }
    if (std::none_of(options.outcomes.begin(), options.outcomes.end(),
                     [&](const std::string& o) { return o == kept.against || o.rfind(kept.against + ":", 0) == 0; }))
      options.outcomes.push_back(choices.against);
  }
  const std::vector<Outcome> outcomes = outcomesOf(table, options);
  const std::vector<TableRecord> records = recordsOf(table, options, outcomes);
  askForOccasion(table, records, options.occasion);
  DesignData data;
  data.source = "table";
  data.counted = "rows";
  data.where = std::filesystem::path(table.path).filename().string();
  data.recruited = records.size();
  data.head.push_back(fmt::format("Table {}.", data.where));
  const std::optional<std::size_t> stratum = columnIfNamed(table, choices.strata);
  const std::optional<std::size_t> finished = columnIfNamed(table, choices.finishedColumn);
  std::uint64_t otherGroup = 0, otherOccasion = 0, without = 0;
  const RowsByGroup byGroup = rowsByGroup(records);
  if (!options.groupColumn.empty()) data.groups = groupsOfDesign(byGroup.present, choices, table.path, byGroup.left);
  if (data.groups.size() == 2) data.better = betterOf({data.groups[0], data.groups[1]}, choices);
  std::vector<TakenRow> taken;
  std::set<std::string> strata;
  for (std::size_t i = 0; i < records.size(); ++i) {
    const TableRecord& r = records[i];
    if (!data.groups.empty() && placeOf(data.groups, r.group) == data.groups.size()) {
      if (!r.group.empty()) ++otherGroup;
    } else if (!options.occasion.empty() && r.occasion != options.occasion) {
      ++otherOccasion;
    } else if (stratum && table.rows[i].cells[*stratum].empty()) {
      ++without;
    } else {
      taken.push_back(
          {&r, stratum ? table.rows[i].cells[*stratum] : std::string(), finishedIn(table, table.rows[i], finished)});
      if (stratum) strata.insert(taken.back().stratum);
    }
  }
  data.strata.assign(strata.begin(), strata.end());
  addReasons(data.flow, {{"no group", data.groups.empty() ? 0 : byGroup.ungrouped},
                         {"another group", otherGroup},
                         {"another occasion", otherOccasion},
                         {"no " + choices.strata, without}});
  const bool named = !options.occasionColumns.empty();
  data.occasionWord = named ? options.occasionColumns[0] : "row";
  if (named) orderOccasions(data, taken);
  for (const Outcome& outcome : outcomes) data.figures.push_back({outcome.name, "", outcome.direction, {}});
  for (const auto& [person, list] : rowsByPerson(data, taken, table, choices)) {
    DesignPerson p{person, 0, 0};
    if (!data.groups.empty()) p.group = placeOf(data.groups, list[0].record->group);
    if (stratum) p.stratum = placeOf(data.strata, list[0].stratum);
    for (std::size_t i = 0; i < list.size(); ++i) {
      const TakenRow& row = list[i];
      ++data.analysed;
      const std::size_t occasion = named ? placeOf(data.occasions, row.record->occasion) : i;
      if (!named && occasion == data.occasions.size()) data.occasions.push_back(fmt::format("{}", i + 1));
      for (std::size_t o = 0; o < outcomes.size(); ++o) {
        if (!row.record->values[o]) continue;
        data.figures[o].values.push_back({data.people.size(), occasion,
                                          static_cast<double>(named && data.numbered ? occasion + 1 : i + 1),
                                          row.finished, *row.record->values[o]});
      }
    }
    ++data.analysedPeople[data.groups.empty() ? "" : data.groups[p.group]];
    data.people.push_back(std::move(p));
  }
  for (DesignFigure& figure : data.figures) sortValues(figure);
  keepNamedFigures(data, kept);
  return data;
}

}  // namespace calot::analytics
