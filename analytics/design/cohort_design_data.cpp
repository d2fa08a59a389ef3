// SPDX-License-Identifier: GPL-3.0-or-later
// A cohort's attempts and values as a design needs them.

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>
#include <span>

#include "analytics/checkpoints/checkpoint.h"
#include "analytics/cohort/blinding.h"
#include "analytics/design/design_data.h"
#include "analytics/report/study_people.h"
#include "analytics/report/study_population.h"
#include "analytics/report/study_rows.h"
#include "recorder/base/errors.h"
#include "recorder/base/text_words.h"

namespace calot::analytics {
namespace {

/// Facts about an analysed attempt that a design uses.
struct Placed {
  std::size_t person = 0, occasion = 0;
  double order = 1.0;
  bool completed = false, unfinished = false;
  double seconds = 0.0;  ///< how long it lasted
};
/// By uuid.
using PlacedAttempts = std::map<std::string, Placed>;

/// Place of a name, which is appended if it is new.
std::size_t positionIn(std::vector<std::string>& names, const std::string& name) {
  const auto at = std::find(names.begin(), names.end(), name);
  if (at != names.end()) return static_cast<std::size_t>(at - names.begin());
  names.push_back(name);
  return names.size() - 1;
}

/// People, strata, occasions and counts of these attempts.
PlacedAttempts place(DesignData& data, const std::map<std::string, std::vector<const AttemptRow*>>& people,
                     const StudyOptions& options, const DesignChoices& choices) {
  PlacedAttempts placed;
  const bool byDevice = choices.design == Design::agreement && choices.against.empty();
  data.occasionWord = byDevice ? "device" : "attempt";
  data.numbered = !byDevice;
  std::set<std::string> strata, devices;
  std::size_t most = 0;
  for (const auto& [person, list] : people) {
    if (!choices.strata.empty()) strata.insert(stratumOf(*list[0], choices.strata));
    for (const AttemptRow* a : list) devices.insert(a->device);
    most = std::max(most, list.size());
  }
  data.strata.assign(strata.begin(), strata.end());
  if (byDevice) data.occasions.assign(devices.begin(), devices.end());
  for (std::size_t i = 0; !byDevice && i < most; ++i) data.occasions.push_back(fmt::format("{}", i + 1));
  for (const auto& [person, list] : people) {
    DesignPerson p{person, 0, 0};
    if (const std::string group = groupOf(*list[0], options.grouping); !data.groups.empty())
      p.group = positionIn(data.groups, group.empty() ? "no group" : group);
    if (!choices.strata.empty()) p.stratum = positionIn(data.strata, stratumOf(*list[0], choices.strata));
    for (std::size_t i = 0; i < list.size(); ++i) {
      const AttemptRow& a = *list[i];
      placed[a.uuid] = {data.people.size(),
                        byDevice ? positionIn(data.occasions, a.device) : i,
                        static_cast<double>(i + 1),
                        a.outcome == recorder::Outcome::completed,
                        isUnfinished(a),
                        static_cast<double>(a.steps) * a.stepSeconds};
      data.attempts.push_back(a.uuid);
      data.synthetic = data.synthetic || a.synthetic;
      ++data.analysed;
    }
    data.people.push_back(std::move(p));
  }
  return placed;
}

constexpr const char* timeFigure = "elapsed-time";
constexpr const char* durationFigure = "attempt-duration";

/// Mean of all items of a completed form, or none.
std::optional<double> scoreOf(const Rating& rating, const std::vector<FormItem>& items) {
  double sum = 0.0;
  for (const FormItem& item : items) {
    const auto at = rating.answers.find(item.key);
    if (at == rating.answers.end()) return std::nullopt;
    sum += at->second;
  }
  return items.empty() ? std::nullopt : std::optional(sum / static_cast<double>(items.size()));
}

/// Checkpoints that are outcomes or asked for, in the registry's order. @throws Error (refused) for values of several
/// versions of a checkpoint, unless these are mixed.
void addFigures(DesignData& data, const std::vector<AttemptValue>& values, const PlacedAttempts& placed,
                const StudyOptions& options, const DesignChoices& choices, const std::string& name) {
  const std::vector<std::string> unasked = unaskedPhases(options);
  const std::set<std::string> aside(unasked.begin(), unasked.end());
  std::map<std::pair<std::size_t, std::string>, DesignFigure> figures;
  std::map<std::string, std::set<std::uint32_t>> versions;
  TrackerSpread trackers;
  for (const AttemptValue& item : values) {
    const auto at = placed.find(item.attempt);
    const CheckpointDefinition* d = findCheckpoint(item.value.name);
    if (at == placed.end() || d == nullptr || aside.count(item.value.name) > 0) continue;
    const std::string full = figureName(d->name, item.value.subject);
    const auto named = [&](const std::string& n) { return n == d->name || n == full; };
    if (!d->notOutcome.empty() && !named(choices.against) &&
        std::none_of(choices.family.begin(), choices.family.end(), named))
      continue;
    DesignFigure& figure = figures[{positionOf(d->name), full}];
    figure.name = full;
    figure.unit = d->displayUnit == "1" ? "" : d->displayUnit;
    figure.direction = d->direction;
    versions[full].insert(item.value.version);
    trackers.add(item.value);
    const double shown = item.value.value.value_or(HUGE_VAL) * d->displayFactor;
    if (std::isfinite(shown))
      figure.values.push_back({at->second.person, at->second.occasion, at->second.order, at->second.completed, shown});
  }
  if (std::string warning = trackers.warning(); !warning.empty()) data.remarks.push_back(std::move(warning));
  for (auto& [key, figure] : figures) {
    askForOneVersion(figure.name, versions[figure.name].size(), options, name, data.remarks);
    sortValues(figure);
    data.figures.push_back(std::move(figure));
  }
}

/// The elapsed time alone; an attempt that was not completed is followed as long as it lasted.
void keepTimes(DesignData& data, const std::vector<AttemptValue>& values, const PlacedAttempts& placed) {
  DesignFigure times{timeFigure, "s", Direction::lower, {}};
  std::map<std::string, double> lasted;
  for (const AttemptValue& item : values) {
    if (item.value.name == durationFigure && item.value.value) lasted[item.attempt] = *item.value.value;
  }
  for (const DesignFigure& f : data.figures) {
    if (f.name != timeFigure) continue;
    for (const DesignValue& v : f.values) {
      if (v.finished) times.values.push_back(v);
    }
  }
  for (const auto& [uuid, p] : placed) {
    if (p.completed) continue;
    const auto at = lasted.find(uuid);
    times.values.push_back(
        {p.person, p.occasion, p.order, false, at == lasted.end() ? p.seconds : at->second, p.unfinished});
  }
  sortValues(times);
  data.figures = {std::move(times)};
}

/// Ratings by a form: mean of its items and of its raters, where it is named that of their sum, and of each rater of a
/// participant's first rated attempt.
void addForm(DesignData& data, const RatingForm& form, const std::vector<Rating>& ratings, const PlacedAttempts& placed,
             const DesignChoices& choices) {
  std::map<std::string, std::map<std::string, double>> scores;  // by attempt, by rater
  for (const Rating& r : ratings) {
    if (r.form != form.name || r.formVersion != form.version || placed.count(r.attempt) == 0) continue;
    if (const std::optional<double> score = scoreOf(r, form.items())) scores[r.attempt][r.rater] = *score;
  }
  if (scores.empty()) return;
  DesignFigure figure{"rating " + form.name, "", Direction::higher, {}};
  DesignFigure raters = figure;
  std::map<std::size_t, std::pair<double, std::string>> first;  // of each person the earliest rated attempt
  for (const auto& [uuid, given] : scores) {
    const Placed& p = placed.at(uuid);
    double sum = 0.0;
    for (const auto& item : given) sum += item.second;
    figure.values.push_back({p.person, p.occasion, p.order, true, sum / static_cast<double>(given.size())});
    const auto at = first.find(p.person);
    if (at == first.end() || p.order < at->second.first) first[p.person] = {p.order, uuid};
  }
  for (const auto& [person, attempt] : first) {
    for (const auto& [rater, score] : scores[attempt.second])
      raters.values.push_back({person, positionIn(data.raters, rater), attempt.first, true, score});
  }
  sortValues(figure);
  DesignFigure total = figure;
  total.name += " sum";
  for (DesignValue& v : total.values) v.value *= static_cast<double>(form.items().size());
  data.figures.push_back(std::move(figure));
  if (choices.against == total.name || std::count(choices.family.begin(), choices.family.end(), total.name) > 0)
    data.figures.push_back(std::move(total));
  data.rated.push_back(std::move(raters));
}

DesignData populated(const std::vector<AttemptRow>& recruited, const std::vector<AttemptValue>& values,
                     const StudyOptions& options, const DesignChoices& choices, const std::string& name,
                     PlacedAttempts& placed) {
  DesignData data;
  data.source = "cohort";
  data.counted = "attempts";
  data.where = std::filesystem::path(name).filename().string();
  const bool grouped = entryOf(choices.design).groups != GroupsNeeded::none || !choices.groups.empty();
  StudyOptions rules = options;
  if (!grouped) rules.grouping = Grouping::group;
  data.recruited = recruited.size();
  IncludedAttempts included = includedAttempts(recruited, rules, choices.strata, !grouped);
  data.flow = std::move(included.flow);
  std::vector<const AttemptRow*>& taken = included.taken;
  if (grouped) {
    data.groups = groupsOfDesign(included.present, choices, name, leftOutOf(data.recruited, data.flow));
    const std::size_t others = std::erase_if(taken, [&](const AttemptRow* a) {
      return std::find(data.groups.begin(), data.groups.end(), groupOf(*a, options.grouping)) == data.groups.end();
    });
    if (others > 0) data.flow.push_back({"another group", others});
  }
  if (data.groups.size() == 2) data.better = betterOf({data.groups[0], data.groups[1]}, choices);
  std::set<std::string> keys;
  StudySetting setting;
  for (const AttemptRow* a : taken) {
    keys.insert(a->comparabilityKey);
    addToSetting(setting, *a);
  }
  const std::vector<std::string> keyList(keys.begin(), keys.end());
  askForOneKey(keyList, options, name, data.remarks);
  const bool byDevice = choices.design == Design::agreement && choices.against.empty();
  const AttemptsOfUnits people =
      attemptsOfUnits(taken, data.groups, options.grouping,
                      {choices.attemptRule, entryOf(choices.design).oneEach, byDevice}, name, data.flow);
  data.attemptRule = people.rule;
  countPeople(data, recruited, included, rules, people);
  if (choices.design == Design::reliability && !grouped) {  // analysed together, and each beside it
    std::set<std::string> names;
    for (const AttemptRow* a : taken) names.insert(groupOf(*a, options.grouping));
    names.erase("");
    if (names.size() > 1) data.groups.assign(names.begin(), names.end());
  }
  placed = place(data, people.units, options, choices);
  for (const std::string& key : keyList) data.head.push_back(keySentence(key));
  const std::string first = setting.firstStartUtc.substr(0, 10), last = setting.lastStartUtc.substr(0, 10);
  data.head.push_back(first.empty()
                          ? "The dates of the attempts are not known."
                          : fmt::format("Attempts from {} to {}. Cohort {}{}.", first, last, data.where,
                                        options.cohort ? ", participants of \"" + options.cohort->name + "\"" : ""));
  addFigures(data, values, placed, options, choices, name);
  if (choices.design == Design::timeToCriterion) {
    keepTimes(data, values, placed);
    return data;
  }
  std::vector<const AttemptRow*> analysed;
  for (const auto& item : people.units) analysed.insert(analysed.end(), item.second.begin(), item.second.end());
  if (std::string remark = unfinishedRemark(analysed, data.groups, options.grouping, ""); !remark.empty())
    data.remarks.push_back(std::move(remark));
  return data;
}

}  // namespace

DesignData cohortDesignData(const std::vector<AttemptRow>& attempts, const std::vector<AttemptValue>& values,
                            const StudyOptions& options, const DesignChoices& choices, const std::string& name) {
  PlacedAttempts placed;
  DesignData data = populated(attempts, values, options, choices, name, placed);
  keepNamedFigures(data, choices);
  return data;
}

DesignData cohortDesignData(const CohortDatabase& database, const StudyOptions& asked, const DesignChoices& choices) {
  refuseWhileMasked(database.path(), "");
  StudyOptions options = withCohortData(database, asked);
  options.family = choices.family;
  PlacedAttempts placed;
  DesignData data = populated(database.listAttempts(), database.allValues(unaskedPhases(options)), options, choices,
                              database.path(), placed);
  if (choices.design != Design::timeToCriterion) {
    const std::vector<Rating> ratings = database.ratings();
    for (const StoredDocument& stored : database.forms()) {
      const RatingForm form = parseRatingForm(std::as_bytes(std::span(stored.text)), stored.name);
      if (form.ofAttempts) addForm(data, form, ratings, placed, choices);
    }
  }
  keepNamedFigures(data, choices);
  return data;
}

}  // namespace calot::analytics
