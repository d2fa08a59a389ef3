// SPDX-License-Identifier: GPL-3.0-or-later
// A study of performers, and what is read of one.
#pragma once

#include <sstream>
#include <stdexcept>
#include <string>

#include "analytics/report/study.h"
#include "analytics/report/study_output.h"
#include "tests/analytics/cohort/support/cohort_support.h"

namespace calot::analytics::support {

inline std::string textOf(const Study& study) {
  std::ostringstream out;
  printStudy(study, out);
  return out.str();
}

inline const StudyRow& rowOf(const Study& study, const std::string& name, const std::string& subject) {
  for (const StudyRow& row : study.rows) {
    if (row.checkpoint == name && row.subject == subject) return row;
  }
  throw std::out_of_range(name);
}

/// Five skilled and four unskilled performers, with the exact example of two_groups_test as their times.
inline void addPerformers(CohortDatabase& database) {
  const double skilled[] = {19, 22, 16, 29, 24}, unskilled[] = {20, 11, 17, 12};
  unsigned n = 0;
  for (const double t : skilled) database.storeAttempt(attemptOf(n++, "skilled"), valuesOf(t, t / 1000));
  for (const double t : unskilled) database.storeAttempt(attemptOf(n++, "unskilled"), valuesOf(t, t / 1000));
}

inline const StudyOptions performers = [] {
  StudyOptions options;
  options.grouping = Grouping::performer;
  options.includeSynthetic = true;
  return options;
}();

}  // namespace calot::analytics::support
