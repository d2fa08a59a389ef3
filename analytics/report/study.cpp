// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/report/study.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <set>
#include <string_view>

#include "analytics/checkpoints/checkpoint.h"
#include "analytics/cohort/blinding.h"
#include "analytics/report/study_people.h"
#include "analytics/report/study_population.h"
#include "analytics/report/study_protocol.h"
#include "analytics/report/study_rows.h"
#include "analytics/statistics/descriptive.h"
#include "analytics/statistics/two_groups.h"
#include "recorder/base/errors.h"
#include "recorder/base/text_words.h"

namespace calot::analytics {
namespace {

/// Each participant's mean in a world.
std::vector<double> meansIn(std::size_t world, const std::vector<RangedValue>& values) {
  std::map<std::size_t, std::pair<double, double>> sums;  // sum and count
  for (const RangedValue& v : values) {
    auto& [sum, count] = sums[v.participant];
    sum += v.worlds[world];
    count += 1.0;
  }
  std::vector<double> means;
  means.reserve(sums.size());
  for (const auto& [participant, sum] : sums) means.push_back(sum.first / sum.second);
  return means;
}

}  // namespace

std::optional<SimulationRange> simulationRange(const std::array<std::vector<RangedValue>, 2>& groups) {
  SimulationRange range;
  std::vector<double> halves;
  std::size_t worlds = 0;
  bool alike = true;
  for (const auto& group : groups) {
    for (const RangedValue& v : group) {
      ++range.values;
      if (v.worlds.empty()) continue;
      ++range.known;
      halves.push_back(v.halfWidth);
      alike = alike && (worlds == 0 || worlds == v.worlds.size());
      worlds = v.worlds.size();
    }
  }
  if (range.known == 0 || groups[0].empty() || groups[1].empty()) return std::nullopt;
  range.halfWidth = *median(halves);
  if (range.known < range.values || !alike) return range;
  for (std::size_t w = 0; w < worlds; ++w) {
    const auto here = superiority(meansIn(w, groups[0]), meansIn(w, groups[1]));
    if (!here) continue;
    if (!range.area) range.area = {here->a, here->a};
    range.area->first = std::min(range.area->first, here->a);
    range.area->second = std::max(range.area->second, here->a);
  }
  return range;
}

namespace {

/// Values of one checkpoint and subject. What depends on them alone is looked up once: a large cohort has millions of
/// values.
struct Column {
  StudySample sample;
  std::set<std::uint32_t> versions;
  std::set<Origin> origins;
  std::string unit;        ///< of a checkpoint that the registry does not know
  bool sampled = false;    ///< its values have a coverage
  bool leftAside = false;  ///< of a phase, and not requested
  double factor = 1.0;     ///< to display units
  ExternalMetricRef metric;
};

using ColumnKey = std::pair<std::string, std::string>;  ///< checkpoint, subject

struct Member {
  std::size_t group = 0;
  std::string participant;
  std::size_t number = 0;  ///< by start
  bool unfinished = false;
};

/// Selects the study's attempts; fills the study's counts and the rest of its flow.
std::map<std::string, Member> members(Study& study, const std::vector<AttemptRow>& recruited,
                                      const IncludedAttempts& included, const StudyOptions& options,
                                      const std::string& name) {
  const AttemptsOfUnits people =
      attemptsOfUnits(included.taken, study.groups, options.grouping, {options.attemptRule}, name, study.flow);
  study.attemptRule = people.rule;
  std::map<std::string, Member> member;
  std::set<std::string> keys;
  for (const auto& [person, list] : people.units) {
    const std::size_t g = groupOf(*list[0], options.grouping) == study.groups[0] ? 0 : 1;
    ++study.participants[g];
    study.attempts[g] += list.size();
    study.analysed += list.size();
    addTraits(study.people[person] = {g, list.size()}, list, options);
    for (const AttemptRow* a : list) {
      member.emplace(a->uuid, Member{g, person, member.size(), isUnfinished(*a)});
      study.groupOf[person] = study.groupOf[a->uuid] = study.groups[g];
      study.attemptOf[a->uuid] = {person, a->startUtc};
      keys.insert(a->comparabilityKey);
      addToSetting(study.setting, *a);
      study.synthetic = study.synthetic || a->synthetic;
    }
  }
  study.keys.assign(keys.begin(), keys.end());
  countPeople(study, recruited, included, options, people);
  return member;
}

/// Display unit and factor of a checkpoint; stored as they are where the registry does not know it.
StudyRow describedRow(const ColumnKey& key, const Column& column) {
  StudyRow row;
  row.checkpoint = key.first;
  row.subject = key.second;
  row.title = key.first;
  row.unit = column.unit;
  if (column.metric) row.source = column.metric->sha256;
  const CheckpointDefinition* d = column.metric ? &column.metric->definition : findCheckpoint(key.first);
  if (d != nullptr) {
    row.title = d->title;
    row.unit = d->displayUnit;
    row.direction = d->direction;
    row.notOutcome = d->notOutcome;
  }
  row.versions.assign(column.versions.begin(), column.versions.end());
  std::set<std::string> origins;
  for (const Origin origin : column.origins) origins.insert(nameOf(origin));
  row.origins.assign(origins.begin(), origins.end());
  row.sampled = column.sampled;
  return row;
}

/// Begins the note of `hand-ratio`.
constexpr std::string_view handednessNote = "handedness ";

/// A participant with an attempt that ranks last has no other value beside it: the mean of both is the worst, too.
void leaveToRanks(StudySample& sample) {
  for (std::size_t g = 0; g < 2; ++g)
    std::erase_if(sample.values[g], [&](const StudyValue& v) { return sample.unfinished[g].count(v.participant) > 0; });
}

/// Outcomes with values of attempts that were not finished.
std::string partialFigures(const Study& study) {
  constexpr std::size_t most = 6;
  std::vector<std::string> names;
  for (const StudyRow& row : study.rows) {
    if (row.notOutcome.empty() && row.unfinished[0] + row.unfinished[1] > 0)
      names.push_back(figureName(row.checkpoint, row.subject));
  }
  const std::size_t more = names.size() > most ? names.size() - most : 0;
  names.resize(names.size() - more);
  return fmt::format("{}{}", fmt::join(names, ", "), more > 0 ? fmt::format(" and {} more (marked *)", more) : "");
}

using TakeValue = std::function<void(const AttemptValue&)>;

/// Reading the values takes longer than comparing them, unless the groups are large: a share each.
constexpr double readingShare = 0.6;

/// @param eachValue gives every value to what it is called with, by attempt
Study studyOf(const std::vector<AttemptRow>& recruited, const std::function<void(const TakeValue&)>& eachValue,
              const StudyOptions& asked, const std::string& name, const StudyProgress& progress) {
  const StudyOptions options = asked.protocol ? byProtocol(asked) : asked;
  Study study;
  study.heading = "exploratory";
  study.source = "cohort";
  study.where = std::filesystem::path(name).filename().string();
  study.counted = "attempts";
  if (options.cohort) study.cohort = options.cohort->name;
  study.recruited = recruited.size();
  IncludedAttempts included = includedAttempts(recruited, options);
  study.flow = std::move(included.flow);
  study.groups = chooseGroups(included.present, options, name, leftOutOf(study.recruited, study.flow));
  study.better = betterOf(study.groups, options);
  study.unequalSpread = options.unequalSpread;
  const std::map<std::string, Member> member = members(study, recruited, included, options, name);
  askForOneKey(study.keys, options, name, study.remarks);
  const auto& people = options.people;
  if (!study.synthetic && !people.empty() &&
      std::all_of(people.begin(), people.end(), [](const Participant& p) { return p.consent.empty(); }))
    study.remarks.emplace_back("No consent is recorded in this cohort, so nobody is left out for lack of it.");
  if (options.protocol) {
    std::vector<const AttemptRow*> data;
    for (const AttemptRow& a : recruited) {
      const std::string group = groupOf(a, options.grouping);
      const bool compared = group == study.groups[0] || group == study.groups[1];
      if (member.count(a.uuid) > 0 || (a.excluded && compared)) data.push_back(&a);
    }
    describeProtocol(study, data, options);
  }

  const std::vector<std::string> unasked = unaskedPhases(options);
  const std::set<std::string> leftAside(unasked.begin(), unasked.end());
  std::vector<const AttemptRow*> analysed;
  for (const AttemptRow& a : recruited) {
    if (member.count(a.uuid) > 0) analysed.push_back(&a);
  }
  std::map<ColumnKey, Column> columns;
  std::vector<ColumnKey> order;
  CoverageCollector coverage;
  std::string attempt;  // values come by attempt
  auto at = member.end();
  std::size_t read = 0;  // attempts; those of external metrics come once more, behind all others
  eachValue([&](const AttemptValue& item) {
    if (attempt != item.attempt) {
      at = member.find(attempt = item.attempt);
      const double part = static_cast<double>(++read) / static_cast<double>(recruited.size());
      if (progress) progress(readingShare * std::min(part, 1.0), "reading values");
    }
    if (at == member.end()) return;
    const auto [place, isNew] = columns.try_emplace(ColumnKey{item.value.name, item.value.subject});
    Column& column = place->second;
    if (isNew) {
      column.leftAside = leftAside.count(item.value.name) > 0;
      if (!column.leftAside) order.push_back(place->first);
      if (const CheckpointDefinition* d = findCheckpoint(item.value.name)) column.factor = d->displayFactor;
    }
    if (column.leftAside) return;
    column.unit = item.value.unit;
    const Member& m = at->second;
    column.sampled = column.sampled || item.value.coverage;
    coverage.add(item.value, m.group, m.participant, item.attempt);
    if (item.value.note.starts_with(handednessNote) && !item.value.note.ends_with(" unknown"))
      study.people[m.participant].traits.try_emplace("handedness", item.value.note.substr(handednessNote.size()));
    column.metric = item.value.metric;
    const double factor = column.factor;
    const double shown = withoutDust(item.value, factor) * factor;
    if (!item.value.value || !std::isfinite(shown)) {
      column.sample.missing[m.group][m.participant].push_back(
          item.value.value ? MissingValue{Availability::notAvailable, "not finite"}
                           : MissingValue{item.value.availability, item.value.reason});
      // A hand without an instrument or a tracker that loses it says nothing about the performance.
      const bool ofPerformance = item.value.availability == Availability::notApplicable ||
                                 item.value.availability == Availability::notAvailable;
      if (m.unfinished && ofPerformance && options.protocol &&
          options.protocol->protocol.missing == MissingRule::worstRank)
        column.sample.unfinished[m.group].insert(m.participant);
      return;
    }
    if (m.unfinished) column.sample.partOfTask[m.group].insert(m.participant);
    column.versions.insert(item.value.version);
    column.origins.insert(item.value.origin);
    StudyValue& value = column.sample.values[m.group].emplace_back(StudyValue{m.participant, m.number, shown, {}, 0.0});
    if (item.interval && item.interval->lower) {
      value.halfWidth = 0.5 * factor * (*item.interval->upper - *item.interval->lower);
      for (const double world : item.interval->worlds()) value.worlds.push_back(world * factor);
    }
  });
  std::stable_sort(order.begin(), order.end(),
                   [](const auto& a, const auto& b) { return positionOf(a.first) < positionOf(b.first); });
  study.coverage = coverage.rows();
  if (!options.mixKeys) {
    for (CoverageRow& row : study.coverage) row.refusal = trackersApart(study, row);
  }
  std::array<std::map<std::string, double>, 2> duration;
  for (const ColumnKey& key : order) {
    Column& column = columns[key];
    leaveToRanks(column.sample);
    askForOneVersion(key.first, column.versions.size(), options, name, study.remarks);
    StudyRow& row = study.rows.emplace_back(describedRow(key, column));
    if (options.protocol) declareRow(row, study, options.protocol->protocol);
    if (row.hypothesis || isNamed(row, options.family)) row.notOutcome.clear();
    fillRow(row, column.sample);
    addSimulationRange(row, column.sample);
    if (row.checkpoint != "attempt-duration") continue;
    for (std::size_t g = 0; g < 2; ++g) {
      for (std::size_t i = 0; i < row.values[g].size(); ++i) duration[g][row.participants[g][i]] = row.values[g][i];
    }
  }
  const bool phases = std::any_of(study.rows.begin(), study.rows.end(),
                                  [](const StudyRow& row) { return row.checkpoint == phaseDurationName; });
  study.phasesLeftOut = phases && !unasked.empty();
  if (study.phasesLeftOut) study.remarks.emplace_back("Other checkpoints of single phases are left out.");
  for (std::size_t i = 0; i < study.rows.size(); ++i) {
    if (progress)
      progress(readingShare + (1.0 - readingShare) * static_cast<double>(i) / static_cast<double>(study.rows.size()),
               "comparing groups");
    compareGroups(study.rows[i], study, duration);
  }
  addPublished(study);
  if (std::string remark = unfinishedRemark(analysed, study.groups, options.grouping, partialFigures(study));
      !remark.empty())
    study.remarks.push_back(std::move(remark));
  finishRows(study, options, options.protocol ? &options.protocol->protocol : nullptr);
  return study;
}

}  // namespace

StudyOptions withCohortData(const CohortDatabase& database, StudyOptions options) {
  if (options.cohort) options.cohort->participants = participantsOf(database.path(), options.cohort->name);
  options.people = database.participants();
  if (options.protocol) {
    for (const Participant& p : options.people) options.protocol->experience[p.pseudonym] = p.experience;
  }
  return options;
}

Study makeStudy(const CohortDatabase& database, const StudyOptions& options, const StudyProgress& progress) {
  refuseWhileMasked(database.path(), options.protocol ? options.protocol->protocol.sha256 : "");
  const StudyOptions known = withCohortData(database, options);
  const auto each = [&](const TakeValue& take) { database.eachValue(unaskedPhases(known), take); };
  return studyOf(database.listAttempts(), each, known, database.path(), progress);
}

Study makeStudy(const std::vector<AttemptRow>& recruited, const std::vector<AttemptValue>& values,
                const StudyOptions& asked, const std::string& name, const StudyProgress& progress) {
  const auto each = [&](const TakeValue& take) { std::for_each(values.begin(), values.end(), take); };
  return studyOf(recruited, each, asked, name, progress);
}

void addRatings(Study& study, const CohortDatabase& database) {
  study.ratings = reportForms(database, study.groupOf, {study.groups[0], study.groups[1]}, study.attemptOf);
}

}  // namespace calot::analytics
