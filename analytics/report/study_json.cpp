// SPDX-License-Identifier: GPL-3.0-or-later
#include <nlohmann/json.hpp>

#include "analytics/report/ratings_json.h"
#include "analytics/report/study_coverage.h"
#include "analytics/report/study_output.h"
#include "analytics/report/study_tables.h"

namespace calot::analytics {
namespace {

using Json = nlohmann::ordered_json;

Json numberOrNull(const std::optional<double>& value) { return value ? Json(*value) : Json(nullptr); }

Json missingJson(const GroupSummary& s) {
  Json kinds = Json::object();
  for (std::size_t kind = 0; kind < s.missingOf.size(); ++kind) {
    if (s.missingOf[kind] > 0) kinds[nameOf(static_cast<Availability>(kind))] = s.missingOf[kind];
  }
  return kinds;
}

Json groupJson(const std::string& name, const GroupSummary& s) {
  return {{"group", name},
          {"n", s.n},
          {"missing", s.missing},
          {"missing_reason", s.missingReason},
          {"missing_kinds", missingJson(s)},
          {"partial", s.partial},
          {"mean", numberOrNull(s.mean)},
          {"sd", numberOrNull(s.standardDeviation)},
          {"median", numberOrNull(s.median)},
          {"lower_quartile", numberOrNull(s.lowerQuartile)},
          {"upper_quartile", numberOrNull(s.upperQuartile)}};
}

template <class T, class Write>
Json answerJson(const Expected<T>& answer, Write write) {
  if (!answer) return {{"value", nullptr}, {"reason", answer.reason()}};
  return write(*answer);
}

Json intervalJson(const Interval& i) {
  return {{"lower", i.lower}, {"upper", i.upper}, {"level", i.level}, {"method", i.method}};
}

Json hypothesisJson(const Study& study, const StudyRow& row) {
  if (!row.hypothesis) return nullptr;
  return {{"better", study.better},
          {"expects", row.hypothesis == Hypothesis::firstLarger ? "first larger" : "first smaller"},
          {"as_expected", row.asHypothesised ? Json(*row.asHypothesised) : Json(nullptr)}};
}

Json areaJson(const StudyRow& row) {
  return answerJson(row.area, [&](const SuperiorityEstimate& e) {
    return Json{{"of", row.hypothesis ? "the hypothesis" : "the first group's values being larger"},
                {"a", e.value.a},
                {"interval", intervalJson(e.a)},
                {"cliffs_delta", e.value.delta},
                {"delta_interval", intervalJson(e.delta)}};
  });
}

Json adjustedJson(const BaselineAdjustment& adjusted) {
  Json j = answerJson(adjusted.analysis, [&](const CovarianceAnalysis& a) {
    return Json{{"difference", a.difference},
                {"interval", intervalJson(a.interval)},
                {"error", a.error},
                {"t", a.t},
                {"df", a.df},
                {"p", a.p},
                {"p_holm", numberOrNull(adjusted.holm)},
                {"slope", a.slope},
                {"one_slope", answerJson(a.sameSlope, [](double p) {
                   return Json{{"p", p}};
                 })}};
  });
  j["n"] = adjusted.n;
  j["without_baseline"] = adjusted.withoutBaseline;
  return j;
}

Json protocolJson(const Study& study) {
  if (!study.protocol) return nullptr;
  const StudyProtocol& p = *study.protocol;
  Json versions = Json::array();
  for (const ProtocolVersion& v : p.versions) {
    versions.push_back({{"version", v.version},
                        {"sha256", v.sha256},
                        {"registered_utc", v.registeredUtc},
                        {"by", v.by},
                        {"changed", v.changed}});
  }
  Json lock = nullptr;
  if (p.lock) lock = {{"locked_utc", p.lock->lockedUtc}, {"by", p.lock->by}, {"changed", p.lock->changed}};
  return {{"name", p.name},
          {"version", p.version},
          {"title", p.title},
          {"sha256", p.sha256},
          {"registered_utc", p.registeredUtc},
          {"first_attempt_utc", p.firstAttemptUtc},
          {"why_exploratory", p.whyExploratory},
          {"level", p.level},
          {"missing", p.missing == MissingRule::worstRank ? "worst-rank" : "complete-cases"},
          {"populations", {p.populations[0], p.populations[1]}},
          {"versions", versions},
          {"deviations", p.deviations},
          {"masked", p.masked},
          {"lock", lock}};
}

Json simulationJson(const StudyRow& row) {
  if (!row.simulation) return nullptr;
  const SimulationRange& s = *row.simulation;
  Json j{{"values", s.values}, {"with_interval", s.known}, {"half_width", s.halfWidth}};
  j["first_larger"] = s.area ? Json{{"lower", s.area->first}, {"upper", s.area->second}} : Json(nullptr);
  j["decided"] = s.area ? Json(s.decided()) : Json(nullptr);
  return j;
}

Json coverageJson(const CoverageRow& row) {
  Json j{{"subject", row.subject}, {"shares", row.share}, {"too_little", row.below}};
  j["mann_whitney"] = answerJson(row.test, [](const MannWhitney& t) {
    return Json{{"u", t.u}, {"p", t.p}, {"method", t.exact ? "exact" : "asymptotic"}};
  });
  j["differs"] = coverageDiffers(row);
  return j;
}

Json rowJson(const Study& study, const StudyRow& row) {
  Json j{{"checkpoint", row.checkpoint},       {"subject", row.subject},   {"title", row.title},    {"unit", row.unit},
         {"direction", nameOf(row.direction)}, {"versions", row.versions}, {"origins", row.origins}};
  j["groups"] = Json::array({groupJson(study.groups[0], row.group[0]), groupJson(study.groups[1], row.group[1])});
  j["sampled"] = row.sampled;
  if (!row.source.empty()) j["source_sha256"] = row.source;
  j["role"] = nameOf(row.role);
  j["not_outcome_because"] = row.notOutcome;
  j["leading"] = row.leading;
  j["attainable_p"] = numberOrNull(row.attainableP);
  j["supported"] = row.supported ? Json(*row.supported) : Json(nullptr);
  j["worst_ranked"] = row.worstRanked;
  j["hypothesis"] = hypothesisJson(study, row);
  j["mann_whitney"] = answerJson(row.test, [&](const MannWhitney& t) {
    return Json{{"u", t.u},
                {"p", t.p},
                {"p_holm", numberOrNull(row.holm)},
                {"p_benjamini_hochberg", numberOrNull(row.benjaminiHochberg)},
                {"method", t.exact ? "exact" : "asymptotic"},
                {"ties", t.ties},
                {"smallest_p", t.smallestP}};
  });
  j["effect"] = answerJson(row.effect, [](const Superiority& e) {
    return Json{{"cliffs_delta", e.delta}, {"a", e.a}};
  });
  j["area"] = areaJson(row);
  j["shift"] = answerJson(row.shift, [](double shift) { return Json{{"hodges_lehmann", shift}}; });
  j["shift_interval"] = answerJson(row.shiftInterval, [](const ShiftInterval& i) {
    return Json{{"lower", i.lower},
                {"upper", i.upper},
                {"level_asked", 0.95},
                {"level_attained", i.attained},
                {"method", nameOf(i.method)}};
  });
  j["hedges"] = answerJson(row.hedges, [](const HedgesG& h) {
    return Json{{"g", h.g}, {"d", h.d}, {"j", h.j}, {"interval", answerJson(h.interval, [](const Interval& i) {
                                                       return intervalJson(i);
                                                     })}};
  });
  j["spearman_with_duration"] = answerJson(row.withDuration, [&](const Spearman& s) {
    return Json{{"rho", s.rho},
                {"p", s.p},
                {"n", row.withDurationPairs},
                {"method", s.exact ? "exact" : "Student's t"},
                {"ties", s.ties}};
  });
  j["at_one_baseline"] = row.adjusted ? adjustedJson(*row.adjusted) : Json(nullptr);
  j["coverage_warnings"] = row.coverageWarnings;
  j["simulation"] = simulationJson(row);
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
         {"source", study.source},
         {"file", study.where},
         {"better", study.better},
         {"counted", study.counted},
         {"attempts_rule", study.attemptRule},
         {"family", study.family},
         {"quantile_type", 7},
         {"comparability_keys", study.keys},
         {"tasks", study.setting.tasks},
         {"first_start_utc", study.setting.firstStartUtc},
         {"last_start_utc", study.setting.lastStartUtc},
         {"cohort_name", study.cohort},
         {"flow", {{"recruited", study.recruited}, {"analysed", study.analysed}}},
         {"remarks", study.remarks},
         {"protocol", protocolJson(study)},
         {"methods", studyMethods(study)},
         {"published_source", study.publishedSource}};
  Json excluded = Json::array();
  for (const FlowRow& row : study.flow) excluded.push_back({{"reason", row.reason}, {"attempts", row.attempts}});
  j["flow"]["excluded"] = excluded;
  j["absent"] = Json::array();
  for (const AbsentRow& a : study.absent)
    j["absent"].push_back({{"participant", a.participant}, {"group", a.group}, {"occasion", a.occasion}});
  j["ratings"] = ratingsJson(study.ratings);
  j["coverage"] = Json::array();
  for (const CoverageRow& row : study.coverage) j["coverage"].push_back(coverageJson(row));
  j["rows"] = Json::array();
  for (const StudyRow& row : study.rows) j["rows"].push_back(rowJson(study, row));
  return j.dump(2, ' ', false, Json::error_handler_t::replace);
}

}  // namespace calot::analytics
