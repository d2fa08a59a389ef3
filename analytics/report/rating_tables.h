// SPDX-License-Identifier: GPL-3.0-or-later
// Results of forms as one tree of values, tables and sentences.
#pragma once

#include <string>
#include <vector>

#include "analytics/report/ratings.h"
#include "analytics/report/report_document.h"
#include "analytics/report/value_tree.h"

namespace calot::analytics {

/// Remarks: population of the figures, warnings about intervals with low coverage, and the items' source; none without
/// a form.
std::vector<std::string> ratingNotes(const FormReport& report);

/// Ratings, consistency and agreement of one form, without empty tables.
std::vector<ReportTable> ratingTables(const FormReport& report);

/// Every report with all of its numbers; missing numbers are null, with a reason if there is one.
ValueTree ratingsTree(const std::vector<FormReport>& reports);

}  // namespace calot::analytics
