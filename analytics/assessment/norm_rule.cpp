// SPDX-License-Identifier: GPL-3.0-or-later

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <set>

#include "analytics/assessment/grade.h"
#include "analytics/assessment/norm.h"
#include "analytics/checkpoints/checkpoint.h"
#include "analytics/cohort/cohort_database.h"
#include "analytics/report/table_study.h"
#include "recorder/base/counted.h"
#include "recorder/base/errors.h"
#include "recorder/base/text_words.h"

namespace calot::analytics {
namespace {

/// Events that harm the patient.
constexpr std::array<std::string_view, 4> harms{"critical-view", "clip-errors", "organ-perforations", "organ-burned"};
/// How long it took, and how far the tips went.
constexpr std::array<std::string_view, 2> efforts{"elapsed-time", "path-length"};

/// Stored as the reason for which there is no interval.
constexpr const char* fixedMark = "no interval: fixed by ";

template <class List>
bool holds(const List& list, std::string_view checkpoint) {
  return std::find(list.begin(), list.end(), checkpoint) != list.end();
}

}  // namespace

FixedCut parseFixedCut(const std::string& text) {
  FixedCut cut;
  const std::size_t at = text.find_first_of("<>");
  std::string fault;
  if (at != std::string::npos && at > 0 && at + 2 < text.size() && text[at + 1] == '=') {
    cut.figure = text.substr(0, at);
    while (!cut.figure.empty() && cut.figure.back() == ' ') cut.figure.pop_back();
    cut.atLeast = text[at] == '>';
    std::string number = text.substr(at + 2);
    number.erase(0, number.find_first_not_of(' '));
    cut.value = recorder::readFiniteNumber(number, fault);
    if (fault.empty() && !cut.figure.empty()) return cut;
  }
  throw Error(ErrorKind::invalid,
              fmt::format("norm: fixed mark {}: a figure, <= or >=, and a number are expected", recorder::shown(text)));
}

bool countsByDefault(std::string_view checkpoint) { return holds(countingCheckpoints(), checkpoint); }

const std::vector<std::string_view>& countingCheckpoints() {
  static const std::vector<std::string_view> all = [] {
    std::vector<std::string_view> joined(harms.begin(), harms.end());
    joined.insert(joined.end(), efforts.begin(), efforts.end());
    return joined;
  }();
  return all;
}

void setFixedCuts(Norm& norm, const std::vector<FixedCut>& fixed) {
  for (const FixedCut& cut : fixed) {
    bool found = false;
    for (NormCheckpoint& mark : norm.checkpoints) {
      if (!isCalled(cut.figure, mark.checkpoint, mark.subject)) continue;
      found = true;
      if (cut.atLeast != (mark.direction == Direction::higher))
        throw Error(ErrorKind::invalid, fmt::format("norm: fixed mark of {}: of it {} is better",
                                                    recorder::shown(cut.figure), cut.atLeast ? "less" : "more"));
      const CheckpointDefinition* definition = definitionOf(mark);
      mark.cut = definition == nullptr ? cut.value : cut.value / definition->displayFactor;
      mark.lower.reset();
      mark.upper.reset();
      mark.logScale = false;
      mark.reason = fixedMark + norm.by;
      mark.inRule = true;
    }
    if (!found)
      throw Error(ErrorKind::invalid,
                  fmt::format("norm: the members have no figure \"{}\" that judges", recorder::shown(cut.figure)),
                  {Remedy::nameCheckpoints});
  }
}

bool isFixed(const NormCheckpoint& mark) { return mark.reason.rfind(fixedMark, 0) == 0; }

bool keepsRule(const Norm& norm, const std::vector<bool>& passed) {
  std::size_t count = 0;
  for (std::size_t i = 0; i < norm.checkpoints.size(); ++i) {
    if (!norm.checkpoints[i].inRule) continue;
    if (!passed[i] && isFixed(norm.checkpoints[i])) return false;
    count += passed[i] ? 1 : 0;
  }
  return count >= neededPasses(norm);
}

std::string uncountedWarning(const Norm& norm) {
  std::string names, reasons;
  for (const NormCheckpoint& mark : norm.checkpoints) {
    if (mark.inRule || mark.cut || !holds(harms, mark.checkpoint)) continue;
    names += (names.empty() ? "" : ", ") + figureName(mark.checkpoint, mark.subject);
    if (reasons.find(mark.reason) == std::string::npos) reasons += (reasons.empty() ? "" : "; ") + mark.reason;
  }
  if (names.empty()) return {};
  return fmt::format("Warning: harm that the rule does not count, for lack of a pass mark ({}): {}.", reasons, names);
}

AngoffJudgement readAngoff(const CsvTable& table) {
  constexpr const char* judgeColumn = "judge";
  const std::size_t judge = table.column(judgeColumn);
  AngoffJudgement result;
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    if (c != judge) result.items.push_back(table.columns[c]);
  }
  result.probabilities.raters = result.items.size();
  for (const CsvRow& row : table.rows) {
    const std::string& name = row.cells[judge];
    if (name.empty()) failAt(table, row.line, judgeColumn, "is empty");
    if (std::find(result.judges.begin(), result.judges.end(), name) != result.judges.end())
      failAt(table, row.line, judgeColumn, fmt::format("\"{}\" is named twice", recorder::shown(name)));
    result.judges.push_back(name);
    ++result.probabilities.subjects;
    for (std::size_t c = 0; c < table.columns.size(); ++c) {
      if (c == judge) continue;
      std::string fault;
      const double p = recorder::readFiniteNumber(table.withPoint(row.cells[c]), fault);
      if (!fault.empty()) failAt(table, row.line, table.columns[c], fault);
      if (p < 0.0 || p > 1.0)
        failAt(table, row.line, table.columns[c], fmt::format("{} is not a probability from 0 to 1", p));
      result.probabilities.values.push_back(p);
    }
  }
  const Expected<AngoffCut> cut = angoffCut(result.probabilities);
  if (!cut) throw Error(ErrorKind::refused, Where{table.path}, cut.reason());
  result.cut = *cut;
  constexpr double rounding = 1e-9;  // sums of probabilities miss whole numbers by their last bits
  result.needed = static_cast<std::size_t>(std::ceil(cut->cut - rounding));
  return result;
}

NormSource readNormSource(const CohortDatabase& cohort, const std::vector<std::string>& only,
                          const NormProgress& progress) {
  NormSource source{cohort.listAttempts(), {}, cohort.ratings()};
  const std::set<std::string> wanted(only.begin(), only.end());
  if (!only.empty()) std::erase_if(source.attempts, [&](const AttemptRow& a) { return wanted.count(a.uuid) == 0; });
  std::string attempt;
  std::size_t read = 0;
  cohort.eachValue({}, [&](const AttemptValue& value) {
    if (attempt != value.attempt) {
      attempt = value.attempt;
      if (progress)
        progress(std::min(1.0, static_cast<double>(++read) / static_cast<double>(source.attempts.size() + 1)),
                 "reading values");
    }
    if (only.empty() || wanted.count(value.attempt) > 0) source.values.push_back(value);
  });
  // Those of external metrics come behind all others.
  std::stable_sort(source.values.begin(), source.values.end(),
                   [](const AttemptValue& x, const AttemptValue& y) { return x.attempt < y.attempt; });
  return source;
}

Norm createNorm(const std::string& database, NormRequest request, const std::vector<std::string>& only,
                const NormProgress& progress) {
  const auto tell = [&](double share, const char* doing) {
    if (progress) progress(share, doing);
  };
  tell(0.0, "checking the cohort");
  CohortDatabase cohort(database, CohortDatabase::Access::write);
  refuseUnsound(database);
  if (request.who.protocol) {
    for (const Participant& p : cohort.participants()) request.who.protocol->experience[p.pseudonym] = p.experience;
  }
  const NormSource source =
      readNormSource(cohort, only, [&](double share, const char* doing) { tell(0.5 * share, doing); });
  tell(0.5, "finding pass marks");
  const Norm norm = makeNorm(source.attempts, source.values, source.ratings, request, database);
  tell(1.0, "storing");
  return cohort.norm(norm.name, cohort.storeNorm(norm));
}

std::vector<std::string> normSummary(const Norm& norm) {
  return {fmt::format("Norm {} version {}, made on {} by {}: {}, judged by {}; {}", norm.name, norm.version,
                      norm.createdUtc, norm.by, recorder::counted(norm.members.size(), "member"), norm.judgedBy,
                      norm.comparabilityKey),
          "Rule: " + ruleText(norm), useOf(norm)};
}

std::vector<std::string> normWarnings(const Norm& norm) {
  std::vector<std::string> warnings{ownFailureWarning(norm), uncountedWarning(norm), passMarkWarning(norm)};
  std::erase(warnings, std::string());
  return warnings;
}

}  // namespace calot::analytics
