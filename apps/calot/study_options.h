// SPDX-License-Identifier: GPL-3.0-or-later
// Shared by commands over two groups' values: of a cohort, or of a table from elsewhere.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "analytics/report/masked_study.h"
#include "analytics/report/study.h"
#include "analytics/report/table_study.h"

namespace calot::apps {

struct StudySource {
  std::string database, groupBy = "group", table, attemptRule, protocol, cohortName;
  bool masked = false;  ///< until the protocol's analysis is locked
  analytics::StudyChoices choices;
  analytics::StudyOptions cohort;
  analytics::TableStudyOptions elsewhere;
};

/// Adds the cohort or --table, and who and what of it is compared.
void addStudySource(CLI::App& command, StudySource& source);

/// The cohort's study as its protocol and the options choose it. @pre there are a cohort and a protocol
analytics::StudyOptions protocolStudyOptions(const StudySource& source, const analytics::AssessmentDatabase& database);

/// @throws Error as makeStudy() and makeTableStudy(); (invalid) where neither a cohort nor a table is named.
analytics::Study studyOf(StudySource& source, const analytics::StudyProgress& progress = {});

}  // namespace calot::apps
