// SPDX-License-Identifier: GPL-3.0-or-later
// Comparison of two groups of a cohort or of an imported table, as data; study_output.h prints it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "analytics/assessment/protocol.h"
#include "analytics/checkpoints/checkpoint.h"
#include "analytics/cohort/cohort_database.h"
#include "analytics/report/ratings.h"
#include "analytics/statistics/descriptive.h"
#include "analytics/statistics/expected.h"
#include "analytics/statistics/rank_tests.h"
#include "analytics/statistics/regression.h"
#include "analytics/statistics/two_groups.h"

namespace calot::analytics {

/// Statistics of a row of a study, in its display unit.
struct SimulationRange {
  std::uint64_t known = 0, values = 0;  ///< attempts' values that have an interval, and all of them
  double halfWidth = 0.0;               ///< median over the intervals
  /// If every value has an interval: least and largest P(first group larger) + P(equal) / 2 over the worlds
  /// (ValueInterval::worlds()), in each of which all attempts have the same step, mesh and constants.
  std::optional<std::pair<double, double>> area;

  /// The same group has the larger values in every world, or A is the same in all.
  [[nodiscard]] bool decided() const {
    return area && (area->first > 0.5 || area->second < 0.5 || area->first == area->second);
  }
};

/// One attempt's value in every world.
struct RangedValue {
  std::size_t participant = 0;
  double halfWidth = 0.0;
  std::vector<double> worlds;  ///< empty: it has no interval
};

/// Means over each participant's attempts are compared. Nothing where no value has an interval, or a group is empty.
std::optional<SimulationRange> simulationRange(const std::array<std::vector<RangedValue>, 2>& groups);

/// Level at which a study without a protocol speaks of a difference.
inline constexpr double usualLevel = 0.05;

enum class Grouping : std::uint8_t { performer, group };

/// User's declarations for a study, made before looking at its figures.
struct StudyChoices {
  std::vector<std::string> groups;  ///< the two to compare, in order; empty: the only two that are there
  std::string better;               ///< the group that is expected to do better; empty: by the groups' names, if these
                                    ///< are levels of skill (expert and skilled, intermediate, novice and unskilled)
  std::optional<AttemptRule> attemptRule;  ///< rule that reduces a participant's several values to one; none: refused
  std::vector<std::string> family;         ///< checkpoints or outcomes that are adjusted for each other; empty: all
  bool unequalSpread = false;              ///< Brunner and Munzel's test in place of Mann and Whitney's
};

/// A protocol and what the database knows of it.
struct ProtocolInUse {
  Protocol protocol;
  std::vector<RegisteredProtocol> registered;  ///< all versions of its name
  /// Participants' recorded experience; makeStudy() of a database fills it in.
  std::map<std::string, std::map<std::string, std::string>> experience;
};

/// Participants whom the database knows under a name (calot cohort name).
struct CohortInUse {
  std::string name;
  std::set<std::string> participants;  ///< pseudonyms; makeStudy() of a database fills them in
};

/// A protocol overrides groups, the better one, attempt rule and family.
struct StudyOptions : StudyChoices {
  std::optional<ProtocolInUse> protocol;
  std::optional<CohortInUse> cohort;  ///< only attempts of its participants
  std::vector<Participant> people;    ///< registered, by pseudonym; makeStudy() of a database fills them in
  Grouping grouping = Grouping::group;
  bool includeSynthetic = false;
  bool includePractice = false;
  bool includeBranches = false;
  /// Checkpoints that are given for each phase of the procedure. They repeat those of the whole attempt four times and
  /// make the family large; without this only the phases' durations and what a protocol or the family names.
  bool includePhases = false;
  std::string key;       ///< only attempts of this comparability key; empty: all, which must then have one
  bool masked = false;   ///< groups have no names: hypotheses have no direction and no verdict
  bool mixKeys = false;  ///< compare across comparability keys and checkpoint versions, and say so
};

/// Role of a row in the protocol: a hypothesis of the family, one outside of it, or none.
enum class Role : std::uint8_t { undeclared, primary, secondary, exploratory };
std::string nameOf(Role role);  ///< "", "primary", "secondary", "exploratory"

/// One registered version of the study's protocol.
struct ProtocolVersion {
  std::uint32_t version = 1;
  std::string sha256, registeredUtc, by;
  std::vector<std::string> changed;  ///< JSON pointers where it differs from the version before
};

/// When the analysis was locked; a masked study names its groups from then on.
struct StudyLock {
  std::string lockedUtc, by;
  std::vector<std::string> changed;  ///< since then: "data", "options", "software (...)"
};

/// A report's information about its protocol.
struct StudyProtocol : Protocol {
  std::string registeredUtc = {};                    ///< empty: never
  std::string firstAttemptUtc = {};                  ///< earliest start among the data; empty: not known
  std::map<std::string, std::uint64_t> starts = {};  ///< attempts by startEvidence()
  std::string whyExploratory = {};                   ///< empty: Calot holds evidence that it came first
  std::vector<ProtocolVersion> versions = {};
  std::vector<std::string> deviations = {};  ///< whole sentences
  bool masked = false;                       ///< the groups have drawn names, hypotheses no directions
  std::optional<StudyLock> lock = {};        ///< none: not locked
  std::uint64_t runsBeforeLock = 0;          ///< with named groups, as the audit notes them
};

/// A reason for exclusion of attempts (or a table's rows), in the order in which reasons are checked.
struct FlowRow {
  std::string reason;
  std::uint64_t attempts = 0;
  std::map<std::string, std::uint64_t> people = {};  ///< by group: those of whom nothing is analysed, for this reason
};

/// An analysed participant.
struct StudyPerson {
  std::size_t group = 0;
  std::uint64_t attempts = 0;
  std::map<std::string, std::string> traits = {};  ///< experience by criterion; "handedness", "site", "arm", "device"
};

/// One group's values of one checkpoint, one per participant, in the checkpoint's display unit.
struct GroupSummary : Summary {
  std::uint64_t missing = 0;                                 ///< participants without any value
  std::string missingReason;                                 ///< the commonest
  std::array<std::uint64_t, availabilityCount> missingOf{};  ///< the same participants by Availability
  std::uint64_t partial = 0;                                 ///< participants whose mean lacks some of their attempts
};

/// The outcome adjusted for its baseline, for those who have both.
struct BaselineAdjustment {
  std::array<std::uint64_t, 2> n{};
  std::array<std::uint64_t, 2> withoutBaseline{};  ///< have the outcome and not the baseline
  Expected<CovarianceAnalysis> analysis = NoResult{"not computed"};
  std::optional<double> holm;  ///< p adjusted over the analyses of the family
};

struct StudyRow {
  std::string checkpoint;  ///< name; of a table: the column
  std::string subject;
  std::string title;
  std::string unit;        ///< display unit
  std::string source;      ///< of an external metric: SHA-256 of its script; empty: the program's own, or a column
  std::string notOutcome;  ///< why it is shown apart, without a test; empty: an outcome
  bool leading = false;    ///< in the first table: a primary hypothesis, a figure of the paper's Table 2, or named
  Direction direction = Direction::none;
  std::vector<std::uint32_t> versions;  ///< of the values in it, ascending
  std::vector<std::string> origins;
  std::array<GroupSummary, 2> group;
  std::array<std::vector<std::string>, 2> participants;  ///< whose, ascending; "attempt UUID" for a performer's run
  std::array<std::vector<double>, 2> values;             ///< as many, in the display unit
  Expected<MannWhitney> test = NoResult{"not computed"};
  /// Computed where the smaller group scatters more; where StudyChoices::unequalSpread asks for it its p is in `test`.
  Expected<BrunnerMunzel> brunnerMunzel = NoResult{"not computed"};
  std::optional<double> holm;               ///< p adjusted over the family; none outside of it or without a test
  Role role = Role::undeclared;             ///< by the protocol, where there is one
  std::optional<double> benjaminiHochberg;  ///< of a secondary hypothesis: p adjusted over these
  /// Participants without a value, since they did not finish, who rank behind all in test and A.
  std::array<std::vector<std::string>, 2> worstRanked;
  double worst = 0.0;                         ///< a value behind all others, for their ranks
  std::array<std::uint64_t, 2> unfinished{};  ///< participants whose value is of an attempt that was not finished
  /// Smallest adjusted p that these values could give, whatever their assignment to the groups: all tests of the family
  /// at their MannWhitney::smallestP. Above the level, nothing could be found.
  std::optional<double> attainableP;
  /// A hypothesis of the protocol: adjusted p at most the level, as expected; none without a test or where no adjusted
  /// p can reach the level.
  std::optional<bool> supported;
  Claim claim = Claim::difference;                      ///< of its hypothesis
  std::optional<double> margin;                         ///< of that claim
  Expected<double> marginP = NoResult{"not computed"};  ///< p of equivalence or non-inferiority, which Holm adjusts
  std::optional<Hypothesis> hypothesis;  ///< from the direction and the group that is expected to do better
  std::optional<bool> asHypothesised;    ///< A of the hypothesis above one half; none at one half, or without one
  Expected<Superiority> effect = NoResult{"not computed"};  ///< of the first group's values being larger
  /// The same with its interval, in the direction of the hypothesis where there is one.
  Expected<SuperiorityEstimate> area = NoResult{"not computed"};
  Expected<double> shift = NoResult{"not computed"};
  Expected<ShiftInterval> shiftInterval = NoResult{"not computed"};
  Expected<HedgesG> hedges = NoResult{"not computed"};
  /// Over the participants of both groups; with `attempt-duration`, by the same rule.
  Expected<Spearman> withDuration = NoResult{"not computed"};
  std::uint64_t withDurationPairs = 0;                     ///< participants in it
  std::optional<BaselineAdjustment> adjusted;              ///< of a table with a baseline
  std::vector<std::string> coverageWarnings;               ///< intervals whose published coverage is low at these sizes
  std::optional<double> publishedExpert, publishedNovice;  ///< the paper's means, where the task is the paper's
  std::optional<SimulationRange> simulation;               ///< where values have intervals
  bool sampled = false;                                    ///< of samples: Study::coverage has its subject
};

/// The smallest adjusted p that the row's groups can give is above the level.
inline bool isOutOfReach(const StudyRow& row, double level) { return row.attainableP && *row.attainableP > level; }

/// Rate (Hz) or noise (m) of the trackers: one value per participant, the mean of several attempts.
struct TrackerQuality {
  std::array<std::vector<double>, 2> values;
  Expected<MannWhitney> test = NoResult{"not computed"};
};

/// Coverage of the attempts by samples, rate and noise of their trackers, for figures of one subject.
struct CoverageRow {
  std::string subject;                       ///< as of the figures: a hand, "" both, "left clipping"
  std::array<std::vector<double>, 2> share;  ///< in [0, 1], one per participant, the mean of several attempts
  std::array<std::uint64_t, 2> below{};      ///< participants with a figure that was refused for it
  Expected<MannWhitney> test = NoResult{"not computed"};
  TrackerQuality rate, noise;
  std::string refusal = {};  ///< why its figures are not tested: the groups' trackers are not alike; empty: they are
};

/// Sites and dates of a study's attempts.
struct StudySetting {
  std::vector<std::string> tasks;           ///< scenes, or what was done in imported motion; ascending
  std::string firstStartUtc, lastStartUtc;  ///< of those analysed; empty: not known
};

/// A participant without a row at an occasion where others have one.
struct AbsentRow {
  std::string participant, group, occasion;
};

/// Data of a study of any design.
struct AnalysedData {
  std::string source;           ///< "cohort" or "table"
  std::string counted;          ///< what the flow counts: "attempts" or "rows"
  std::string where;            ///< the file's name without its folder
  bool synthetic = false;       ///< contains what performers made: watermarked everywhere
  std::string better;           ///< the group that is expected to do better, or empty: no hypothesis
  std::string attemptRule;      ///< how a participant's attempts were reduced to one value, a clause
  std::uint64_t recruited = 0;  ///< attempts in the database, rows in the table
  std::vector<FlowRow> flow;
  std::uint64_t analysed = 0;                                            ///< attempts
  std::map<std::string, std::uint64_t> recruitedPeople, analysedPeople;  ///< by group
  std::vector<std::string> remarks;                                      ///< what a reader must know, whole sentences
};

struct Study : AnalysedData {
  std::string heading;  ///< "confirmatory": evidence shows that the protocol came first; else "exploratory"
  std::optional<StudyProtocol> protocol;
  StudySetting setting;  ///< of a cohort
  std::string cohort;    ///< the named cohort whose attempts alone were taken, or empty: all
  std::array<std::string, 2> groups;
  std::array<std::uint64_t, 2> participants{}, attempts{};
  std::map<std::string, StudyPerson> people;  ///< by unit of analysis; none in a masked study
  std::vector<std::string> keys;              ///< comparability keys of the attempts in it
  std::vector<AbsentRow> absent;              ///< of a table with occasions, by participant
  bool phasesLeftOut = false;                 ///< checkpoints of single phases, other than how long the phases lasted
  std::string family;                         ///< which p values are adjusted for each other, a sentence
  bool unequalSpread = false;                 ///< as declared (StudyChoices)
  std::vector<StudyRow> rows;
  std::vector<CoverageRow> coverage;  ///< of figures of samples, by subject
  std::string publishedSource;        ///< of the paper's means
  /// In a cohort: group of every analysed participant and attempt (uuid).
  std::map<std::string, std::string> groupOf;
  std::map<std::string, AttemptOf> attemptOf;  ///< of a cohort: of every analysed attempt, by uuid
  std::vector<FormReport> ratings;             ///< addRatings()
};

/// How far a study is: the share that is done, from 0 to 1, and what is being done ("reading values"). Called often, on
/// the thread that makes the study; what it throws ends the study.
using StudyProgress = std::function<void(double share, const char* doing)>;

/// Two groups side by side, one value per participant. A participant with several attempts needs
/// `StudyChoices::attemptRule`; a performer's attempt without participant counts as one synthetic participant.
/// Practice, branches, goldens, excluded attempts, unfinished recordings, technical failures and recordings that did
/// not verify stay out, counted in the flow.
/// @throws Error (refused) when there are not two groups, a participant has several attempts and there is no rule, or
/// comparability keys or checkpoint versions would mix; Error (invalid) for an unknown name, of a cohort too.
Study makeStudy(const CohortDatabase& database, const StudyOptions& options, const StudyProgress& progress = {});

/// Additions of makeStudy() of a database to the options: participants, those of the named cohort, their experience.
/// @throws Error (invalid) where there is no such cohort
StudyOptions withCohortData(const CohortDatabase& database, StudyOptions options);

/// The same of attempts and values at hand: CohortDatabase::listAttempts() and allValues(). @param name of where they
/// are from, for errors
Study makeStudy(const std::vector<AttemptRow>& attempts, const std::vector<AttemptValue>& values,
                const StudyOptions& options, const std::string& name, const StudyProgress& progress = {});

/// Adds results of forms completed by or about the analysed participants.
void addRatings(Study& study, const CohortDatabase& database);

}  // namespace calot::analytics
