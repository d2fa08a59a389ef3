// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/performer_profile.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "recorder/base/errors.h"
#include "recorder/base/file_bytes.h"
#include "recorder/base/nearest_word.h"
#include "recorder/sources/json_values.h"
#include "sim/math/floating_point.h"

namespace calot::recorder {
namespace fs = std::filesystem;
namespace {

/// The parts of a profile and their values.
std::vector<std::pair<const char*, JsonValues>> partsOf(PerformerProfile& p) {
  const auto bounded = [](const char* key, double lower, double upper, auto& value) {
    return JsonValue{{key, true, lower, upper}, &value};
  };
  return {
      {"motor",
       {bounded("strokeSpeed", 0.001, 1, p.motor.strokeSpeed),
        bounded("contactSpeed", 0.001, 0.5, p.motor.contactSpeed),
        bounded("shortestStroke", 0.05, 5, p.motor.minStroke), bounded("endpointNoise", 0, 0.3, p.motor.endpointNoise),
        bounded("tremorAmplitude", 0, 0.002, p.motor.tremorAmplitude),
        bounded("tremorLower", 2, 20, p.motor.tremorLower), bounded("tremorUpper", 2, 20, p.motor.tremorUpper),
        bounded("wanderAmplitude", 0, 0.005, p.motor.wanderAmplitude),
        bounded("rollSpread", 0, 1.5, p.motor.rollSpread), bounded("workSpeed", 0.001, 0.5, p.motor.workSpeed),
        bounded("overshootShare", 0, 1, p.motor.overshootShare), bounded("overshoot", 0, 0.5, p.motor.overshoot)}},
      {"perception",
       {bounded("reactionTime", 0, 3, p.perception.reactionTime),
        bounded("reactionSpread", 0, 1, p.perception.reactionSpread),
        bounded("lateralError", 0, 0.01, p.perception.lateralError),
        bounded("depthError", 0, 0.02, p.perception.depthError),
        bounded("finestError", 0, 0.005, p.perception.finestError)}},
      {"decision",
       {bounded("touches", 1, 50, p.decision.touches), bounded("pressDepth", 0, 0.02, p.decision.pressDepth),
        bounded("pressSpread", 0, 0.01, p.decision.pressSpread), bounded("dwell", 0, 30, p.decision.dwell),
        bounded("pause", 0, 30, p.decision.pause), bounded("pauseSpread", 0, 10, p.decision.pauseSpread),
        bounded("corrections", 0, 10, p.decision.corrections), bounded("pullBack", 0.005, 0.1, p.decision.pullBack),
        JsonValue{{"bimanual"}, &p.decision.bimanual}}},
      {"operation",
       {bounded("hesitationShare", 0, 1, p.operation.hesitationShare),
        bounded("hesitation", 0, 10, p.operation.hesitation), bounded("pedalLag", 0, 2, p.operation.pedalLag),
        bounded("keepOff", 0, 0.005, p.operation.keepOff), bounded("layer", 0.0001, 0.005, p.operation.layer),
        bounded("cleared", 0.1, 1, p.operation.cleared), bounded("bareShare", 0, 1, p.operation.bareShare),
        bounded("strokes", 0, 200, p.operation.strokes), bounded("burnSpeed", 0.0005, 0.1, p.operation.burnSpeed),
        bounded("pull", 0, 0.05, p.operation.pull), bounded("stretch", 0.001, 0.05, p.operation.stretch),
        bounded("slipShare", 0, 1, p.operation.slipShare), bounded("anticipation", 0, 1, p.operation.anticipation),
        bounded("series", 1, 20, p.operation.series), bounded("window", 0, 200, p.operation.window),
        bounded("patience", 10, 3600, p.operation.patience)}},
      {"scope",
       {bounded("reaction", 0.05, 5, p.scope.reaction), bounded("deadZone", 0, 1, p.scope.deadZone),
        bounded("horizonError", 0, 0.5, p.scope.horizonError)}}};
}

const ObjectRule profileRule{"",
                             {{"format"},
                              {"formatVersion", true, 1, 1},
                              {"name"},
                              {"version"},
                              {"summary"},
                              {"motor"},
                              {"perception"},
                              {"decision"},
                              {"operation"},
                              {"scope", false}}};

}  // namespace

std::vector<ObjectRule> performerRules() {
  PerformerProfile profile;
  std::vector<ObjectRule> rules{profileRule};
  for (const auto& [name, values] : partsOf(profile)) rules.push_back(ruleOf(name, values));
  return rules;
}

PerformerProfile loadPerformer(const fs::path& file) {
  const FloatingPointScope environment;
  const std::string name = file.filename().string();
  const nlohmann::json json = parseStrictJson(readFileBytes(file, name, std::size_t{4} << 20U), name);
  const JsonObject object = JsonPlace(json, name).object(profileRule);
  if (object.at("format").text(64) != "calot-performer") object.at("format").fail("\"calot-performer\" is wanted");
  std::uint32_t formatVersion = 0;
  object.read("formatVersion", formatVersion);
  PerformerProfile profile;
  object.read("name", profile.name, 64);
  object.read("version", profile.version, 32);
  object.read("summary", profile.summary, 500);

  for (const auto& [part, values] : partsOf(profile)) {
    if (object.has(part)) readValues(object.at(part), values);
  }
  if (profile.motor.tremorUpper < profile.motor.tremorLower)
    JsonPlace(json, name, "/motor/tremorUpper").fail("below \"tremorLower\"");
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
