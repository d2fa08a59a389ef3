// SPDX-License-Identifier: GPL-3.0-or-later
// Results of completed forms: ratings by group, internal consistency and agreement between raters; and these as one
// tree of values, tables and sentences (rating_tables.cpp).
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "analytics/assessment/rating_form.h"
#include "analytics/cohort/cohort_database.h"
#include "analytics/report/report_document.h"
#include "analytics/report/value_tree.h"
#include "analytics/statistics/descriptive.h"
#include "analytics/statistics/expected.h"
#include "analytics/statistics/reliability.h"

namespace calot::analytics {

/// Whose attempt it is, and when it began: attempts of one participant are not independent.
struct AttemptOf {
  std::string participant, startUtc;
};

/// One group's ratings of an item, one value per participant: the mean of an attempt's raters, of a participant's
/// several attempts the mean of these.
struct ItemSummary : Summary {
  std::uint64_t blank = 0;
  std::map<int, std::uint64_t> counts;  ///< how often each score was given
};

struct ItemReport {
  std::string key, text;
  std::string primaryGroup;                      ///< or empty
  std::vector<ItemSummary> groups;               ///< by FormReport::groups
  std::vector<std::optional<double>> published;  ///< mean by group
};

/// Sums of a subscale's items, or of all items of the form: of forms that have them all.
struct ScaleReport {
  std::string name;  ///< "Global rating (all items)" for all of them
  std::uint64_t items = 0;
  std::vector<ItemSummary>
      groups;  ///< of the sums, by FormReport::groups; `blank`: participants without a complete one
};

/// Agreement on one figure of the attempts that every rater rated; of a participant's several the earliest alone.
struct Agreement {
  std::string figure;  ///< an item's key, a subscale, or "mean of all items"
  std::uint64_t attempts = 0, raters = 0;
  Expected<IntraclassCorrelation> single = NoResult{"not computed"};   ///< ICC(2,1)
  Expected<IntraclassCorrelation> average = NoResult{"not computed"};  ///< ICC(2,k)
};

struct SectionConsistency {
  std::string section;
  std::uint64_t n = 0;  ///< complete forms
  Expected<CronbachAlpha> alpha = NoResult{"not computed"};
};

struct FormReport {
  std::string name, title, source;
  std::uint32_t version = 1;
  bool ofAttempts = true;
  int least = 1, most = 5;  ///< of the scale
  std::vector<std::string> groups;
  std::uint64_t filled = 0;      ///< forms
  std::uint64_t leftOut = 0;     ///< of attempts or participants that are in none of the groups
  std::uint64_t repeated = 0;    ///< attempts of participants of whom an earlier one is in the agreement
  std::uint64_t incomplete = 0;  ///< attempts that not every rater rated whole; out of the agreement
  std::vector<ItemReport> items;
  std::vector<ScaleReport> scales;           ///< of attempts: the form's subscales, then all items; none of one item
  std::vector<SectionConsistency> sections;  ///< of a questionnaire: those of three items or more
  std::vector<Agreement> agreement;          ///< of attempts
};

/// @param groupOf group of each attempt's uuid or of each participant; others are omitted
/// @param groups in the order of the tables
/// @param attemptOf of attempts by uuid; one that is missing there is a participant of its own
FormReport reportForm(const RatingForm& form, const std::vector<Rating>& ratings,
                      const std::map<std::string, std::string>& groupOf, const std::vector<std::string>& groups,
                      const std::map<std::string, AttemptOf>& attemptOf = {});

/// Reports of every form that a cohort holds, by name and version.
std::vector<FormReport> reportForms(const CohortDatabase& database, const std::map<std::string, std::string>& groupOf,
                                    const std::vector<std::string>& groups,
                                    const std::map<std::string, AttemptOf>& attemptOf);

/// Remarks: population of the figures, warnings about intervals with low coverage, and the items' source; none without
/// a form.
std::vector<std::string> ratingNotes(const FormReport& report);

/// Ratings, consistency and agreement of one form, without empty tables.
std::vector<ReportTable> ratingTables(const FormReport& report);

/// Every report with all of its numbers; missing numbers are null, with a reason if there is one.
ValueTree ratingsTree(const std::vector<FormReport>& reports);

}  // namespace calot::analytics
