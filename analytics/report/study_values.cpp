// SPDX-License-Identifier: GPL-3.0-or-later
// A study as JSON and as CSV files.

#include <fmt/format.h>
#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <system_error>
#include <utility>
#include <vector>

#include "analytics/report/rating_tables.h"
#include "analytics/report/study_coverage.h"
#include "analytics/report/study_output.h"
#include "analytics/report/study_tables.h"
#include "analytics/statistics/descriptive.h"
#include "recorder/base/csv_writer.h"
#include "recorder/base/errors.h"
#include "recorder/base/text_output.h"

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
    return Json{{"difference", a.estimate},
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

namespace {

std::string numberCell(const std::optional<double>& value) { return value ? fmt::format("{}", *value) : ""; }

std::string watermark(const Study& study) { return study.synthetic ? "SYNTHETIC" : ""; }

std::string hypothesisCells(const StudyRow& row) {
  const char* expects = !row.hypothesis                             ? ""
                        : row.hypothesis == Hypothesis::firstLarger ? "first larger"
                                                                    : "first smaller";
  const char* found = !row.asHypothesised ? "" : *row.asHypothesised ? "yes" : "no";
  return fmt::format(",{},{}", expects, found);
}

std::string effectCells(const StudyRow& row) {
  std::string text =
      row.area ? fmt::format(",{},{},{}", row.area->value.a, row.area->a.lower, row.area->a.upper) : ",,,";
  text += fmt::format(",{}", numberCell(row.holm));
  text += row.hedges ? fmt::format(",{}", row.hedges->g) : ",";
  text += row.hedges && row.hedges->interval
              ? fmt::format(",{},{}", row.hedges->interval->lower, row.hedges->interval->upper)
              : ",,";
  text += row.withDuration ? fmt::format(",{},{},{}", row.withDuration->rho, row.withDuration->p, row.withDurationPairs)
                           : ",,,";
  return text + fmt::format(",{},{}", row.group[0].partial, row.group[1].partial);
}

std::string baselineCells(const StudyRow& row) {
  if (!row.adjusted || !row.adjusted->analysis) return ",,,,,,,";
  const CovarianceAnalysis& a = *row.adjusted->analysis;
  return fmt::format(",{},{},{},{},{},{},{}", a.estimate, a.interval.lower, a.interval.upper, a.p,
                     numberCell(row.adjusted->holm), a.slope,
                     numberCell(a.sameSlope ? std::optional(*a.sameSlope) : std::nullopt));
}

std::string simulationCells(const StudyRow& row) {
  if (!row.simulation) return ",,,,";
  const SimulationRange& s = *row.simulation;
  if (!s.area) return fmt::format(",{},,,", s.halfWidth);
  return fmt::format(",{},{},{},{}", s.halfWidth, s.area->first, s.area->second, s.decided() ? "yes" : "no");
}

std::string summaryTable(const Study& study) {
  std::string text =
      "checkpoint,subject,unit,direction,group_a,n_a,missing_a,mean_a,sd_a,q1_a,median_a,q3_a,group_b,n_b,missing_b,"
      "mean_b,sd_b,"
      "q1_b,median_b,q3_b,shift,shift_lower,shift_upper,shift_level,u,p,p_method,cliffs_delta,a,no_test_because,"
      "published_expert_mean,published_novice_mean,study,watermark,hypothesis,as_expected,area,area_lower,area_upper,"
      "p_holm,g,g_lower,g_upper,rho_duration,rho_p,rho_n,partial_a,partial_b,baseline_difference,baseline_lower,"
      "baseline_upper,baseline_p,baseline_p_holm,baseline_slope,baseline_slope_p,coverage_warnings,role,p_benjamini_"
      "hochberg,supported,"
      "worst_ranked_a,worst_ranked_b,simulation_half_width,first_larger_lower,first_larger_upper,simulation_decided,"
      "attainable_p,"
      "not_outcome_because,source_sha256\n";
  for (const StudyRow& row : study.rows) {
    text += fmt::format("{},{},{},{}", csvCell(row.checkpoint), csvCell(row.subject), csvCell(row.unit),
                        nameOf(row.direction));
    for (std::size_t g = 0; g < 2; ++g) {
      const GroupSummary& s = row.group[g];
      text += fmt::format(",{},{},{},{},{},{},{},{}", csvCell(study.groups[g]), s.n, s.missing, numberCell(s.mean),
                          numberCell(s.standardDeviation), numberCell(s.lowerQuartile), numberCell(s.median),
                          numberCell(s.upperQuartile));
    }
    text += row.shift ? fmt::format(",{}", *row.shift) : ",";
    text += row.shiftInterval ? fmt::format(",{},{},{}", row.shiftInterval->lower, row.shiftInterval->upper,
                                            row.shiftInterval->attained)
                              : ",,,";
    text +=
        row.test ? fmt::format(",{},{},{}", row.test->u, row.test->p, row.test->exact ? "exact" : "asymptotic") : ",,,";
    text += row.effect ? fmt::format(",{},{}", row.effect->delta, row.effect->a) : ",,";
    text += fmt::format(",{},{},{},{},{}", csvCell(row.test.reason()), numberCell(row.publishedExpert),
                        numberCell(row.publishedNovice), study.heading, watermark(study));
    text += hypothesisCells(row) + effectCells(row) + baselineCells(row);
    std::string warnings;
    for (const std::string& w : row.coverageWarnings) warnings += (warnings.empty() ? "" : "; ") + w;
    text += fmt::format(",{},{},{},{},{},{}", csvCell(warnings), nameOf(row.role), numberCell(row.benjaminiHochberg),
                        !row.supported   ? ""
                        : *row.supported ? "yes"
                                         : "no",
                        row.worstRanked[0], row.worstRanked[1]);
    text += simulationCells(row) +
            fmt::format(",{},{},{}\n", numberCell(row.attainableP), csvCell(row.notOutcome), row.source);
  }
  return text;
}

std::string valuesTable(const Study& study) {
  std::string text = "checkpoint,subject,unit,group,participant,value,watermark\n";
  for (const StudyRow& row : study.rows) {
    for (std::size_t g = 0; g < 2; ++g) {
      for (std::size_t i = 0; i < row.values[g].size(); ++i) {
        text +=
            fmt::format("{},{},{},{},{},{},{}\n", csvCell(row.checkpoint), csvCell(row.subject), csvCell(row.unit),
                        csvCell(study.groups[g]), csvCell(row.participants[g][i]), row.values[g][i], watermark(study));
      }
    }
  }
  return text;
}

std::string flowFile(const Study& study) {
  std::string text = fmt::format("stage,{}\nin the {},{}\n", study.counted, study.source, study.recruited);
  for (const FlowRow& row : study.flow)
    text += fmt::format("{},{}\n", csvCell("left out: " + row.reason), row.attempts);
  return text + fmt::format("analysed,{}\n", study.analysed);
}

std::string coverageFile(const Study& study) {
  std::string text = "subject,group,n,median,lowest,too_little,p,watermark\n";
  for (const CoverageRow& row : study.coverage) {
    for (std::size_t g = 0; g < 2; ++g) {
      const std::vector<double>& shares = row.share[g];
      text += fmt::format("{},{},{},{},{},{},{},{}\n", csvCell(row.subject), csvCell(study.groups[g]), shares.size(),
                          shares.empty() ? "" : fmt::format("{}", *median(shares)),
                          shares.empty() ? "" : fmt::format("{}", *std::min_element(shares.begin(), shares.end())),
                          row.below[g], row.test ? fmt::format("{}", row.test->p) : "", watermark(study));
    }
  }
  return text;
}

std::string ratingsFile(const Study& study) {
  std::string text =
      "form,version,item,group,primary,n,blank,q1,median,q3,mean,published_mean,icc_2_1,icc_2_1_lower,icc_2_1_upper,"
      "watermark\n";
  for (const FormReport& report : study.ratings) {
    for (const ItemReport& item : report.items) {
      const auto agreed = std::find_if(report.agreement.begin(), report.agreement.end(),
                                       [&](const Agreement& a) { return a.figure == item.key; });
      std::string icc = ",,";
      if (agreed != report.agreement.end() && agreed->single) {
        const auto& interval = agreed->single->interval;
        icc = fmt::format("{},{}", agreed->single->value,
                          interval ? fmt::format("{},{}", interval->lower, interval->upper) : ",");
      }
      for (std::size_t g = 0; g < report.groups.size(); ++g) {
        const ItemSummary& s = item.groups[g];
        text += fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{},{}\n", csvCell(report.name), report.version,
                            csvCell(item.key), csvCell(report.groups[g]),
                            !item.primaryGroup.empty() && item.primaryGroup == report.groups[g] ? "yes" : "", s.n,
                            s.blank, numberCell(s.lowerQuartile), numberCell(s.median), numberCell(s.upperQuartile),
                            numberCell(s.mean), numberCell(item.published[g]), icc, watermark(study));
      }
    }
  }
  return text;
}

}  // namespace

void writeStudyCsv(const Study& study, const std::string& folder, bool force) {
  const std::filesystem::path root(folder);
  std::error_code error;
  std::filesystem::create_directories(root, error);
  if (error || !std::filesystem::is_directory(root, error)) {
    throw Error(ErrorKind::failure, Where{folder}, "the folder can't be made");
  }
  std::vector<std::pair<const char*, std::string>> files{
      {"study.csv", summaryTable(study)}, {"values.csv", valuesTable(study)}, {"flow.csv", flowFile(study)}};
  if (!study.coverage.empty()) files.emplace_back("coverage.csv", coverageFile(study));
  if (!study.ratings.empty()) files.emplace_back("ratings.csv", ratingsFile(study));
  for (const auto& file : files) recorder::refuseOutput(root / file.first, force);
  for (const auto& file : files) recorder::writeText(root / file.first, file.second, force);
}

}  // namespace calot::analytics
