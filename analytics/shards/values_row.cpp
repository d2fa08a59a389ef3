// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/shards/values_row.h"

#include <algorithm>
#include <limits>
#include <string_view>
#include <utility>

#include "analytics/shards/record_json.h"
#include "analytics/shards/row_text.h"
#include "recorder/base/errors.h"
#include "recorder/base/json_reader.h"

namespace calot::analytics {
namespace {

using nlohmann::ordered_json;
using recorder::JsonObject;
using recorder::JsonPlace;
using recorder::KeyRule;
using recorder::ObjectRule;
using recorder::ReplayReport;
using recorder::ReplayVerdict;

constexpr double maxNumber = std::numeric_limits<double>::max();
constexpr std::size_t maxValues = 100'000;

constexpr std::pair<const char*, ReplayVerdict> verdictWords[] = {{"exact", ReplayVerdict::exact},
                                                                  {"diverged", ReplayVerdict::diverged},
                                                                  {"damaged", ReplayVerdict::damaged},
                                                                  {"undecided", ReplayVerdict::undecided}};
/// Those that judging a recording gives; others are not written.
constexpr std::pair<const char*, Remedy> remedyWords[] = {
    {"recover", Remedy::recover}, {"install engine", Remedy::installEngine}, {"replay anyway", Remedy::replayAnyway}};

std::vector<KeyRule> joined(std::initializer_list<std::vector<KeyRule>> parts) {
  std::vector<KeyRule> all;
  for (const std::vector<KeyRule>& part : parts) all.insert(all.end(), part.begin(), part.end());
  return all;
}

const ObjectRule& rowRule() {
  static const ObjectRule rule{"row", joined({{countKey("position")},
                                              {{"attempt", false}},
                                              textKeys("file"),
                                              {{"report", false}, {"record", false}, {"values", false}}})};
  return rule;
}

const ObjectRule& reportRule() {
  static const ObjectRule rule{"report",
                               joined({{{"verdict"}, {"complete"}, {"chain_intact"}},
                                       {countKey("steps"), countKey("simulation_version")},
                                       {{"seconds", true, 0.0, maxNumber}, {"wall_seconds", true, 0.0, maxNumber}},
                                       textKeys("message"),
                                       {{"remedies", false}, {"misses", false}, {"divergence", false}}})};
  return rule;
}

const ObjectRule& missesRule() {
  static const ObjectRule rule{
      "misses", {countKey("steps"), countKey("any"), countKey("solver"), countKey("contact"), countKey("held_back")}};
  return rule;
}

const ObjectRule& divergenceRule() {
  static const ObjectRule rule{"divergence", joined({{countKey("step"), countKey("tick", false)},
                                                     textKeys("component"),
                                                     textKeys("field"),
                                                     textKeys("detail"),
                                                     {{"reproducible", false}}})};
  return rule;
}

const ObjectRule& valueRule() {
  static const ObjectRule rule{"value", joined({{{"name"}, {"version", false, 0.0, 4294967295.0}},
                                                textKeys("subject"),
                                                {{"value", false, -maxNumber, maxNumber}, {"missing", false}},
                                                textKeys("reason"),
                                                textKeys("note"),
                                                textKeys("unit"),
                                                textKeys("filter"),
                                                {{"origin"}, {"coverage", false, 0.0, 1.0}}})};
  return rule;
}

ordered_json jsonOfReport(const ReplayReport& r) {
  ordered_json json;
  for (const auto& [word, verdict] : verdictWords) {
    if (verdict == r.verdict) json["verdict"] = word;
  }
  json["complete"] = r.complete;
  json["chain_intact"] = r.chainIntact;
  json["steps"] = r.steps;
  json["simulation_version"] = r.simulationVersion;
  json["seconds"] = r.seconds;
  json["wall_seconds"] = r.wallSeconds;
  putText(json, "message", r.message);
  for (const auto& [word, remedy] : remedyWords) {
    if (std::find(r.remedies.begin(), r.remedies.end(), remedy) != r.remedies.end()) json["remedies"].push_back(word);
  }
  if (r.misses.steps > 0) {
    json["misses"] = {{"steps", r.misses.steps},
                      {"any", r.misses.any},
                      {"solver", r.misses.solver},
                      {"contact", r.misses.contact},
                      {"held_back", r.misses.heldBack}};
  }
  if (r.divergence) {
    ordered_json& d = json["divergence"];
    d["step"] = r.divergence->step;
    if (r.divergence->tick) d["tick"] = *r.divergence->tick;
    putText(d, "component", r.divergence->component);
    putText(d, "field", r.divergence->field);
    putText(d, "detail", r.divergence->detail);
    if (r.reproducible) d["reproducible"] = *r.reproducible;
  }
  return json;
}

ReplayReport reportOf(const JsonObject& o) {
  ReplayReport r;
  r.verdict = o.at("verdict").word<ReplayVerdict>({verdictWords[0], verdictWords[1], verdictWords[2], verdictWords[3]});
  o.read("complete", r.complete);
  o.read("chain_intact", r.chainIntact);
  r.steps = takeCount(o, "steps");
  r.simulationVersion = static_cast<std::uint32_t>(takeCount(o, "simulation_version"));
  o.read("seconds", r.seconds);
  o.read("wall_seconds", r.wallSeconds);
  r.message = takeText(o, "message");
  if (o.has("remedies")) {
    static_assert(std::size(remedyWords) == 3);
    for (const JsonPlace& place : o.at("remedies").list(0, std::size(remedyWords)))
      r.remedies.push_back(place.word<Remedy>({remedyWords[0], remedyWords[1], remedyWords[2]}));
  }
  if (o.has("misses")) {
    const JsonObject m = o.at("misses").object(missesRule());
    r.misses = {takeCount(m, "steps"), takeCount(m, "any"), takeCount(m, "solver"), takeCount(m, "contact"),
                takeCount(m, "held_back")};
  }
  if (o.has("divergence")) {
    const JsonObject d = o.at("divergence").object(divergenceRule());
    r.divergence.emplace();
    r.divergence->step = takeCount(d, "step");
    if (d.has("tick")) r.divergence->tick = takeCount(d, "tick");
    r.divergence->component = takeText(d, "component");
    r.divergence->field = takeText(d, "field");
    r.divergence->detail = takeText(d, "detail");
    if (d.has("reproducible")) r.reproducible = d.at("reproducible").boolean();
  }
  return r;
}

const DefinedCheckpoint* definitionOf(const ValuesHeader& header, const std::string& name) {
  const auto same = [&](const DefinedCheckpoint& d) { return d.name == name; };
  const auto found = std::find_if(header.checkpoints.begin(), header.checkpoints.end(), same);
  return found == header.checkpoints.end() ? nullptr : &*found;
}

ordered_json jsonOfValue(const CheckpointValue& v, const ValuesHeader& header) {
  const DefinedCheckpoint* defined = definitionOf(header, v.name);
  ordered_json json = {{"name", v.name}};
  putText(json, "subject", v.subject);
  if (v.value) {
    json["value"] = *v.value;
  } else {
    json["missing"] = nameOf(v.availability);
  }
  putText(json, "reason", v.reason);
  putText(json, "note", v.note);
  if (defined == nullptr || defined->version != v.version) json["version"] = v.version;
  if (defined == nullptr || defined->unit != v.unit) putText(json, "unit", v.unit);
  if (defined == nullptr || defined->filter != v.filter) putText(json, "filter", v.filter);
  json["origin"] = nameOf(v.origin);
  if (v.coverage) json["coverage"] = *v.coverage;
  return json;
}

CheckpointValue valueOf(const JsonObject& o, const ValuesHeader& header) {
  CheckpointValue v;
  o.read("name", v.name, maxRowText);
  if (const DefinedCheckpoint* defined = definitionOf(header, v.name)) {
    v.version = defined->version;
    v.unit = defined->unit;
    v.filter = defined->filter;
  }
  v.subject = takeText(o, "subject");
  if (o.has("value")) o.read("value", v.value.emplace());
  v.availability = Availability::value;
  if (o.has("missing")) {
    v.availability = o.at("missing").word<Availability>({{"not applicable", Availability::notApplicable},
                                                         {"not available", Availability::notAvailable},
                                                         {"absent hand", Availability::absentHand},
                                                         {"too little coverage", Availability::tooLittleCoverage}});
  }
  v.reason = takeText(o, "reason");
  v.note = takeText(o, "note");
  if (v.value.has_value() == o.has("missing") || v.value.has_value() != v.reason.empty())
    o.fail("either a value or what is missing, with its reason, is wanted");
  o.read("version", v.version);
  if (o.has("unit") || o.has("unit_hex")) v.unit = takeText(o, "unit");
  if (o.has("filter") || o.has("filter_hex")) v.filter = takeText(o, "filter");
  v.origin = o.at("origin").word<Origin>(
      {{"re-simulated", Origin::resimulated}, {"observables", Origin::observables}, {"samples", Origin::samples}});
  if (o.has("coverage")) o.read("coverage", v.coverage.emplace());
  return v;
}

}  // namespace

ordered_json jsonOf(const ValuesRow& row, const ValuesHeader& header) {
  ordered_json json = {{"position", row.position}};
  if (!row.attempt.empty()) json["attempt"] = row.attempt;
  putText(json, "file", row.file);
  if (!row.judged) return json;
  json["report"] = jsonOfReport(row.judged->report);
  if (!row.judged->record) return json;
  json["record"] = jsonOfRecord(*row.judged->record);
  json["values"] = ordered_json::array();
  for (const CheckpointValue& v : row.judged->values) json["values"].push_back(jsonOfValue(v, header));
  return json;
}

ValuesRow valuesRow(const nlohmann::json& json, const ValuesHeader& header, const std::string& file) {
  const JsonObject o = JsonPlace(json, file).object(rowRule());
  ValuesRow row;
  row.position = takeCount(o, "position");
  o.read("attempt", row.attempt, maxRowText);
  row.file = takeText(o, "file");
  if (!o.has("report")) {
    if (o.has("record") || o.has("values")) o.fail("a record without its report");
    return row;
  }
  JudgedRecording& judged = row.judged.emplace();
  judged.report = reportOf(o.at("report").object(reportRule()));
  judged.report.path = row.file;
  judged.report.attempt = row.attempt;
  if (o.has("record") != o.has("values") || o.has("record") == (judged.report.verdict == ReplayVerdict::damaged))
    o.fail("a record and values are wanted exactly where the recording could be read");
  if (!o.has("record")) return row;
  judged.record = recordFrom(o.at("record"));
  if (judged.record->uuid != row.attempt) o.at("record").fail("is of another attempt");
  judged.report.outcome = judged.record->outcome;
  judged.report.chainHead = judged.record->chainHead;
  for (const JsonPlace& place : o.at("values").list(0, maxValues))
    judged.values.push_back(valueOf(place.object(valueRule()), header));
  return row;
}

}  // namespace calot::analytics
