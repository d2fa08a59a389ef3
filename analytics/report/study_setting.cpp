// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/report/study_setting.h"

#include <algorithm>
#include <nlohmann/json.hpp>

#include "analytics/cohort/embedded.h"

namespace calot::analytics {

void addToSetting(StudySetting& setting, const AttemptRow& attempt) {
  const auto at = std::lower_bound(setting.tasks.begin(), setting.tasks.end(), attempt.scene);
  if (at == setting.tasks.end() || *at != attempt.scene) setting.tasks.insert(at, attempt.scene);
  const std::string& start = attempt.startUtc;
  if (start.empty()) return;
  if (setting.firstStartUtc.empty() || start < setting.firstStartUtc) setting.firstStartUtc = start;
  if (start > setting.lastStartUtc) setting.lastStartUtc = start;
}

void addPublished(Study& study) {
  const nlohmann::json table = nlohmann::json::parse(publishedTable2());
  const bool sameTask = study.setting.tasks == std::vector{table.at("task").get<std::string>()};
  if (sameTask) study.publishedSource = table.at("source").get<std::string>();
  for (const auto& published : table.at("rows")) {
    for (StudyRow& row : study.rows) {
      if (row.checkpoint != published.at("matches").get<std::string>() ||
          row.subject != published.at("subject").get<std::string>())
        continue;
      row.leading = true;
      if (!sameTask || row.unit != published.at("unit").get<std::string>()) continue;
      row.publishedExpert = published.at("expert").get<double>();
      row.publishedNovice = published.at("novice").get<double>();
    }
  }
}

}  // namespace calot::analytics
