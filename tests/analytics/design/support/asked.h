// SPDX-License-Identifier: GPL-3.0-or-later
// A design of a table that a test has as text.
#pragma once

#include <string>
#include <vector>

#include "analytics/design/design_report.h"
#include "recorder/base/csv.h"

namespace calot::analytics::support {

struct Asked {
  TableStudyOptions options;
  DesignChoices choices;
};

/// @param outcomes as --outcome, of a table with the columns `id` and `group`
inline Asked asked(Design design, const std::vector<std::string>& outcomes) {
  Asked a;
  a.options.participantColumn = "id";
  a.options.groupColumn = "group";
  a.options.outcomes = outcomes;
  a.choices.design = design;
  return a;
}

inline DesignReport reportOf(const std::string& text, const Asked& a) {
  return makeDesignReport(tableDesignData(parseCsvTable(text, "t.csv"), a.options, a.choices), a.choices);
}

}  // namespace calot::analytics::support
