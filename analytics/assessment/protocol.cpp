// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/assessment/protocol.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "analytics/checkpoints/checkpoint.h"
#include "recorder/base/errors.h"
#include "recorder/base/files.h"
#include "recorder/base/record_json.h"
#include "recorder/base/text_words.h"

namespace calot::analytics {
namespace {

using recorder::JsonPlace;
using recorder::Outcome;

constexpr double maxBound = 1e9;

std::vector<Field> exclusionsFields() {
  using S = Protocol;
  const auto number = [](Outcome outcome) { return static_cast<std::uint32_t>(outcome); };
  return {
      object("exclusions", "Attempts that stay out"),
      Field("outcomes", at<S, &S::excludedOutcomes>,
            FieldWords{{"time limit", number(Outcome::timeLimit)},
                       {"abandoned", number(Outcome::abandoned)},
                       {"stopped", number(Outcome::stopped)},
                       {"technical failure", number(Outcome::technicalFailure)}},
            "Outcomes of attempts that stay out; technical failures always do")
          .items(0, 5),
      Field("reasons", at<S, &S::exclusionReasons>, anyText,
            "Reasons for which an attempt may be excluded by hand; another reason is reported as a deviation")
          .items(0, 50),
  };
}

}  // namespace

std::string nameOf(Claim claim) { return nameIn({"difference", "equivalence", "non-inferiority"}, claim); }

std::vector<Field> PopulationCriterion::fields() {
  using S = PopulationCriterion;
  return {
      object("criterion", "Either equals, or one or both bounds"),
      {"criterion", at<S, &S::criterion>, anyName, "Criterion, as it is recorded for participants"},
      optional("atLeast", at<S, &S::atLeast>, "", within(-maxBound, maxBound), "Smallest value"),
      optional("atMost", at<S, &S::atMost>, "", within(-maxBound, maxBound), "Largest value"),
      optional("equals", at<S, &S::equals>, anyName, "Word"),
  };
}

std::vector<Field> Population::fields() {
  using S = Population;
  return {
      object("population", "Group of participants"),
      {"group", at<S, &S::group>, anyName, "Study group of the participants; of performers their profile"},
      {"definition", at<S, &S::definition>, anyText, "Members, in words"},
      optional("criteria", at<S, &S::criteria>,
               "Recorded experience that every member has; attempts of others stay out")
          .items(0, 20),
      optional("planned", at<S, &S::planned>, "", within(1, 1000000), "Participants that are planned"),
  };
}

std::vector<Field> DirectedHypothesis::fields() {
  using S = DirectedHypothesis;
  static constexpr TextRule sha256{64, "^[0-9a-f]{64}$", "64 hexadecimal digits in small letters are expected"};
  return {
      object("hypothesis", "Hypothesis on one of a checkpoint, an external metric and an outcome"),
      optional("checkpoint", at<S, &S::checkpoint>, anyName, "Name, as calot checkpoints lists it"),
      optional("external", at<S, &S::checkpoint>, anyName, "In place of a checkpoint: NAME of a metric of one's own"),
      optional("sha256", at<S, &S::sha256>, sha256,
               "Hash of an external metric's script, as calot assess reports it; values of another script are then not "
               "the hypothesis's"),
      optional("outcome", at<S, &S::checkpoint>, anyName,
               "In place of a checkpoint: a column of a table from elsewhere"),
      optional("subject", at<S, &S::subject>, anyName, "Hand (left, right), organ or phase, of checkpoints with one"),
      {"larger", at<S, &S::larger>, anyName, "The group whose values are expected to be the larger ones"},
      optional(
          "claim", at<S, &S::claim>, FieldWords{{"difference", 0}, {"equivalence", 1}, {"non-inferiority", 2}},
          "equivalence: the groups differ by less than the margin; non-inferiority: the values of larger exceed the "
          "others by less than the margin"),
      optional("margin", at<S, &S::margin>, "", above(0, maxBound),
               "Of equivalence and non-inferiority: the margin, in the unit in which the figure is shown"),
      {"primary", at<S, &S::primary>, "In the family of Holm's adjustment; else secondary"},
  };
}

std::vector<Field> Protocol::fields() {
  using S = Protocol;
  const auto number = [](auto value) { return static_cast<std::uint32_t>(value); };
  return {
      object("", "Declarations of a study of two groups before its first attempt"),
      fileFormat("calot-protocol"),
      fileFormatVersion(),
      {"name", at<S, &S::name>, plainName,
       "Name under which versions of this protocol are kept together: letters, digits, points, hyphens, underscores"},
      {"version", at<S, &S::version>, "", within(1, 1000000),
       "Version of this protocol; a changed protocol has a higher one"},
      {"title", at<S, &S::title>, anyText, "One line"},
      optional("question", at<S, &S::question>, anyText, "Question of the study"),
      optional("ethics", at<S, &S::ethics>, anyText, "Committee and number of its approval"),
      optional("registry", at<S, &S::registry>, anyText, "Public registry and the study's number there"),
      optional("sampleSizeReason", at<S, &S::sampleSizeReason>, anyText,
               "Reason for the planned numbers of participants, as a power analysis"),
      optional("stoppingRule", at<S, &S::stoppingRule>, anyText, "When recruitment ends"),
      optional("covariates", at<S, &S::covariates>, anyText,
               "Variables that may explain a difference; the comparison is not adjusted for them")
          .items(0, 20),
      optional("operators", at<S, &S::performers>, FieldWords{{"people", 0}, {"performers", 1}},
               "Operators that are compared; performers prove the pipeline and nothing about people"),
      Field("populations", at<S, &S::populations>, "The two groups, in the order of the tables").items(2, 2),
      {"better", at<S, &S::better>, anyName, "The group that is expected to do better"},
      {"unit", unstored<bool>, FieldWords{{"participant", 0}},
       "Unit of analysis: attempts of one person are not independent"},
      {"attemptRule", unstored<bool>, FieldWords{{"single", 0}, {"first", 1}, {"mean", 2}},
       "Value of a participant with several attempts: single refuses several, first takes the earliest, mean their "
       "mean"},
      optional("scene", at<S, &S::scene>, anyName,
               "Scene and major version, as cholecystectomy/2; attempts of others stay out. Any if absent"),
      {"exclusions", keyGroup<S, exclusionsFields>, "Attempts that stay out"},
      {"missing", at<S, &S::missing>,
       FieldWords{{"complete-cases", number(MissingRule::completeCases)},
                  {"worst-rank", number(MissingRule::worstRank)}},
       "complete-cases: who has no value is left out of that figure, and counted. worst-rank: who has none because the "
       "attempt was not completed ranks behind all others, tied (Lachin 1999)"},
      optional("test", at<S, &S::unequalSpread>, FieldWords{{"mann-whitney", 0}, {"brunner-munzel", 1}},
               "Test of two groups; brunner-munzel where they may scatter differently"),
      {"level", at<S, &S::level>, "1", above(0, 0.5), "Level of significance of the family"},
      Field("hypotheses", at<S, &S::hypotheses>,
            "At least one is primary. Holm's adjustment is over the primary ones alone; figures without a hypothesis "
            "are exploratory")
          .items(1, 200),
  };
}

namespace {

void checkCriterion(const JsonPlace& place, const PopulationCriterion& criterion) {
  const bool bounded = criterion.atLeast || criterion.atMost;
  if (bounded == place.has("equals"))
    place.fail("either \"equals\", or \"atLeast\" or \"atMost\" or both are expected");
  if (criterion.atLeast && criterion.atMost && *criterion.atLeast > *criterion.atMost)
    place.fail("\"atLeast\" is larger than \"atMost\"");
}

void checkGroup(const Protocol& protocol, const JsonPlace& place, const std::string& group) {
  if (group != protocol.populations[0].group && group != protocol.populations[1].group)
    place.fail(fmt::format("none of the populations' groups, {} and {}", protocol.populations[0].group,
                           protocol.populations[1].group));
}

void checkHypothesis(const Protocol& protocol, const JsonPlace& place, DirectedHypothesis& hypothesis) {
  const std::string& name = hypothesis.checkpoint;
  hypothesis.external = place.has("external");
  if (place.has("checkpoint") + place.has("external") + place.has("outcome") != 1)
    place.fail(
        "one of \"checkpoint\", \"external\" (a metric of your own) and \"outcome\" (a column of a table from "
        "elsewhere) is expected");
  if (place.has("sha256") && !hypothesis.external) place.at("sha256").fail("only an external metric has a script");
  if (hypothesis.external) {
    if (findCheckpoint(name) != nullptr)
      place.at("external").fail("a checkpoint of the program; name it as \"checkpoint\"");
    if (place.has("subject")) place.at("subject").fail("an external metric has none");
  } else if (place.has("outcome")) {
    if (place.has("subject")) place.at("subject").fail("an outcome has none: it is a column of a table");
  } else if (const CheckpointDefinition* const known = findCheckpoint(name); known == nullptr) {
    std::vector<std::string> names;
    for (const CheckpointEntry& entry : checkpointRegistry()) names.push_back(entry.definition.name);
    place.at("checkpoint")
        .fail(fmt::format("no checkpoint of this name{} (calot checkpoints lists them)",
                          recorder::didYouMean(name, names)));
  } else {
    const std::vector<std::string> subjects = subjectsOf(checkpointRegistry()[positionOf(name)], {});
    const bool ofOrgans = known->aggregation == Aggregation::organ;  // of the scene: `calot protocol check` knows them
    if (ofOrgans ? hypothesis.subject.empty() : std::count(subjects.begin(), subjects.end(), hypothesis.subject) == 0) {
      place.fail(subjects == std::vector<std::string>{""}
                     ? fmt::format("{} is of the whole attempt and has no subject", name)
                     : fmt::format("{} needs its \"subject\": {}", name,
                                   ofOrgans ? "an organ" : fmt::format("{}", fmt::join(subjects, ", "))));
    }
  }
  if (hypothesis.margin.has_value() == (hypothesis.claim == Claim::difference))
    place.fail("equivalence and non-inferiority need a \"margin\", a difference has none");
  checkGroup(protocol, place.at("larger"), hypothesis.larger);
}

}  // namespace

Protocol readProtocol(const std::filesystem::path& file) {
  const std::string name = file.filename().string();
  return parseProtocol(recorder::readFileBytes(file, name, 1U << 20U), name);
}

Protocol parseProtocol(std::span<const std::byte> bytes, const std::string& file) {
  const nlohmann::json json = recorder::parseStrictJson(bytes, file);
  const JsonPlace root(json, file);
  Protocol protocol;
  recorder::readRecord(root, protocol);
  keepText(bytes, file, protocol);
  const std::string rule = root.at("attemptRule").text(maxName);
  if (rule != "single") protocol.attemptRule = rule == "first" ? AttemptRule::first : AttemptRule::mean;
  const JsonPlace populations = root.at("populations");
  for (std::size_t i = 0; i < 2; ++i) {
    const std::vector<PopulationCriterion>& criteria = protocol.populations[i].criteria;
    for (std::size_t c = 0; c < criteria.size(); ++c)
      checkCriterion(populations.at(i).at("criteria").at(c), criteria[c]);
  }
  if (protocol.populations[0].group == protocol.populations[1].group)
    populations.at(1).fail("has the group of the first population");
  if (protocol.populations[0].planned + protocol.populations[1].planned > 0 && protocol.sampleSizeReason.empty())
    root.fail("\"planned\" participants need their \"sampleSizeReason\"");
  checkGroup(protocol, root.at("better"), protocol.better);
  std::set<std::string> seen;
  for (std::size_t i = 0; i < protocol.hypotheses.size(); ++i) {
    DirectedHypothesis& h = protocol.hypotheses[i];
    const JsonPlace place = root.at("hypotheses").at(i);
    checkHypothesis(protocol, place, h);
    // As tables name it: the column "path-length left" is the left hand's path length.
    if (!seen.insert(figureName(h.checkpoint, h.subject)).second)
      place.fail("a hypothesis on this figure stands above already");
  }
  if (std::none_of(protocol.hypotheses.begin(), protocol.hypotheses.end(), [](const auto& h) { return h.primary; }))
    root.at("hypotheses").fail("none is primary; at least one is expected");
  return protocol;
}

std::string whyOutside(const Population& population, const std::map<std::string, std::string>& experience) {
  for (const PopulationCriterion& c : population.criteria) {
    const auto at = experience.find(c.criterion);
    if (at == experience.end()) return fmt::format("{} not recorded", c.criterion);
    if (!c.equals.empty()) {
      if (at->second != c.equals) return fmt::format("{} {}, {} wanted", c.criterion, at->second, c.equals);
      continue;
    }
    std::string fault;
    const double value = recorder::readFiniteNumber(at->second, fault);
    if (!fault.empty()) return fmt::format("{} is not a number", c.criterion);
    if (c.atLeast && value < *c.atLeast)
      return fmt::format("{} {}, at least {} wanted", c.criterion, value, *c.atLeast);
    if (c.atMost && value > *c.atMost) return fmt::format("{} {}, at most {} wanted", c.criterion, value, *c.atMost);
  }
  return {};
}

std::vector<std::string> changedPlaces(const std::string& before, const std::string& after) {
  std::vector<std::string> places;
  for (const auto& step : nlohmann::json::diff(nlohmann::json::parse(before), nlohmann::json::parse(after))) {
    const auto path = step.at("path").get<std::string>();
    if (path != "/version") places.push_back(path);
  }
  if (places.empty()) places.emplace_back("layout only");
  return places;
}

}  // namespace calot::analytics
