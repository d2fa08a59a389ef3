// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/assessment/protocol.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "analytics/checkpoints/registry.h"
#include "recorder/base/errors.h"
#include "recorder/base/file_bytes.h"
#include "recorder/base/nearest_word.h"
#include "recorder/base/text_words.h"

namespace calot::analytics {
namespace {

using recorder::JsonObject;
using recorder::JsonPlace;
using recorder::ObjectRule;
using recorder::Outcome;

constexpr std::size_t maxBytes = 1U << 20U;
constexpr std::size_t maxHypotheses = 200, maxCriteria = 20, maxReasons = 50;
constexpr double maxBound = 1e9;

std::string didYouMeanCheckpoint(const std::string& name) {
  std::vector<std::string> known;
  for (const CheckpointEntry& entry : checkpointRegistry()) known.push_back(entry.definition.name);
  return recorder::didYouMean(name, known);
}

const ObjectRule rootRule{"",
                          {{"format"},
                           {"formatVersion", true, 1, 1},
                           {"name"},
                           {"version", true, 1, 1000000},
                           {"title"},
                           {"question", false},
                           {"operators", false},
                           {"populations"},
                           {"better"},
                           {"unit"},
                           {"attemptRule"},
                           {"scene", false},
                           {"exclusions"},
                           {"missing"},
                           {"level", true, 0.0, 0.5, true},
                           {"hypotheses"}}};
const ObjectRule populationRule{"population", {{"group"}, {"definition"}, {"criteria", false}}};
const ObjectRule criterionRule{"criterion",
                               {{"criterion"},
                                {"atLeast", false, -maxBound, maxBound},
                                {"atMost", false, -maxBound, maxBound},
                                {"equals", false}}};
const ObjectRule exclusionsRule{"exclusions", {{"outcomes"}, {"reasons"}}};
const ObjectRule hypothesisRule{"hypothesis",
                                {{"checkpoint", false},
                                 {"external", false},
                                 {"sha256", false},
                                 {"outcome", false},
                                 {"subject", false},
                                 {"larger"},
                                 {"primary"}}};

PopulationCriterion criterionAt(const JsonPlace& place) {
  const JsonObject o = place.object(criterionRule);
  PopulationCriterion criterion;
  o.read("criterion", criterion.criterion, maxName);
  const auto bound = [&](const char* key) {
    double value = 0.0;
    o.read(key, value);
    return o.has(key) ? std::optional(value) : std::nullopt;
  };
  criterion.atLeast = bound("atLeast");
  criterion.atMost = bound("atMost");
  o.read("equals", criterion.equals, maxName);
  const bool bounded = criterion.atLeast || criterion.atMost;
  if (bounded == o.has("equals")) o.fail("either \"equals\", or \"atLeast\" or \"atMost\" or both are wanted");
  if (criterion.atLeast && criterion.atMost && *criterion.atLeast > *criterion.atMost)
    o.fail("\"atLeast\" is larger than \"atMost\"");
  return criterion;
}

Population populationAt(const JsonPlace& place) {
  const JsonObject o = place.object(populationRule);
  Population population;
  o.read("group", population.group, maxName);
  o.read("definition", population.definition, maxText);
  if (o.has("criteria")) {
    for (const JsonPlace& item : o.at("criteria").list(0, maxCriteria))
      population.criteria.push_back(criterionAt(item));
  }
  return population;
}

void askForGroup(const Protocol& protocol, const JsonPlace& place, const std::string& group) {
  if (group != protocol.populations[0].group && group != protocol.populations[1].group)
    place.fail(fmt::format("none of the populations' groups, {} and {}", protocol.populations[0].group,
                           protocol.populations[1].group));
}

DirectedHypothesis hypothesisAt(const Protocol& protocol, const JsonPlace& place) {
  const JsonObject o = place.object(hypothesisRule);
  DirectedHypothesis hypothesis;
  const int named = (o.has("checkpoint") ? 1 : 0) + (o.has("external") ? 1 : 0) + (o.has("outcome") ? 1 : 0);
  if (named != 1)
    o.fail(
        "one of \"checkpoint\", \"external\" (a metric of your own) and \"outcome\" (a column of a table from "
        "elsewhere) is wanted");
  if (o.has("sha256") && !o.has("external")) o.at("sha256").fail("only an external metric has a script");
  if (o.has("external")) {
    hypothesis.external = true;
    o.read("external", hypothesis.checkpoint, maxName);
    if (findCheckpoint(hypothesis.checkpoint) != nullptr)
      o.at("external").fail("a checkpoint of the program; name it as \"checkpoint\"");
    if (o.has("subject")) o.at("subject").fail("an external metric has none");
    o.read("sha256", hypothesis.sha256, maxName);
    if (o.has("sha256") && (hypothesis.sha256.size() != 64 ||
                            hypothesis.sha256.find_first_not_of("0123456789abcdef") != std::string::npos))
      o.at("sha256").fail("64 hexadecimal digits in small letters are wanted");
  } else if (o.has("outcome")) {
    o.read("outcome", hypothesis.checkpoint, maxName);
    if (o.has("subject")) o.at("subject").fail("an outcome has none: it is a column of a table");
  } else {
    o.read("checkpoint", hypothesis.checkpoint, maxName);
    if (findCheckpoint(hypothesis.checkpoint) == nullptr)
      o.at("checkpoint")
          .fail(fmt::format("no checkpoint of this name{} (calot checkpoints lists them)",
                            didYouMeanCheckpoint(hypothesis.checkpoint)));
  }
  o.read("subject", hypothesis.subject, maxName);
  o.read("larger", hypothesis.larger, maxName);
  askForGroup(protocol, o.at("larger"), hypothesis.larger);
  o.read("primary", hypothesis.primary);
  return hypothesis;
}

void readExclusions(Protocol& protocol, const JsonObject& o) {
  for (const JsonPlace& item : o.at("outcomes").list(0, 5)) {
    protocol.excludedOutcomes.push_back(item.word<Outcome>({{"time limit", Outcome::timeLimit},
                                                            {"abandoned", Outcome::abandoned},
                                                            {"stopped", Outcome::stopped},
                                                            {"technical failure", Outcome::technicalFailure}}));
  }
  for (const JsonPlace& item : o.at("reasons").list(0, maxReasons))
    protocol.exclusionReasons.push_back(item.text(maxText));
}

}  // namespace

const std::vector<ObjectRule>& protocolRules() {
  static const std::vector<ObjectRule> rules{rootRule, populationRule, criterionRule, exclusionsRule, hypothesisRule};
  return rules;
}

Protocol readProtocol(const std::filesystem::path& file) {
  const std::string name = file.filename().string();
  return parseProtocol(recorder::readFileBytes(file, name, maxBytes), name);
}

Protocol parseProtocol(std::span<const std::byte> bytes, const std::string& file) {
  const nlohmann::json json = recorder::parseStrictJson(bytes, file);
  const JsonObject o = JsonPlace(json, file).object(rootRule);
  Protocol protocol;
  readHead(o, "calot-protocol", bytes, file, protocol);
  o.read("question", protocol.question, maxText);
  if (o.has("operators")) protocol.performers = o.at("operators").word<bool>({{"people", false}, {"performers", true}});
  const std::vector<JsonPlace> populations = o.at("populations").list(2, 2);
  for (std::size_t i = 0; i < 2; ++i) protocol.populations[i] = populationAt(populations[i]);
  if (protocol.populations[0].group == protocol.populations[1].group)
    populations[1].fail("has the group of the first population");
  o.read("better", protocol.better, maxName);
  askForGroup(protocol, o.at("better"), protocol.better);
  (void)o.at("unit").word<int>({{"participant", 0}});
  protocol.attemptRule =
      o.at("attemptRule")
          .word<std::optional<AttemptRule>>(
              {{"single", std::nullopt}, {"first", AttemptRule::first}, {"mean", AttemptRule::mean}});
  o.read("scene", protocol.scene, maxName);
  readExclusions(protocol, o.at("exclusions").object(exclusionsRule));
  protocol.missing = o.at("missing").word<MissingRule>(
      {{"complete-cases", MissingRule::completeCases}, {"worst-rank", MissingRule::worstRank}});
  o.read("level", protocol.level);
  std::set<std::string> seen;
  for (const JsonPlace& place : o.at("hypotheses").list(1, maxHypotheses)) {
    const DirectedHypothesis h = hypothesisAt(protocol, place);
    // As tables name it: the column "path-length left" is the left hand's path length.
    if (!seen.insert(figureName(h.checkpoint, h.subject)).second)
      place.fail("a hypothesis on this figure stands above already");
    protocol.hypotheses.push_back(h);
  }
  if (std::none_of(protocol.hypotheses.begin(), protocol.hypotheses.end(), [](const auto& h) { return h.primary; }))
    o.at("hypotheses").fail("none is primary; at least one is wanted");
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
    if (!fault.empty()) return fmt::format("{} is no number", c.criterion);
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
