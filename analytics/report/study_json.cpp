// SPDX-License-Identifier: GPL-3.0-or-later
#include <nlohmann/json.hpp>

#include "analytics/report/study_output.h"

namespace calot::analytics {
namespace {

using Json = nlohmann::ordered_json;

Json numberOrNull(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

Json groupJson(const std::string& name, const GroupSummary& s) {
  return {{"group", name},
          {"n", s.n},
          {"missing", s.missing},
          {"missing_reason", s.missingReason},
          {"mean", numberOrNull(s.mean)},
          {"sd", numberOrNull(s.standardDeviation)},
          {"median", numberOrNull(s.median)},
          {"lower_quartile", numberOrNull(s.lowerQuartile)},
          {"upper_quartile", numberOrNull(s.upperQuartile)}};
}

template <class T, class Write>
Json answerJson(const Answer<T>& answer, Write write) {
  if (!answer) return {{"value", nullptr}, {"reason", answer.reason()}};
  return write(*answer);
}

Json rowJson(const Study& study, const StudyRow& row) {
  Json j{{"checkpoint", row.checkpoint},       {"subject", row.subject},   {"title", row.title},    {"unit", row.unit},
         {"direction", nameOf(row.direction)}, {"versions", row.versions}, {"origins", row.origins}};
  j["groups"] = Json::array({groupJson(study.groups[0], row.group[0]), groupJson(study.groups[1], row.group[1])});
  j["mann_whitney"] = answerJson(row.test, [](const MannWhitney& t) {
    return Json{{"u", t.u}, {"p", t.p}, {"method", t.exact ? "exact" : "asymptotic"}, {"ties", t.ties}};
  });
  j["effect"] = answerJson(row.effect, [](const Superiority& e) {
    return Json{{"cliffs_delta", e.delta}, {"a", e.a}};
  });
  j["shift"] = answerJson(row.shift, [](double shift) { return Json{{"hodges_lehmann", shift}}; });
  j["shift_interval"] = answerJson(row.shiftInterval, [](const ShiftInterval& i) {
    return Json{{"lower", i.lower},
                {"upper", i.upper},
                {"level_asked", 0.95},
                {"level_attained", i.attained},
                {"method", nameOf(i.method)}};
  });
  j["published"] = row.publishedExpert
                       ? Json{{"expert_mean", *row.publishedExpert}, {"novice_mean", *row.publishedNovice}}
                       : Json(nullptr);
  return j;
}

}  // namespace

std::string studyJson(const Study& study) {
  Json j{{"heading", study.heading},
         {"synthetic", study.synthetic},
         {"watermark", study.synthetic ? "SYNTHETIC" : ""},
         {"groups", {study.groups[0], study.groups[1]}},
         {"participants", {study.participants[0], study.participants[1]}},
         {"attempts", {study.attempts[0], study.attempts[1]}},
         {"attempts_rule", "mean over a participant's attempts"},
         {"quantile_type", 7},
         {"comparability_keys", study.keys},
         {"flow", {{"recruited", study.recruited}, {"analysed", study.analysed}}},
         {"remarks", study.remarks},
         {"published_source", study.publishedSource}};
  Json excluded = Json::array();
  for (const FlowRow& row : study.flow) excluded.push_back({{"reason", row.reason}, {"attempts", row.attempts}});
  j["flow"]["excluded"] = excluded;
  j["rows"] = Json::array();
  for (const StudyRow& row : study.rows) j["rows"].push_back(rowJson(study, row));
  return j.dump(2, ' ', false, Json::error_handler_t::replace);
}

}  // namespace calot::analytics
