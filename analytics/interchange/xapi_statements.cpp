// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/interchange/xapi_statements.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>

#include "analytics/cohort/cohort_database.h"
#include "recorder/attempt.h"
#include "recorder/base/errors.h"
#include "recorder/recording/layout.h"

namespace calot::analytics {
namespace {

using Json = nlohmann::ordered_json;

/// The site's identifiers without a slash behind them.
std::string homeOf(const std::string& given) {
  std::string home = given;
  while (!home.empty() && home.back() == '/') home.pop_back();
  const bool web = home.rfind("https://", 0) == 0 || home.rfind("http://", 0) == 0;
  const bool sound = std::all_of(home.begin(), home.end(), [](unsigned char c) {
    return c > ' ' && c != 0x7F && c != '"' && c != '<' && c != '>' && c != '\\' && c != '^' && c != '`' && c != '{' &&
           c != '|' && c != '}' && c != '?' && c != '#';
  });
  if (!web || !sound || home.find('/') + 2 >= home.size())
    throw Error(
        ErrorKind::invalid,
        fmt::format("xapi: \"{}\" is no home page: give the site's own, such as https://training.example.org", given));
  return home;
}

Json valuesOf(const std::vector<const CheckpointValue*>& values) {
  Json list = Json::array();
  for (const CheckpointValue* v : values) {
    Json one{{"checkpoint", v->name}, {"version", v->version}};
    if (!v->subject.empty()) one["subject"] = v->subject;
    if (v->value) {
      one["value"] = *v->value;
      one["unit"] = v->unit;
    } else {
      one["unavailable"] = nameOf(v->availability);
      one["reason"] = v->reason;
    }
    one["origin"] = nameOf(v->origin);
    list.push_back(std::move(one));
  }
  return list;
}

Json statementOf(const AttemptRow& a, const std::vector<const CheckpointValue*>& values, const std::string& home) {
  const bool completed = a.outcome == recorder::Outcome::completed;
  const std::string actor = a.participant.empty() ? a.profile : a.participant;
  Json statement{{"id", a.uuid},
                 {"actor", {{"objectType", "Agent"}, {"account", {{"homePage", home}, {"name", actor}}}}},
                 {"verb",
                  {{"id", fmt::format("http://adlnet.gov/expapi/verbs/{}", completed ? "completed" : "attempted")},
                   {"display", {{"en", completed ? "completed" : "attempted"}}}}},
                 {"object",
                  {{"objectType", "Activity"},
                   {"id", fmt::format("{}/scenes/{}/{}", home, a.scene, a.sceneMajor)},
                   {"definition",
                    {{"type", "http://adlnet.gov/expapi/activities/simulation"},
                     {"name", {{"en", fmt::format("{} {}.{}", a.scene, a.sceneMajor, a.sceneMinor)}}}}}}}};
  statement["result"] = {{"completion", completed},
                         {"duration", fmt::format("PT{:.2f}S", static_cast<double>(a.steps) * a.stepSeconds)},
                         {"extensions", {{home + "/extensions/checkpoints", valuesOf(values)}}}};
  statement["context"] = {{"platform", recorder::softwareName()},
                          {"extensions",
                           {{home + "/extensions/attempt",
                             {{"outcome", recorder::outcomeNames[static_cast<std::size_t>(a.outcome)]},
                              {"mode", recorder::modeNames[static_cast<std::size_t>(a.mode)]},
                              {"device", a.device},
                              {"comparability_key", a.comparabilityKey},
                              {"simulation_version", a.simulationVersion},
                              {"verification", nameOf(a.verification.verdict)},
                              {"synthetic", a.synthetic}}}}}};
  if (!a.startUtc.empty()) statement["timestamp"] = a.startUtc;
  return statement;
}

}  // namespace

XapiStatements xapiStatements(const std::string& database, const XapiOptions& options) {
  const std::string home = homeOf(options.home);
  const CohortDatabase cohort(database, CohortDatabase::Access::read);
  const std::vector<AttemptRow> attempts = cohort.listAttempts();
  const std::vector<AttemptValue> all = cohort.allValues();
  std::map<std::string, std::vector<const CheckpointValue*>> values;
  for (const AttemptValue& v : all) values[v.attempt].push_back(&v.value);
  XapiStatements result;
  result.recruited = attempts.size();
  Json list = Json::array();
  for (const AttemptRow& a : attempts) {
    const bool named = !a.participant.empty() || (a.synthetic && !a.profile.empty());
    if (!named || a.excluded || a.withdrawn || (a.synthetic && !options.includeSynthetic)) continue;
    list.push_back(statementOf(a, values[a.uuid], home));
    result.attempts.push_back(a.uuid);
  }
  if (result.attempts.empty())
    throw Error(ErrorKind::refused, Where{database},
                fmt::format("none of its {} attempts is of a participant and neither excluded nor synthetic",
                            result.recruited));
  result.json = list.dump(2, ' ', false, Json::error_handler_t::replace) + "\n";
  return result;
}

}  // namespace calot::analytics
