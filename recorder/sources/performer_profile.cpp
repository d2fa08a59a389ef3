// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/performer_profile.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <stdexcept>

#include "recorder/base/errors.h"
#include "recorder/base/file_bytes.h"
#include "recorder/base/nearest_word.h"
#include "sim/math/floating_point.h"

namespace calot::recorder {
namespace fs = std::filesystem;
namespace {

KeyRule bounded(const char* key, double lower, double upper) { return {key, true, lower, upper}; }

std::vector<ObjectRule> makeRules() {
  return {
      {"",
       {KeyRule{"format"}, bounded("formatVersion", 1, 1), KeyRule{"name"}, KeyRule{"version"}, KeyRule{"summary"},
        KeyRule{"motor"}, KeyRule{"perception"}, KeyRule{"decision"}, KeyRule{"operation"}, KeyRule{"scope", false}}},
      {"motor",
       {bounded("strokeSpeed", 0.001, 1), bounded("contactSpeed", 0.001, 0.5), bounded("shortestStroke", 0.05, 5),
        bounded("endpointNoise", 0, 0.3), bounded("tremorAmplitude", 0, 0.002), bounded("tremorLower", 2, 20),
        bounded("tremorUpper", 2, 20), bounded("wanderAmplitude", 0, 0.005), bounded("rollSpread", 0, 1.5),
        bounded("workSpeed", 0.001, 0.5), bounded("overshootShare", 0, 1), bounded("overshoot", 0, 0.5)}},
      {"perception",
       {bounded("reactionTime", 0, 3), bounded("reactionSpread", 0, 1), bounded("lateralError", 0, 0.01),
        bounded("depthError", 0, 0.02), bounded("finestError", 0, 0.005)}},
      {"decision",
       {bounded("touches", 1, 50), bounded("pressDepth", 0, 0.02), bounded("pressSpread", 0, 0.01),
        bounded("dwell", 0, 30), bounded("pause", 0, 30), bounded("pauseSpread", 0, 10), bounded("corrections", 0, 10),
        bounded("pullBack", 0.005, 0.1), KeyRule{"bimanual"}}},
      {"operation",
       {bounded("hesitationShare", 0, 1), bounded("hesitation", 0, 10), bounded("pedalLag", 0, 2),
        bounded("keepOff", 0, 0.005), bounded("layer", 0.0001, 0.005), bounded("cleared", 0.1, 1),
        bounded("bareShare", 0, 1), bounded("strokes", 0, 200), bounded("burnSpeed", 0.0005, 0.1),
        bounded("pull", 0, 0.05), bounded("stretch", 0.001, 0.05), bounded("slipShare", 0, 1),
        bounded("anticipation", 0, 1), bounded("series", 1, 20), bounded("window", 0, 200),
        bounded("patience", 10, 3600)}},
      {"scope", {bounded("reaction", 0.05, 5), bounded("deadZone", 0, 1), bounded("horizonError", 0, 0.5)}},
  };
}

const ObjectRule& ruleOf(const std::string& definition) {
  const std::vector<ObjectRule>& rules = performerRules();
  const auto found =
      std::find_if(rules.begin(), rules.end(), [&](const ObjectRule& r) { return r.definition == definition; });
  if (found == rules.end()) throw std::logic_error("no performer rule " + definition);
  return *found;
}

}  // namespace

const std::vector<ObjectRule>& performerRules() {
  static const std::vector<ObjectRule> rules = makeRules();
  return rules;
}

PerformerProfile loadPerformer(const fs::path& file) {
  const FloatingPointScope environment;
  const std::string name = file.filename().string();
  const nlohmann::json json = parseStrictJson(readFileBytes(file, name, std::size_t{4} << 20U), name);
  const JsonObject object = JsonPlace(json, name).object(ruleOf(""));
  if (object.at("format").text(64) != "calot-performer") object.at("format").fail("\"calot-performer\" is wanted");
  std::uint32_t formatVersion = 0;
  object.read("formatVersion", formatVersion);
  PerformerProfile profile;
  object.read("name", profile.name, 64);
  object.read("version", profile.version, 32);
  object.read("summary", profile.summary, 500);

  const JsonObject motor = object.at("motor").object(ruleOf("motor"));
  motor.read("strokeSpeed", profile.motor.strokeSpeed);
  motor.read("contactSpeed", profile.motor.contactSpeed);
  motor.read("shortestStroke", profile.motor.minStroke);
  motor.read("endpointNoise", profile.motor.endpointNoise);
  motor.read("tremorAmplitude", profile.motor.tremorAmplitude);
  motor.read("tremorLower", profile.motor.tremorLower);
  motor.read("tremorUpper", profile.motor.tremorUpper);
  motor.read("wanderAmplitude", profile.motor.wanderAmplitude);
  motor.read("rollSpread", profile.motor.rollSpread);
  motor.read("workSpeed", profile.motor.workSpeed);
  motor.read("overshootShare", profile.motor.overshootShare);
  motor.read("overshoot", profile.motor.overshoot);
  if (profile.motor.tremorUpper < profile.motor.tremorLower) motor.at("tremorUpper").fail("below \"tremorLower\"");

  const JsonObject perception = object.at("perception").object(ruleOf("perception"));
  perception.read("reactionTime", profile.perception.reactionTime);
  perception.read("reactionSpread", profile.perception.reactionSpread);
  perception.read("lateralError", profile.perception.lateralError);
  perception.read("depthError", profile.perception.depthError);
  perception.read("finestError", profile.perception.finestError);

  const JsonObject decision = object.at("decision").object(ruleOf("decision"));
  decision.read("touches", profile.decision.touches);
  decision.read("pressDepth", profile.decision.pressDepth);
  decision.read("pressSpread", profile.decision.pressSpread);
  decision.read("dwell", profile.decision.dwell);
  decision.read("pause", profile.decision.pause);
  decision.read("pauseSpread", profile.decision.pauseSpread);
  decision.read("corrections", profile.decision.corrections);
  decision.read("pullBack", profile.decision.pullBack);
  decision.read("bimanual", profile.decision.bimanual);

  const JsonObject operation = object.at("operation").object(ruleOf("operation"));
  operation.read("hesitationShare", profile.operation.hesitationShare);
  operation.read("hesitation", profile.operation.hesitation);
  operation.read("pedalLag", profile.operation.pedalLag);
  operation.read("keepOff", profile.operation.keepOff);
  operation.read("layer", profile.operation.layer);
  operation.read("cleared", profile.operation.cleared);
  operation.read("bareShare", profile.operation.bareShare);
  operation.read("strokes", profile.operation.strokes);
  operation.read("burnSpeed", profile.operation.burnSpeed);
  operation.read("pull", profile.operation.pull);
  operation.read("stretch", profile.operation.stretch);
  operation.read("slipShare", profile.operation.slipShare);
  operation.read("anticipation", profile.operation.anticipation);
  operation.read("series", profile.operation.series);
  operation.read("window", profile.operation.window);
  operation.read("patience", profile.operation.patience);

  if (object.has("scope")) {
    const JsonObject scope = object.at("scope").object(ruleOf("scope"));
    scope.read("reaction", profile.scope.reaction);
    scope.read("deadZone", profile.scope.deadZone);
    scope.read("horizonError", profile.scope.horizonError);
  }
  return profile;
}

fs::path findPerformer(const std::string& name, const std::vector<fs::path>& roots) {
  std::error_code ignored;
  if (name.size() > 5 && name.substr(name.size() - 5) == ".json") {
    if (fs::is_regular_file(name, ignored)) return name;
    throw Error(ErrorKind::invalid, Where{name}, "there is no such profile");
  }
  std::set<std::string> known;
  for (const fs::path& root : roots) {
    std::error_code fault;
    for (fs::directory_iterator it(root / "performers", fault), end; !fault && it != end; it.increment(fault)) {
      if (it->path().extension() != ".json") continue;
      if (it->path().stem() == name) return it->path();
      known.insert(it->path().stem().string());
    }
  }
  std::string names;
  for (const std::string& n : known) names += (names.empty() ? "" : ", ") + n;
  throw Error(
      ErrorKind::invalid,
      fmt::format("there is no performer \"{}\"{}; {}", name, didYouMean(name, {known.begin(), known.end()}),
                  names.empty() ? std::string("no assets folder was found (set CALOT_ASSETS)") : "there are " + names));
}

}  // namespace calot::recorder
