// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>
#include <vector>

#include "analytics/report/study_output.h"
#include "analytics/statistics/descriptive.h"
#include "recorder/base/csv_writer.h"
#include "recorder/base/errors.h"
#include "recorder/base/text_output.h"

namespace calot::analytics {
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
  return fmt::format(",{},{},{},{},{},{},{}", a.difference, a.interval.lower, a.interval.upper, a.p,
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
