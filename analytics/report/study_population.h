// SPDX-License-Identifier: GPL-3.0-or-later
// Population of a study: included attempts, reasons for exclusion, the two groups compared, and where and
// when the attempts were made.
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <set>
#include <span>
#include <string>
#include <vector>

#include "analytics/report/study.h"

namespace calot::analytics {

/// Group of an attempt: the participant's study group or the performer's profile; empty: none.
std::string groupOf(const AttemptRow& attempt, Grouping grouping);

/// Unit of analysis: a participant's pseudonym, or "attempt UUID" for one performer's run.
std::string unitOf(const AttemptRow& attempt);

/// The attempt ended before its goal: time limit reached, abandoned, or stopped. A motion file that only ends (its
/// outcome "stopped" is what import takes where none is declared) counts as neither finished nor unfinished.
bool isUnfinished(const AttemptRow& attempt);

/// "2 expert and 3 novice attempts were not finished", with what that means for their values; empty if all were.
/// @param figures that have values of them, a list
std::string unfinishedRemark(std::span<const AttemptRow* const> attempts, std::span<const std::string> groups,
                             Grouping grouping, const std::string& figures);

/// The figure's direction and the group that is expected to do better, as one hypothesis about the values of two
/// groups; none where one of them is not known. The same for every design.
std::optional<Hypothesis> hypothesisOf(Direction direction, const std::string& better,
                                       std::span<const std::string> groups);

/// Attempts that may be analysed, and why the others may not, in the order in which reasons are checked.
struct IncludedAttempts {
  std::vector<const AttemptRow*> taken;
  std::map<std::string, std::uint64_t> present;  ///< number of them by group
  std::vector<FlowRow> flow;
  std::map<std::string, std::set<std::string>> reasons;  ///< why attempts stay out, by unit
};
/// @param strata "site" or "arm", which an attempt must have; or empty
/// @param everybody having no group excludes nobody
IncludedAttempts includedAttempts(const std::vector<AttemptRow>& recruited, const StudyOptions& options,
                                  const std::string& strata = "", bool everybody = false);

/// " of 48 attempts (left out: 8 no group)".
std::string leftOutOf(std::uint64_t recruited, const std::vector<FlowRow>& flow);

/// Site or arm of an attempt.
const std::string& stratumOf(const AttemptRow& attempt, const std::string& strata);

/// How the attempts of one unit of analysis become one value.
struct AttemptReduction {
  std::optional<AttemptRule> rule;  ///< none: several are refused
  bool oneEach = true;              ///< else all attempts stay
  bool byDevice = false;            ///< one of each device
};

/// Attempts of each unit of analysis, by start.
struct AttemptsOfUnits {
  std::map<std::string, std::vector<const AttemptRow*>> units;
  std::string rule;  ///< a clause: "one attempt each"
};
/// Leaves the attempts of `groups` (empty: all) and of these the first of each unit, where the rule says so. Adds to
/// `flow` what goes out.
/// @throws Error (refused) for a participant in two groups, several attempts without a rule, and two that could be the
/// first.
AttemptsOfUnits attemptsOfUnits(const std::vector<const AttemptRow*>& taken, std::span<const std::string> groups,
                                Grouping grouping, const AttemptReduction& reduction, const std::string& name,
                                std::vector<FlowRow>& flow);

/// Adds a remark where attempts of several comparability keys are mixed, as asked.
/// @throws Error (refused) where they would be mixed and nobody asked for it.
void askForOneKey(const std::vector<std::string>& keys, const StudyOptions& options, const std::string& name,
                  std::vector<std::string>& remarks);

/// The same of versions of a checkpoint. @throws Error (refused)
void askForOneVersion(const std::string& checkpoint, std::size_t versions, const StudyOptions& options,
                      const std::string& name, std::vector<std::string>& remarks);

/// A comparability key as a sentence: "Task touch-liver 1, device falcon, ...".
std::string keySentence(const std::string& key);

/// The checkpoint of a phase's duration, which is always reported.
inline constexpr const char* phaseDurationName = "phase-duration";
/// Checkpoints of phases that were not requested.
std::vector<std::string> unaskedPhases(const StudyOptions& options);

/// Pseudonyms in a named cohort. @throws Error (invalid) where the database at `path` has no such cohort.
std::set<std::string> participantsOf(const std::string& path, const std::string& cohort);

/// Names of groups: levels of skill first, best first; others behind them, by name.
bool groupBefore(const std::string& a, const std::string& b);

/// The two groups to compare.
/// @param present units by group; @param left what the error says of those that stay out, or empty
/// @throws Error (invalid) for names that are not two different ones, Error (refused) where there are not two groups.
std::array<std::string, 2> chooseGroups(const std::map<std::string, std::uint64_t>& present,
                                        const StudyChoices& choices, const std::string& path, const std::string& left);

/// The group that is expected to do better, or empty. @throws Error (invalid) where `choices.better` is not one of the
/// two.
std::string betterOf(const std::array<std::string, 2>& groups, const StudyChoices& choices);

/// Adds an analysed attempt's task and start.
void addToSetting(StudySetting& setting, const AttemptRow& attempt);

/// Puts the figures of the paper's Table 2 into the study's first table (StudyRow::leading) and, where the study's one
/// task is the paper's, the published means beside them.
void addPublished(Study& study);

}  // namespace calot::analytics
