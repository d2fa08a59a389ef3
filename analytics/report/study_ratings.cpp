// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/report/study.h"

namespace calot::analytics {

void addRatings(Study& study, const AssessmentDatabase& database) {
  study.ratings = reportForms(database, study.groupOf, {study.groups[0], study.groups[1]}, study.attemptOf);
}

}  // namespace calot::analytics
