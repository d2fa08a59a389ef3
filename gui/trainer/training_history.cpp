// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/trainer/training_history.h"

#include <algorithm>
#include <system_error>

#include "gui/attempt/figure_standing.h"
#include "gui/attempt/words.h"
#include "gui/trainer/trainer_texts.h"

namespace calot::gui {

using Access = analytics::CohortDatabase::Access;

std::vector<PastAttempt> historyIn(const std::filesystem::path& cohort, const std::string& participant) {
  std::error_code ignored;
  if (participant.empty() || cohort.empty() || !std::filesystem::exists(cohort, ignored)) return {};
  const analytics::CohortDatabase database(cohort.string(), Access::read);
  const std::vector<analytics::Norm> norms = analytics::AssessmentDatabase(cohort.string(), Access::read).norms();
  std::vector<PastAttempt> history;
  for (const analytics::AttemptRow& row : database.listAttempts()) {
    if (row.participant != participant || row.synthetic) continue;
    PastAttempt past{row.scene, row.startUtc, static_cast<double>(row.steps) * row.stepSeconds,
                     row.mode,  row.outcome,  !row.parent.empty(),
                     {},        false};
    if (const auto fitting = normsFor(row, norms); !fitting.empty()) {
      const AttemptStanding standing = standingOf(row, database.values(row.uuid), *fitting.front());
      if (standing.judged) past.verdict = QString::fromStdString(standing.verdict);
      past.passed = standing.judged && standing.grade && standing.grade->passed;
    }
    history.push_back(std::move(past));
  }
  std::reverse(history.begin(), history.end());
  return history;
}

QString progressText(const std::vector<PastAttempt>& history, const std::string& scene) {
  int attempts = 0, completed = 0;
  bool passed = false;
  for (const PastAttempt& past : history) {
    if (past.scene != scene || past.branch) continue;
    ++attempts;
    completed += past.outcome == recorder::Outcome::completed ? 1 : 0;
    passed = passed || past.passed;
  }
  if (attempts == 0) return "Not tried yet";
  QString text = attempts == 1 ? QString("1 attempt") : QString("%1 attempts").arg(attempts);
  text += passed ? QString(", passed by the norm") : QString(", %1 completed").arg(completed);
  return (passed || completed > 0 ? QString::fromUtf8("✓ ") : QString()) + text;
}

QString pastText(const PastAttempt& attempt) {
  QString text = QString("%1, %2%3: %4 after %5")
                     .arg(startText(attempt.startUtc), modeText(attempt.mode), attempt.branch ? ", a branch" : "",
                          outcomeText(attempt.outcome), clockText(attempt.seconds));
  return attempt.verdict.isEmpty() ? text : text + ". " + attempt.verdict;
}

}  // namespace calot::gui
