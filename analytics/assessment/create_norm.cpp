// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/assessment/norm.h"

#include <fmt/format.h>

#include <algorithm>
#include <set>
#include <utility>

#include "analytics/assessment/grade.h"
#include "analytics/cohort/cohort_database.h"

namespace calot::analytics {

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
  std::vector<AttemptRow> attempts = cohort.listAttempts();
  const std::set<std::string> wanted(only.begin(), only.end());
  if (!only.empty()) std::erase_if(attempts, [&](const AttemptRow& a) { return wanted.count(a.uuid) == 0; });
  std::vector<AttemptValue> values;
  std::string attempt;
  std::size_t read = 0;
  cohort.eachValue({}, [&](const AttemptValue& value) {
    if (attempt != value.attempt) {
      attempt = value.attempt;
      tell(0.5 * std::min(1.0, static_cast<double>(++read) / static_cast<double>(attempts.size() + 1)),
           "reading values");
    }
    if (only.empty() || wanted.count(value.attempt) > 0) values.push_back(value);
  });
  // Those of external metrics come behind all others.
  std::stable_sort(values.begin(), values.end(),
                   [](const AttemptValue& x, const AttemptValue& y) { return x.attempt < y.attempt; });
  tell(0.5, "finding pass marks");
  const Norm norm = makeNorm(attempts, values, cohort.ratings(), request, database);
  tell(1.0, "storing");
  return cohort.norm(norm.name, cohort.storeNorm(norm));
}

std::vector<std::string> normSummary(const Norm& norm) {
  return {fmt::format("Norm {} version {}, made on {} by {}: {} members, judged by {}; {}", norm.name, norm.version,
                      norm.createdUtc, norm.by, norm.members.size(), norm.judgedBy, norm.comparabilityKey),
          "Rule: " + ruleText(norm), useOf(norm)};
}

std::vector<std::string> normWarnings(const Norm& norm) {
  std::vector<std::string> warnings{ownFailureWarning(norm), uncountedWarning(norm), passMarkWarning(norm)};
  std::erase(warnings, std::string());
  return warnings;
}

}  // namespace calot::analytics
