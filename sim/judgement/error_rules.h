// SPDX-License-Identifier: GPL-3.0-or-later
// Errors: which there are, how severe each is, and why. Judgement, figures, norms, sheets and windows stand on this one
// table.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sim/scene/description.h"
#include "sim/scene/step_result.h"

namespace calot {

/// Rises when a rule below changes, comes or goes: counts of errors then have a new version.
inline constexpr std::uint32_t errorRulesVersion = 2;

/// How severe an error is. One critical error makes an attempt unsafe, and it is not passed whatever its other figures.
enum class Severity : std::uint8_t {
  minor = 1,    ///< poor technique without harm
  major = 2,    ///< harm that is repaired, or a risk of leak or bleeding
  critical = 3  ///< injures a structure that must be spared, or leaves one open
};
inline constexpr std::size_t severityCount = 3;

/// Numbers are public and never reused.
enum class ErrorRule : std::uint8_t {
  sparedCut = 1,
  sparedBurned = 2,
  sparedTorn = 3,
  sparedClipped = 4,
  sparedHeated = 5,
  leftOpen = 6,
  notIdentified = 7,
  tooFewClips = 8,
  cutThroughClip = 9,
  burnedThrough = 20,
  torn = 21,
  perforated = 22,
  organTorn = 23,
  openTowardsSpecimen = 24,
  tooFewTowardsSpecimen = 25,
  clipHalfOn = 26,
  clipLost = 27,
  viewIncomplete = 28,
  burnedAndSealed = 40,
  heated = 41,
  clipOnClip = 42,
  clipTooNear = 43,
  tornFromJaws = 44,
  slipped = 45,
  strandsTorn = 46,
  pressedHard = 47,
};

/// Names in the order of subjects.
enum class ErrorSubject : std::uint8_t { none, structure, connective };

struct ErrorRuleText {
  ErrorRule rule;
  Severity severity;
  const char* name;  ///< "left-open": for other programs
  ErrorSubject subject;
  const char* words;   ///< after the subject's name: "left open"
  const char* why;     ///< one sentence
  const char* source;  ///< of the rule; "own": this program's reading
};

/// All rules, the gravest first.
std::span<const ErrorRuleText> errorRules();
const ErrorRuleText& textOf(ErrorRule rule);

/// An event by which a rule was broken.
struct JudgedError {
  ErrorRule rule;
  Event event;
};

/// All that went wrong with one structure at once, and as often as it did again: a line for people.
struct AttemptError {
  std::vector<ErrorRule> rules;  ///< of one cause, the gravest first; never empty
  std::uint16_t subject = 0;     ///< as the first rule's ErrorSubject counts
  std::uint32_t count = 1;       ///< occasions, more than a second apart
  std::uint64_t first = 0;       ///< step of the first one
  std::uint64_t last = 0;        ///< newest step
  std::uint64_t worst = 0;       ///< step with the largest value of the gravest rule's event
  double value = 0.0;            ///< that value

  [[nodiscard]] Severity severity() const { return textOf(rules.front()).severity; }
};

/// The errors of an attempt, the gravest first, then by time.
class ErrorList {
 public:
  /// @param sameOccasion steps within which the same counts once
  explicit ErrorList(std::uint64_t sameOccasion = 100) : sameOccasion_(sameOccasion) {}

  /// The errors of one step. @pre steps come in their order
  void add(std::span<const JudgedError> errors);
  /// An error that was found earlier lasts: its line reaches to this step, its worst one where the value is the largest
  /// so far.
  void goOn(const JudgedError& error);
  /// Takes back a rule that doesn't hold any more (an open end that was closed), whatever else happened with it.
  void takeBack(ErrorRule rule, std::uint16_t subject);

  [[nodiscard]] const std::vector<AttemptError>& all() const { return all_; }
  /// Occasions of a severity.
  [[nodiscard]] std::uint32_t count(Severity severity) const;

 private:
  void sort();

  std::uint64_t sameOccasion_;
  std::vector<AttemptError> all_;
};

/// Errors that the scene, or the version of the results, does not show, each with its reason: "bleeding (nothing bleeds
/// in the simulation)". Where there are any, a count of 0 is not "none".
std::vector<std::string> notAssessed(const SceneDescription& scene, std::uint32_t resultVersion);

}  // namespace calot
