// SPDX-License-Identifier: GPL-3.0-or-later
// A study's protocol: what is declared before the first attempt (schemas/protocol.schema.json,
// docs/how-to/protocol.md).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analytics/assessment/declared_document.h"
#include "analytics/statistics/descriptive.h"
#include "recorder/engine/observer.h"

namespace calot::analytics {

/// A recorded criterion of experience that a member of a population meets: a number within bounds, or a word.
struct PopulationCriterion {
  std::string criterion;  ///< as in `participant --experience CRITERION=VALUE`
  std::optional<double> atLeast, atMost;
  std::string equals;  ///< or empty

  static std::vector<Field> fields();
};

struct Population {
  std::string group;       ///< study group, or the performers' profile
  std::string definition;  ///< in words
  std::vector<PopulationCriterion> criteria;
  std::uint32_t planned = 0;  ///< participants; 0: not declared

  static std::vector<Field> fields();
};

/// The claim of a hypothesis on the shift between the groups.
enum class Claim : std::uint8_t {
  difference,     ///< one group's values are the larger ones
  equivalence,    ///< the shift lies within the margin on both sides
  nonInferiority  ///< the one group's values are larger by less than the margin
};

std::string nameOf(Claim claim);

/// "Novices take longer": which group's values of one figure are expected to be the larger ones.
struct DirectedHypothesis {
  std::string checkpoint, subject;  ///< of an outcome or external metric: its name, and nothing
  bool external = false;            ///< a metric of a user's own script
  std::string sha256;               ///< of that script, or empty: any
  std::string larger;               ///< one of both groups
  Claim claim = Claim::difference;
  std::optional<double> margin;  ///< in the figure's display unit; of a claim that has one
  bool primary = false;          ///< in the family that Holm's adjustment holds

  static std::vector<Field> fields();
};

enum class MissingRule : std::uint8_t {
  completeCases,  ///< who has no value is left out of that figure, and counted
  worstRank       ///< who has none because the attempt was not completed ranks behind all others, tied
};

struct Protocol : DeclaredDocument {
  std::string question, ethics, registry, sampleSizeReason, stoppingRule;
  std::vector<std::string> covariates;
  bool performers = false;  ///< compares performers' profiles, to prove the pipeline; else people
  std::array<Population, 2> populations;
  std::string better;                      ///< the group that is expected to do better
  std::optional<AttemptRule> attemptRule;  ///< none: one attempt each, several are refused
  std::string scene;                       ///< "cholecystectomy/2", or empty: any
  std::vector<recorder::Outcome> excludedOutcomes;
  std::vector<std::string> exclusionReasons;  ///< for which an attempt may be excluded by hand
  MissingRule missing = MissingRule::completeCases;
  bool unequalSpread = false;  ///< the test is Brunner and Munzel's
  double level = 0.05;
  std::vector<DirectedHypothesis> hypotheses;

  static std::vector<Field> fields();
};

/// @throws Error (damaged) naming file and place.
Protocol readProtocol(const std::filesystem::path& file);
Protocol parseProtocol(std::span<const std::byte> bytes, const std::string& file);

/// Reason why a participant with this experience is outside the population: "laparoscopies 12, at least 100 wanted",
/// "laparoscopies not recorded"; empty where all criteria are met.
std::string whyOutside(const Population& population, const std::map<std::string, std::string>& experience);

/// JSON pointers at which two versions of a protocol differ, in the order of the texts; "layout only" where none does.
/// @pre both texts were parsed by parseProtocol().
std::vector<std::string> changedPlaces(const std::string& before, const std::string& after);

}  // namespace calot::analytics
