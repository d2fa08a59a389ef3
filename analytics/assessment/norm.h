// SPDX-License-Identifier: GPL-3.0-or-later
// Makes a norm: who is in it, who of them is competent, and the pass mark of every figure, by contrasting groups or by
// borderline regression on raters' scores (norm.cpp), or set by people: fixed marks and judges' (Angoff;
// norm_rule.cpp). Stores it, and puts it into words (norm_rule.cpp).
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "analytics/assessment/declared_document.h"
#include "analytics/assessment/rating_form.h"
#include "analytics/cohort/cohort_database.h"
#include "analytics/report/study.h"
#include "analytics/statistics/expected.h"
#include "analytics/statistics/standard_setting.h"
#include "recorder/base/csv.h"

namespace calot::analytics {

/// A pass mark that an instructor sets for what is critical, whatever the members' spread.
struct FixedCut {
  std::string figure;    ///< "clip-errors", or one of several, "path-length left"
  bool atLeast = false;  ///< else at most
  double value = 0.0;    ///< in the unit that tables show
};

/// A figure is named whole, or by its checkpoint's name.
inline bool isCalled(const std::string& wanted, const std::string& checkpoint, const std::string& subject) {
  return wanted == checkpoint || wanted == figureName(checkpoint, subject);
}

/// "critical-view>=1", "clip-errors<=0". @throws Error (invalid)
FixedCut parseFixedCut(const std::string& text);

/// Does a checkpoint count where the rule names none? Few do: how long it took, how far the tips went, and what harms
/// the patient. The others describe; hundreds of them would decide by what competent people happen to differ in.
bool countsByDefault(std::string_view checkpoint);
/// The six of them, harm first. The dashboard shows the same.
const std::vector<std::string_view>& countingCheckpoints();

/// Puts an instructor's marks in the place of those of the members' spread; these figures are in the rule.
/// @throws Error (invalid) where no figure is called so, or its better side is the other one
void setFixedCuts(Norm& norm, const std::vector<FixedCut>& fixed);
/// Was the mark set by a person? Such a figure has to be passed whatever number of others is.
bool isFixed(const NormCheckpoint& mark);

/// True if the rule is met: by enough of its figures, and by each that is fixed.
/// @param passed by Norm::checkpoints
bool keepsRule(const Norm& norm, const std::vector<bool>& passed);

/// Warning that names figures of harm which do not count, since they have no pass mark; or empty.
std::string uncountedWarning(const Norm& norm);

/// Judges' probabilities that a borderline trainee passes each figure, and the pass mark.
struct AngoffJudgement {
  std::vector<std::string> judges, items;
  RatingTable probabilities;  ///< a row a judge
  AngoffCut cut;
  std::size_t needed = 0;  ///< least whole number of items at or above the cut
};

/// Reads a table with a column "judge" and a column for each item.
/// @throws Error (invalid) without such a column; Error (damaged), naming line and column, for a judge without a name
/// or named twice, and a cell that is no probability; Error (refused) where there is no cut.
AngoffJudgement readAngoff(const CsvTable& table);

/// Borderline regression: the form by which raters judged attempts, and its borderline mark.
struct BorderlineMark {
  std::string form;
  double mark = 0.0;  ///< at it one is competent
};

struct NormRequest {
  std::string name, by;
  /// Whose attempts, of which key, synthetic or not, with phases or not: as a study's. Of several attempts of a
  /// participant the first counts where `who.attemptRule` says so; a mean is no attempt and has less spread than one.
  StudyOptions who;
  std::string judgedBy;  ///< form with the one item "competent", 0 or 1, by which raters judge; empty: by group
  std::optional<BorderlineMark> borderline;  ///< instead of groups and judgedBy
  /// In the rule, "path-length" or "path-length left"; "all": all with a cut; empty: countsByDefault() of these.
  std::vector<std::string> checkpoints;
  std::vector<FixedCut> fixed;    ///< in the rule, too, by marks of a person
  std::uint32_t leastPassed = 0;  ///< of them; 0: all
  std::uint64_t seed = 1;         ///< of the bootstrap
  /// Decisions of `by` on single attempts in place of the groups: competent or not; none: not a member.
  std::map<std::string, std::optional<bool>> decided;
};

/// Definition of the figure that a mark is of; null: this program does not know it.
const CheckpointDefinition* definitionOf(const NormCheckpoint& mark);

/// True if a norm may be called so: 1 to 64 letters, digits, points, hyphens and underscores.
bool isNormName(const std::string& name);

/// Name of the form and its item by which raters judge competence.
inline constexpr const char* competenceItem = "competent";

/// Members that each side has at least: the spread of two is no estimate. Below five, reports warn of the intervals.
inline constexpr std::size_t minNormMembers = 3;

/// A norm from attempts at hand. A pass mark is the cut of contrasting groups with a bootstrap interval, or the value
/// at the borderline mark of a regression on the ratings with Student's interval, of times on the log scale where all
/// are positive; figures that judge nothing have none, and critical errors, which are asked first.
/// @param name of where they are from, for errors
/// @throws Error (refused) as makeStudy(), where raters judged nobody or all alike, a side has too few members, a
/// figure of the rule has no cut, the rule wants more than there are, or the protocol takes a mean of attempts; Error
/// (invalid) for an unknown name.
Norm makeNorm(const std::vector<AttemptRow>& attempts, const std::vector<AttemptValue>& values,
              const std::vector<Rating>& ratings, const NormRequest& request, const std::string& name);

/// The first part of makeNorm(): members by the groups or by raters, however few, and the figures that judge with their
/// values; no marks, no rule. @throws Error as makeNorm() where there are no two groups of comparable attempts
Norm gatherNorm(const std::vector<AttemptRow>& attempts, const std::vector<AttemptValue>& values,
                const std::vector<Rating>& ratings, const NormRequest& request, const std::string& name);
/// Applies NormRequest::decided, and says so in Norm::judgedBy. Attempts that are no members are passed over.
void decideMembers(Norm& norm, const NormRequest& request);
/// Every figure's mark by the norm's members; without one, why. @param resamples of the bootstrap, at least 99
void findMarks(Norm& norm, const std::vector<Rating>& ratings, const std::optional<BorderlineMark>& borderline,
               std::size_t resamples);
/// Sets the marks that a person fixed, and which figures count: of those that the request names, or by default, all
/// with a mark. Refuses nothing. @throws Error as setFixedCuts()
void applyRule(Norm& norm, const NormRequest& request);
/// Competent members and others.
std::pair<std::size_t, std::size_t> sidesOf(const Norm& norm);

/// True if a value is on the passing side of a mark; a value at the cut passes. @pre there is a cut.
bool passes(const NormCheckpoint& mark, double value);

/// How many of the norm's own members would pass by its rule: what the rule asks for, and what it lets through.
struct PassRate {
  std::uint64_t passed = 0, members = 0;
};
/// First of the competent, then of the others. A member without a value of a figure has not passed it.
std::pair<PassRate, PassRate> passRates(const Norm& norm);
/// True if a member of the norm passes by its rule.
bool isPassedBy(const Norm& norm, const NormMember& member);

/// Warning where competent members of the norm would fail by its own rule, with their number; or empty.
std::string ownFailureWarning(const Norm& norm);

/// Warning about the pass marks' intervals if their published coverage is low at the norm's size; or empty.
std::string passMarkWarning(const Norm& norm);

/// True if the pass marks come from borderline regression.
bool isByBorderline(const Norm& norm);
/// Its form and mark, where they do.
std::optional<BorderlineMark> borderlineOf(const Norm& norm);

/// How many figures the rule has, and how many of them must be passed: leastPassed, or all of them.
std::size_t figuresInRule(const Norm& norm);
std::size_t neededPasses(const Norm& norm);
/// The rule with the rates at which the norm's own members pass by it.
std::string ruleText(const Norm& norm);

/// Group names of members by their rating.
inline constexpr const char* atMarkGroup = "at the mark or above";
inline constexpr const char* belowMarkGroup = "below the mark";

/// Attempts' ratings with a form: the mean of the items that a rater answered, of several raters the mean of these.
std::map<std::string, double> meanRatings(const std::vector<Rating>& ratings, const std::string& form);

/// The attempts with a group by their rating: at the borderline mark one is competent; of a participant the first that
/// was rated. Others have no group. @throws Error (refused) where no attempt was rated with the form.
std::vector<AttemptRow> groupedByRating(std::vector<AttemptRow> attempts, const std::map<std::string, double>& ratings,
                                        const BorderlineMark& borderline, const std::string& name);

/// Cut with its interval, of times on the log scale.
struct RegressionCut {
  double cut = 0.0, lower = 0.0, upper = 0.0;
};
Expected<RegressionCut> borderlineCut(const std::vector<double>& ratings, const std::vector<double>& values,
                                      double mark, Direction direction, bool logScale);

/// How far it is, from 0 to 1, and what is being done. The last call comes before anything is stored; what it throws
/// ends the making, and nothing is stored.
using NormProgress = std::function<void(double share, const char* doing)>;

/// All that a norm may be made of.
struct NormSource {
  std::vector<AttemptRow> attempts;
  std::vector<AttemptValue> values;
  std::vector<Rating> ratings;
};
/// @param only uuids of the attempts that it may be made of; empty: all
NormSource readNormSource(const CohortDatabase& cohort, const std::vector<std::string>& only = {},
                          const NormProgress& progress = {});

/// Makes a norm of a cohort's attempts, after the whole cohort was checked, and stores it as the next version of its
/// name. A protocol gets the participants' recorded experience.
/// @param only uuids of the attempts that it may be made of; empty: all that the request allows
/// @return as it is stored @throws Error as refuseUnsound(), makeNorm() and CohortDatabase
Norm createNorm(const std::string& database, NormRequest request, const std::vector<std::string>& only = {},
                const NormProgress& progress = {});

/// Members and author, its rule with the pass rates of the rule, and its permitted use: whole
/// sentences.
std::vector<std::string> normSummary(const Norm& norm);

/// Competent members who fail, harm that does not count, intervals that are too narrow: whole sentences, or none.
std::vector<std::string> normWarnings(const Norm& norm);

}  // namespace calot::analytics
