// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/report/study_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <system_error>
#include <utility>
#include <vector>

#include "analytics/report/plots.h"
#include "analytics/report/ratings.h"
#include "analytics/report/study_people.h"
#include "analytics/report/study_rows.h"
#include "analytics/report/terminal_text.h"
#include "analytics/statistics/descriptive.h"
#include "recorder/base/errors.h"
#include "recorder/base/files.h"

namespace calot::analytics {
namespace {

ValueTree groupTree(const std::string& name, const GroupSummary& s) {
  ValueTree kinds = ValueTree::object();
  for (std::size_t kind = 0; kind < s.missingOf.size(); ++kind) {
    if (s.missingOf[kind] > 0) kinds[nameOf(static_cast<Availability>(kind))] = s.missingOf[kind];
  }
  return {{"group", name},
          {"n", s.n},
          {"missing", s.missing},
          {"missing_reason", s.missingReason},
          {"missing_kinds", kinds},
          {"partial", s.partial},
          {"mean", s.mean},
          {"sd", s.standardDeviation},
          {"median", s.median},
          {"lower_quartile", s.lowerQuartile},
          {"upper_quartile", s.upperQuartile}};
}

ValueTree hypothesisTree(const Study& study, const StudyRow& row) {
  if (!row.hypothesis) return nullptr;
  return {{"better", study.better},
          {"expects", row.hypothesis == Hypothesis::firstLarger ? "first larger" : "first smaller"},
          {"as_expected", row.asHypothesised}};
}

ValueTree areaTree(const StudyRow& row) {
  return treeOf(row.area, [&](const SuperiorityEstimate& e) {
    return ValueTree{{"of", row.hypothesis ? "the hypothesis" : "the first group's values being larger"},
                     {"a", e.value.a},
                     {"interval", e.a},
                     {"cliffs_delta", e.value.delta},
                     {"delta_interval", e.delta}};
  });
}

ValueTree adjustedTree(const std::optional<BaselineAdjustment>& adjusted) {
  if (!adjusted) return nullptr;
  ValueTree tree = treeOf(adjusted->analysis, [&](const CovarianceAnalysis& a) {
    return ValueTree{{"difference", a.estimate},
                     {"interval", a.interval},
                     {"error", a.error},
                     {"t", a.t},
                     {"df", a.df},
                     {"p", a.p},
                     {"p_holm", adjusted->holm},
                     {"slope", a.slope},
                     {"one_slope", treeOf(a.sameSlope, [](double p) {
                        return ValueTree{{"p", p}};
                      })}};
  });
  tree["n"] = adjusted->n;
  tree["without_baseline"] = adjusted->withoutBaseline;
  return tree;
}

ValueTree protocolTree(const std::optional<StudyProtocol>& protocol) {
  if (!protocol) return nullptr;
  const StudyProtocol& p = *protocol;
  ValueTree versions = ValueTree::array();
  for (const ProtocolVersion& v : p.versions) {
    versions.push_back({{"version", v.version},
                        {"sha256", v.sha256},
                        {"registered_utc", v.registeredUtc},
                        {"by", v.by},
                        {"changed", v.changed}});
  }
  ValueTree starts = ValueTree::object();
  for (const auto& [evidence, attempts] : p.starts) starts[evidence] = attempts;
  ValueTree lock = nullptr;
  if (p.lock) lock = {{"locked_utc", p.lock->lockedUtc}, {"by", p.lock->by}, {"changed", p.lock->changed}};
  return {{"name", p.name},
          {"version", p.version},
          {"title", p.title},
          {"sha256", p.sha256},
          {"registered_utc", p.registeredUtc},
          {"first_attempt_utc", p.firstAttemptUtc},
          {"starts", starts},
          {"why_exploratory", p.whyExploratory},
          {"level", p.level},
          {"missing", p.missing == MissingRule::worstRank ? "worst-rank" : "complete-cases"},
          {"populations", {p.populations[0].definition, p.populations[1].definition}},
          {"ethics", p.ethics},
          {"registry", p.registry},
          {"planned", {p.populations[0].planned, p.populations[1].planned}},
          {"sample_size_reason", p.sampleSizeReason},
          {"stopping_rule", p.stoppingRule},
          {"covariates", p.covariates},
          {"runs_before_lock", p.runsBeforeLock},
          {"versions", versions},
          {"deviations", p.deviations},
          {"masked", p.masked},
          {"lock", lock}};
}

ValueTree simulationTree(const StudyRow& row) {
  if (!row.simulation) return nullptr;
  const SimulationRange& s = *row.simulation;
  ValueTree tree{{"values", s.values}, {"with_interval", s.known}, {"half_width", s.halfWidth}};
  tree["first_larger"] = s.area ? ValueTree{{"lower", s.area->first}, {"upper", s.area->second}} : ValueTree(nullptr);
  tree["decided"] = s.area ? ValueTree(s.decided()) : ValueTree(nullptr);
  return tree;
}

ValueTree coverageTree(const CoverageRow& row) {
  ValueTree tree{{"subject", row.subject}, {"shares", row.share}, {"too_little", row.below}};
  tree["mann_whitney"] = treeOf(row.test, [](const MannWhitney& t) {
    return ValueTree{{"u", t.u}, {"p", t.p}, {"method", t.exact ? "exact" : "asymptotic"}};
  });
  tree["differs"] = coverageDiffers(row);
  tree["rates_hz"] = row.rate.values;
  tree["noises_m"] = row.noise.values;
  tree["trackers_p"] = ValueTree::array();
  for (const TrackerQuality* quality : {&row.rate, &row.noise})
    tree["trackers_p"].push_back(quality->test ? std::optional(quality->test->p) : std::nullopt);
  tree["refusal"] = row.refusal;
  return tree;
}

}  // namespace

ValueTree rowTree(const Study& study, const StudyRow& row) {
  ValueTree tree{{"checkpoint", row.checkpoint},
                 {"subject", row.subject},
                 {"title", row.title},
                 {"unit", row.unit},
                 {"direction", nameOf(row.direction)},
                 {"versions", row.versions},
                 {"origins", row.origins},
                 {"groups", {groupTree(study.groups[0], row.group[0]), groupTree(study.groups[1], row.group[1])}},
                 {"sampled", row.sampled}};
  if (!row.source.empty()) tree["source_sha256"] = row.source;
  tree.update({{"role", nameOf(row.role)},
               {"not_outcome_because", row.notOutcome},
               {"leading", row.leading},
               {"attainable_p", row.attainableP},
               {"supported", row.supported},
               {"claim", nameOf(row.claim)},
               {"margin", row.margin},
               {"margin_p", row.marginP ? ValueTree(*row.marginP) : ValueTree(nullptr)},
               {"worst_ranked", {row.worstRanked[0].size(), row.worstRanked[1].size()}},
               {"unfinished", row.unfinished},
               {"hypothesis", hypothesisTree(study, row)}});
  tree["mann_whitney"] = treeOf(row.test, [&](const MannWhitney& t) {
    return ValueTree{{"u", t.u},
                     {"p", t.p},
                     {"p_holm", row.holm},
                     {"p_benjamini_hochberg", row.benjaminiHochberg},
                     {"method", t.exact ? "exact" : "asymptotic"},
                     {"ties", t.ties},
                     {"smallest_p", t.smallestP}};
  });
  tree["brunner_munzel"] = treeOf(row.brunnerMunzel, [&](const BrunnerMunzel& b) {
    return ValueTree{{"statistic", b.statistic},
                     {"df", b.df},
                     {"p", b.p},
                     {"method", b.exact ? "permutation" : "Student's t"},
                     {"decides", study.unequalSpread}};
  });
  tree["effect"] = treeOf(row.effect, [](const Superiority& e) {
    return ValueTree{{"cliffs_delta", e.delta}, {"a", e.a}};
  });
  tree["area"] = areaTree(row);
  tree["shift"] = treeOf(row.shift, [](double shift) { return ValueTree{{"hodges_lehmann", shift}}; });
  tree["shift_interval"] = treeOf(row.shiftInterval, [](const ShiftInterval& i) {
    return ValueTree{{"lower", i.lower},
                     {"upper", i.upper},
                     {"level_asked", 0.95},
                     {"level_attained", i.attained},
                     {"method", nameOf(i.method)}};
  });
  tree["hedges"] = treeOf(row.hedges, [](const HedgesG& h) {
    return ValueTree{{"g", h.g}, {"d", h.d}, {"j", h.j}, {"interval", h.interval}};
  });
  tree["spearman_with_duration"] = treeOf(row.withDuration, [&](const Spearman& s) {
    return ValueTree{{"rho", s.rho},
                     {"p", s.p},
                     {"n", row.withDurationPairs},
                     {"method", s.exact ? "exact" : "Student's t"},
                     {"ties", s.ties}};
  });
  tree.update({{"at_one_baseline", adjustedTree(row.adjusted)},
               {"coverage_warnings", row.coverageWarnings},
               {"simulation", simulationTree(row)}});
  tree["published"] = nullptr;
  if (row.publishedExpert)
    tree["published"] = {{"expert_mean", *row.publishedExpert}, {"novice_mean", *row.publishedNovice}};
  return tree;
}

ValueTree studyTree(const Study& study) {
  ValueTree tree{{"heading", study.heading},
                 {"synthetic", study.synthetic},
                 {"watermark", study.synthetic ? "SYNTHETIC" : ""},
                 {"groups", study.groups},
                 {"participants", study.participants},
                 {"attempts", study.attempts},
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
                 {"flow",
                  {{"recruited", study.recruited},
                   {"recruited_participants", study.recruitedPeople},
                   {"analysed", study.analysed},
                   {"analysed_participants", study.analysedPeople}}},
                 {"simultaneous_intervals", false},
                 {"remarks", study.remarks},
                 {"protocol", protocolTree(study.protocol)},
                 {"methods", studyMethods(study)},
                 {"published_source", study.publishedSource}};
  ValueTree& excluded = tree["flow"]["excluded"] = ValueTree::array();
  for (const FlowRow& row : study.flow)
    excluded.push_back({{"reason", row.reason}, {"attempts", row.attempts}, {"participants", row.people}});
  const ReportTable table1 = peopleTable(study);
  ValueTree& people = tree["table_1"] = ValueTree::array();
  for (const auto& row : table1.rows) people.push_back({{"characteristic", row[0]}, {"groups", {row[1], row[2]}}});
  ValueTree& absent = tree["absent"] = ValueTree::array();
  for (const AbsentRow& a : study.absent)
    absent.push_back({{"participant", a.participant}, {"group", a.group}, {"occasion", a.occasion}});
  tree["ratings"] = ratingsTree(study.ratings);
  ValueTree& coverage = tree["coverage"] = ValueTree::array();
  for (const CoverageRow& row : study.coverage) coverage.push_back(coverageTree(row));
  ValueTree& rows = tree["rows"] = ValueTree::array();
  for (const StudyRow& row : study.rows) rows.push_back(rowTree(study, row));
  return tree;
}

namespace {

std::string summaryFile(const ValueTree& study) {
  ValueTree rows = study["rows"];
  for (ValueTree& row : rows) row.update({{"study", study["heading"]}, {"watermark", study["watermark"]}});
  return csvText(
      rows,
      "checkpoint subject unit direction group_a=/groups/0/group n_a=/groups/0/n missing_a=/groups/0/missing "
      "mean_a=/groups/0/mean sd_a=/groups/0/sd q1_a=/groups/0/lower_quartile median_a=/groups/0/median "
      "q3_a=/groups/0/upper_quartile group_b=/groups/1/group n_b=/groups/1/n missing_b=/groups/1/missing "
      "mean_b=/groups/1/mean sd_b=/groups/1/sd q1_b=/groups/1/lower_quartile median_b=/groups/1/median "
      "q3_b=/groups/1/upper_quartile shift=/shift/hodges_lehmann shift_lower=/shift_interval/lower "
      "shift_upper=/shift_interval/upper shift_level=/shift_interval/level_attained u=/mann_whitney/u "
      "p=/mann_whitney/p p_method=/mann_whitney/method cliffs_delta=/effect/cliffs_delta a=/effect/a "
      "no_test_because=/mann_whitney/reason published_expert_mean=/published/expert_mean "
      "published_novice_mean=/published/novice_mean study watermark hypothesis=/hypothesis/expects "
      "as_expected=/hypothesis/as_expected area=/area/a area_lower=/area/interval/lower "
      "area_upper=/area/interval/upper p_holm=/mann_whitney/p_holm g=/hedges/g g_lower=/hedges/interval/lower "
      "g_upper=/hedges/interval/upper rho_duration=/spearman_with_duration/rho rho_p=/spearman_with_duration/p "
      "rho_n=/spearman_with_duration/n partial_a=/groups/0/partial partial_b=/groups/1/partial "
      "baseline_difference=/at_one_baseline/difference baseline_lower=/at_one_baseline/interval/lower "
      "baseline_upper=/at_one_baseline/interval/upper baseline_p=/at_one_baseline/p "
      "baseline_p_holm=/at_one_baseline/p_holm baseline_slope=/at_one_baseline/slope "
      "baseline_slope_p=/at_one_baseline/one_slope/p coverage_warnings role "
      "p_benjamini_hochberg=/mann_whitney/p_benjamini_hochberg supported worst_ranked_a=/worst_ranked/0 "
      "worst_ranked_b=/worst_ranked/1 unfinished_a=/unfinished/0 unfinished_b=/unfinished/1 "
      "p_brunner_munzel=/brunner_munzel/p "
      "simulation_half_width=/simulation/half_width "
      "first_larger_lower=/simulation/first_larger/lower first_larger_upper=/simulation/first_larger/upper "
      "simulation_decided=/simulation/decided attainable_p not_outcome_because source_sha256");
}

std::string valuesFile(const Study& study, const ValueTree& watermark) {
  ValueTree rows = ValueTree::array();
  for (const StudyRow& row : study.rows) {
    for (std::size_t g = 0; g < 2; ++g) {
      for (std::size_t i = 0; i < row.values[g].size(); ++i) {
        rows.push_back({{"checkpoint", row.checkpoint},
                        {"subject", row.subject},
                        {"unit", row.unit},
                        {"group", study.groups[g]},
                        {"participant", row.participants[g][i]},
                        {"value", row.values[g][i]},
                        {"watermark", watermark}});
      }
    }
  }
  return csvText(rows, "checkpoint subject unit group participant value watermark");
}

std::string flowFile(const Study& study) {
  ValueTree rows = ValueTree::array();
  rows.push_back({{"stage", "in the " + study.source}, {"count", study.recruited}});
  for (const FlowRow& row : study.flow) rows.push_back({{"stage", "left out: " + row.reason}, {"count", row.attempts}});
  rows.push_back({{"stage", "analysed"}, {"count", study.analysed}});
  return csvText(rows, fmt::format("stage {}=/count", study.counted));
}

std::string coverageFile(const Study& study, const ValueTree& watermark) {
  ValueTree rows = ValueTree::array();
  const auto medianOf = [](const std::vector<double>& values) {
    return values.empty() ? std::nullopt : std::optional(*median(values));
  };
  for (const CoverageRow& row : study.coverage) {
    for (std::size_t g = 0; g < 2; ++g) {
      const std::vector<double>& shares = row.share[g];
      rows.push_back(
          {{"subject", row.subject},
           {"group", study.groups[g]},
           {"n", shares.size()},
           {"median", medianOf(shares)},
           {"lowest", shares.empty() ? std::nullopt : std::optional(*std::min_element(shares.begin(), shares.end()))},
           {"too_little", row.below[g]},
           {"p", row.test ? std::optional(row.test->p) : std::nullopt},
           {"watermark", watermark},
           {"rate", medianOf(row.rate.values[g])},
           {"noise", medianOf(row.noise.values[g])},
           {"refusal", row.refusal}});
    }
  }
  return csvText(rows, "subject group n median lowest too_little p watermark rate_hz=/rate noise_m=/noise refusal");
}

std::string ratingsFile(const ValueTree& study) {
  ValueTree rows = ValueTree::array();
  for (const ValueTree& form : study["ratings"]) {
    for (const ValueTree& item : form["items"]) {
      const ValueTree& agreement = form["agreement"];
      const auto agreed = std::find_if(agreement.begin(), agreement.end(),
                                       [&](const ValueTree& a) { return a["figure"] == item["item"]; });
      for (const ValueTree& group : item["groups"]) {
        ValueTree& row = rows.emplace_back(group);
        if (!row["primary"].get<bool>()) row["primary"] = nullptr;
        row.update({{"form", form["form"]},
                    {"version", form["version"]},
                    {"item", item["item"]},
                    {"watermark", study["watermark"]},
                    {"icc", agreed == agreement.end() ? ValueTree(nullptr) : (*agreed)["icc_2_1"]}});
      }
    }
  }
  return csvText(rows,
                 "form version item group primary n blank q1=/lower_quartile median q3=/upper_quartile mean "
                 "published_mean icc_2_1=/icc/value icc_2_1_lower=/icc/interval/lower "
                 "icc_2_1_upper=/icc/interval/upper watermark");
}

/// The analysed attempts; a masked study names none.
std::string attemptsFile(const Study& study, const ValueTree& watermark) {
  ValueTree rows = ValueTree::array();
  for (const auto& [uuid, of] : study.attemptOf) {
    rows.push_back({{"attempt", uuid},
                    {"participant", of.participant},
                    {"group", study.groupOf.at(uuid)},
                    {"start", of.startUtc},
                    {"watermark", watermark}});
  }
  return csvText(rows, "attempt participant group start watermark");
}

}  // namespace

void writeStudyCsv(const Study& study, const std::string& folder, bool force) {
  const std::filesystem::path root(folder);
  std::error_code error;
  std::filesystem::create_directories(root, error);
  if (error || !std::filesystem::is_directory(root, error)) {
    throw Error(ErrorKind::failure, Where{folder}, "the folder can't be made");
  }
  const ValueTree tree = studyTree(study);
  const ValueTree& watermark = tree["watermark"];
  std::vector<std::pair<const char*, std::string>> files{
      {"study.csv", summaryFile(tree)}, {"values.csv", valuesFile(study, watermark)}, {"flow.csv", flowFile(study)}};
  if (!study.attemptOf.empty() && !(study.protocol && study.protocol->masked))
    files.emplace_back("attempts.csv", attemptsFile(study, watermark));
  if (!study.coverage.empty()) files.emplace_back("coverage.csv", coverageFile(study, watermark));
  if (!study.ratings.empty()) files.emplace_back("ratings.csv", ratingsFile(tree));
  for (const auto& file : files) recorder::refuseOutput(root / file.first, force);
  for (const auto& file : files) recorder::writeText(root / file.first, file.second, force);
}

void printStudy(const Study& study, std::ostream& out, StudyDetail detail) {
  const auto print = [&](const std::vector<std::string>& lines) {
    for (const std::string& line : lines) printWrapped(line, out);
  };
  printReport({studyTitle(study), study.synthetic, studyHead(study), flowTable(study, study.groups)}, out, [&] {
    if (const ReportTable people = peopleTable(study); !people.rows.empty()) printTable(people, out);
    printTable(primaryTable(study), out);
    print(primaryNotes(study));
    if (detail == StudyDetail::first) return;
    out << '\n';
    for (const ReportTable& table : appendixTables(study)) printTable(table, out);
    print(appendixNotes(study));
    printWrapped(studyMethods(study), out);
  });
}

}  // namespace calot::analytics
