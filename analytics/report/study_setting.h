// SPDX-License-Identifier: GPL-3.0-or-later
// Where and when the attempts of a study were made, and what was published of the same task.
#pragma once

#include <string>

#include "analytics/report/study.h"

namespace calot::analytics {

/// Adds an analysed attempt's task and start.
void addToSetting(StudySetting& setting, const AttemptRow& attempt);

/// Puts the figures of the paper's Table 2 into the study's first table (StudyRow::leading) and, where the study's one
/// task is the paper's, the published means beside them.
void addPublished(Study& study);

}  // namespace calot::analytics
