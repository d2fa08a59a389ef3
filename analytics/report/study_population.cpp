// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/report/study_population.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <algorithm>
#include <nlohmann/json.hpp>
#include <vector>

#include "analytics/checkpoints/checkpoint.h"
#include "analytics/cohort/embedded.h"
#include "analytics/cohort/registers.h"
#include "analytics/report/study_protocol.h"
#include "recorder/base/counted.h"
#include "recorder/base/errors.h"
#include "recorder/base/text_words.h"

namespace calot::analytics {
namespace {

/// Positions of a study's own rules; between them lie those of the view attempt_left_out.
enum : std::int64_t { ofCohort = 0, ofGroup = 100, ofKey = 101, ofProtocol = 102 };

}  // namespace

std::string groupOf(const AttemptRow& a, Grouping grouping) {
  if (grouping == Grouping::group) return a.group;
  return a.operatorKind == recorder::OperatorKind::performer ? a.profile : "";
}

namespace {

/// Rules that the study's options lift. Groups may be profiles, or of raters' making: groupOf() knows them.
bool isWaived(const std::string& rule, const StudyOptions& o) {
  return rule == "group" || (rule == "synthetic" && o.includeSynthetic) || (rule == "practice" && o.includePractice) ||
         (rule == "branch" && o.includeBranches);
}

/// Position and words of the first reason that excludes an attempt; no words: it is taken. Details that differ between
/// attempts follow a colon.
std::pair<std::int64_t, std::string> whyOut(const AttemptRow& a, const StudyOptions& options, bool everybody) {
  if (options.cohort && options.cohort->participants.count(a.participant) == 0)
    return {ofCohort, "not in the named cohort: " + options.cohort->name};
  for (const LeftOut& out : a.leftOut) {
    if (!isWaived(out.rule, options)) return {out.position, out.reason};
  }
  const std::string group = groupOf(a, options.grouping);
  if (group.empty() && !everybody) return {ofGroup, "no group"};
  if (options.protocol) {
    const std::vector<std::string>& reasons = protocolReasons();
    if (const std::string why = whyOutByProtocol(a, group, *options.protocol); !why.empty())
      return {ofProtocol + (std::find_if(reasons.begin(), reasons.end(),
                                         [&](const std::string& reason) { return why.rfind(reason, 0) == 0; }) -
                            reasons.begin()),
              why};
  }
  if (!options.key.empty() && a.comparabilityKey != options.key) return {ofKey, "not comparable (another key)"};
  return {};
}

}  // namespace

std::string unitOf(const AttemptRow& a) { return a.participant.empty() ? "attempt " + a.uuid : a.participant; }

bool isUnfinished(const AttemptRow& a) {
  using recorder::Outcome;
  if (a.outcome == Outcome::stopped) return a.operatorKind != recorder::OperatorKind::kinematics;
  return a.outcome == Outcome::timeLimit || a.outcome == Outcome::abandoned;
}

std::string unfinishedRemark(std::span<const AttemptRow* const> attempts, std::span<const std::string> groups,
                             Grouping grouping, const std::string& figures) {
  std::string counts;
  const auto all =
      std::count_if(attempts.begin(), attempts.end(), [](const AttemptRow* a) { return isUnfinished(*a); });
  for (const std::string& group : groups) {
    const auto isOne = [&](const AttemptRow* a) { return isUnfinished(*a) && groupOf(*a, grouping) == group; };
    counts += fmt::format("{}{} {}", counts.empty() ? " (" : ", ",
                          std::count_if(attempts.begin(), attempts.end(), isOne), group);
  }
  if (all == 0) return {};
  return fmt::format(
      "Warning: {} of {} attempts were not finished{}. Their values are of a part of the task, and a short attempt "
      "looks good{}.",
      all, attempts.size(), counts.empty() ? counts : counts + ")", figures.empty() ? figures : ": " + figures);
}

std::optional<Hypothesis> hypothesisOf(Direction direction, const std::string& better,
                                       std::span<const std::string> groups) {
  if (direction == Direction::none || better.empty() || groups.size() != 2) return std::nullopt;
  return (better == groups[0]) == (direction == Direction::higher) ? Hypothesis::firstLarger : Hypothesis::firstSmaller;
}

const std::string& stratumOf(const AttemptRow& a, const std::string& strata) {
  return strata == "arm" ? a.arm : a.site;
}

IncludedAttempts includedAttempts(const std::vector<AttemptRow>& recruited, const StudyOptions& options,
                                  const std::string& strata, bool everybody) {
  IncludedAttempts included;
  std::map<std::pair<std::int64_t, std::string>, std::uint64_t> out;
  std::uint64_t withoutStratum = 0;
  for (const AttemptRow& a : recruited) {
    if (const auto reason = whyOut(a, options, everybody); !reason.second.empty()) {
      ++out[reason];
      included.reasons[unitOf(a)].insert(reason.second);
    } else if (!strata.empty() && stratumOf(a, strata).empty()) {
      ++withoutStratum;
      included.reasons[unitOf(a)].insert("no " + strata);
    } else {
      ++included.present[groupOf(a, options.grouping)];
      included.taken.push_back(&a);
    }
  }
  for (const auto& [reason, count] : out) included.flow.push_back({reason.second, count});
  if (withoutStratum > 0) included.flow.push_back({"no " + strata, withoutStratum});
  return included;
}

std::string leftOutOf(std::uint64_t recruited, const std::vector<FlowRow>& flow) {
  std::string left;
  for (const FlowRow& row : flow) left += fmt::format("{}{} {}", left.empty() ? "" : ", ", row.attempts, row.reason);
  return fmt::format(" of {} attempts{}", recruited, left.empty() ? "" : " (left out: " + left + ")");
}

AttemptsOfUnits attemptsOfUnits(const std::vector<const AttemptRow*>& taken, std::span<const std::string> groups,
                                Grouping grouping, const AttemptReduction& reduction, const std::string& name,
                                std::vector<FlowRow>& flow) {
  AttemptsOfUnits result;
  std::uint64_t elsewhere = 0, later = 0;
  for (const AttemptRow* a : taken) {
    if (groups.empty() || std::find(groups.begin(), groups.end(), groupOf(*a, grouping)) != groups.end()) {
      result.units[unitOf(*a)].push_back(a);
    } else {
      ++elsewhere;
    }
  }
  std::size_t several = 0;
  std::string whose;
  for (auto& [unit, list] : result.units) {
    std::stable_sort(list.begin(), list.end(),
                     [](const AttemptRow* a, const AttemptRow* b) { return a->startUtc < b->startUtc; });
    std::map<std::string, const AttemptRow*> firstOf;  // by device
    std::vector<const AttemptRow*> kept;
    for (const AttemptRow* a : list) {
      if (!groups.empty() && groupOf(*a, grouping) != groupOf(*list[0], grouping))
        throw Error(ErrorKind::refused, Where{name},
                    fmt::format("participant \"{}\" is in {} groups, which must be independent", unit,
                                groups.size() == 2 ? "both" : "two"));
      if (!reduction.oneEach) continue;
      const auto [first, added] = firstOf.try_emplace(reduction.byDevice ? a->device : "", a);
      if (added) {
        kept.push_back(a);
      } else if (reduction.rule == AttemptRule::first && a->startUtc == first->second->startUtc) {
        throw Error(
            ErrorKind::refused, Where{name},
            fmt::format("two attempts of participant \"{}\" start at {}: neither is the first", unit, a->startUtc),
            {Remedy::takeMean, Remedy::exclude});
      }
    }
    if (!reduction.oneEach || kept.size() == list.size()) continue;
    if (several++ == 0) whose = fmt::format("\"{}\" has {}", unit, list.size());
    if (reduction.rule != AttemptRule::first) continue;
    later += list.size() - kept.size();
    list = std::move(kept);
  }
  if (several > 0 && !reduction.rule) {
    throw Error(
        ErrorKind::refused, Where{name},
        fmt::format("participant {} attempts{} ({} with several), which are not independent", whose,
                    reduction.byDevice ? ", of a device more than one" : "", recorder::counted(several, "participant")),
        {Remedy::chooseAttemptRule});
  }
  result.rule = !reduction.oneEach                     ? "all attempts of each"
                : several == 0                         ? "one attempt each"
                : reduction.rule == AttemptRule::first ? "the first of a participant's attempts"
                                                       : "the mean of a participant's attempts";
  if (elsewhere > 0) flow.push_back({"another group", elsewhere});
  if (later > 0) flow.push_back({"later attempt of a participant (the first counts)", later});
  return result;
}

void askForOneKey(const std::vector<std::string>& keys, const StudyOptions& options, const std::string& name,
                  std::vector<std::string>& remarks) {
  if (keys.size() < 2) return;
  if (!options.mixKeys) {
    throw Error(ErrorKind::refused, Where{name},
                fmt::format("the attempts don't compare, they have {} comparability keys ({})", keys.size(),
                            fmt::join(keys, "; ")),
                {Remedy::chooseKey, Remedy::mixKeys});
  }
  remarks.push_back(
      fmt::format("Attempts of {} comparability keys are mixed, as asked: differences between groups may be "
                  "differences of scene, device or version.",
                  keys.size()));
}

void askForOneVersion(const std::string& checkpoint, std::size_t versions, const StudyOptions& options,
                      const std::string& name, std::vector<std::string>& remarks) {
  if (versions < 2) return;
  if (!options.mixKeys) {
    throw Error(ErrorKind::refused, Where{name},
                fmt::format("checkpoint {} has values of {} versions", checkpoint, versions),
                {Remedy::assessAgain, Remedy::mixKeys});
  }
  remarks.push_back(fmt::format("Values of {} versions of {} are mixed, as asked.", versions, checkpoint));
}

std::string keySentence(const std::string& key) {
  std::string words = comparabilityWords(key);
  if (!words.empty() && words[0] == 't') words[0] = 'T';
  return words + ".";
}

std::vector<std::string> unaskedPhases(const StudyOptions& options) {
  std::vector<std::string> unasked;
  if (options.includePhases) return unasked;
  std::set<std::string> asked(options.family.begin(), options.family.end());
  if (options.protocol) {
    for (const DirectedHypothesis& h : options.protocol->protocol.hypotheses) asked.insert(h.checkpoint);
  }
  for (const std::string& name : phaseCheckpoints()) {
    if (asked.count(name) == 0 && name != phaseDurationName) unasked.push_back(name);
  }
  return unasked;
}

std::set<std::string> participantsOf(const std::string& path, const std::string& cohort) {
  std::string list;
  for (const NamedCohort& c : readRegisters(path).cohorts) {
    if (c.name == cohort) return {c.participants.begin(), c.participants.end()};
    list += (list.empty() ? "" : ", ") + c.name;
  }
  throw Error(
      ErrorKind::invalid, Where{path},
      fmt::format("there is no cohort \"{}\" (there are: {})", recorder::shown(cohort), list.empty() ? "none" : list),
      {Remedy::nameCohort});
}

namespace {

constexpr std::size_t notALevel = 3;

/// 0: expert, skilled; 1: intermediate; 2: novice, unskilled.
std::size_t levelOf(const std::string& group) {
  if (group == "expert" || group == "skilled") return 0;
  if (group == "intermediate") return 1;
  return group == "novice" || group == "unskilled" ? 2 : notALevel;
}

}  // namespace

bool groupBefore(const std::string& a, const std::string& b) {
  const auto rank = [](const std::string& s) {
    static const std::vector<std::string> known{"expert", "skilled", "intermediate", "novice", "unskilled"};
    return std::find(known.begin(), known.end(), s) - known.begin();
  };
  return rank(a) != rank(b) ? rank(a) < rank(b) : a < b;
}

std::array<std::string, 2> chooseGroups(const std::map<std::string, std::uint64_t>& present,
                                        const StudyChoices& choices, const std::string& path, const std::string& left) {
  std::vector<std::string> names;
  names.reserve(present.size());
  for (const auto& item : present) names.push_back(item.first);
  std::sort(names.begin(), names.end(), groupBefore);
  if (!choices.groups.empty()) {
    if (choices.groups.size() != 2 || choices.groups[0] == choices.groups[1]) {
      throw Error(ErrorKind::invalid, "study: two groups with different names are expected", {Remedy::nameGroups});
    }
    for (const std::string& name : choices.groups) {
      if (present.count(name) == 0) {
        throw Error(ErrorKind::refused, Where{path},
                    fmt::format("no attempt for the study in group \"{}\" (there are: {}){}", name,
                                names.empty() ? "none" : fmt::format("{}", fmt::join(names, ", ")), left));
      }
    }
    return {choices.groups[0], choices.groups[1]};
  }
  if (names.size() == 2) return {names[0], names[1]};
  if (names.size() > 2) {
    throw Error(ErrorKind::refused, Where{path}, fmt::format("{} groups ({})", names.size(), fmt::join(names, ", ")),
                {Remedy::nameGroups});
  }
  throw Error(ErrorKind::refused, Where{path},
              fmt::format("a study needs two groups, but {}{}",
                          names.empty() ? "none is left" : "only " + names[0] + " is there", left));
}

std::string betterOf(const std::array<std::string, 2>& groups, const StudyChoices& choices) {
  if (!choices.better.empty()) {
    if (choices.better != groups[0] && choices.better != groups[1]) {
      throw Error(ErrorKind::invalid,
                  fmt::format("study: the better group is to be \"{}\", but the groups are {} and {}", choices.better,
                              groups[0], groups[1]),
                  {Remedy::nameBetterGroup});
    }
    return choices.better;
  }
  const std::size_t a = levelOf(groups[0]), b = levelOf(groups[1]);
  if (a == notALevel || b == notALevel || a == b) return {};
  return a < b ? groups[0] : groups[1];
}

void addToSetting(StudySetting& setting, const AttemptRow& attempt) {
  const auto at = std::lower_bound(setting.tasks.begin(), setting.tasks.end(), attempt.scene);
  if (at == setting.tasks.end() || *at != attempt.scene) setting.tasks.insert(at, attempt.scene);
  const std::string& start = attempt.startUtc;
  if (start.empty()) return;
  if (setting.firstStartUtc.empty() || start < setting.firstStartUtc) setting.firstStartUtc = start;
  if (start > setting.lastStartUtc) setting.lastStartUtc = start;
}

void addPublished(Study& study) {
  const nlohmann::json table = nlohmann::json::parse(publishedTable2());
  const bool sameTask = study.setting.tasks == std::vector{table.at("task").get<std::string>()};
  if (sameTask) study.publishedSource = table.at("source").get<std::string>();
  for (const auto& published : table.at("rows")) {
    for (StudyRow& row : study.rows) {
      if (row.checkpoint != published.at("matches").get<std::string>() ||
          row.subject != published.at("subject").get<std::string>())
        continue;
      row.leading = true;
      if (!sameTask || row.unit != published.at("unit").get<std::string>()) continue;
      row.publishedExpert = published.at("expert").get<double>();
      row.publishedNovice = published.at("novice").get<double>();
    }
  }
}

}  // namespace calot::analytics
