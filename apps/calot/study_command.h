// SPDX-License-Identifier: GPL-3.0-or-later
// Shared by commands over two groups' values: of a cohort, or of a table from elsewhere.
#pragma once

#include <CLI/CLI.hpp>
#include <string>

#include "analytics/report/report_document.h"
#include "analytics/report/study.h"
#include "analytics/report/study_protocol.h"
#include "analytics/report/table_study.h"
#include "recorder/base/names.h"

namespace calot::apps {

struct StudySource {
  std::string database, groupBy = "group", table, attemptRule, protocol, cohortName;
  bool masked = false;  ///< until the protocol's analysis is locked
  analytics::StudyChoices choices;
  analytics::StudyOptions cohort;
  analytics::TableStudyOptions elsewhere;
  recorder::SimilarNames similarNames = recorder::SimilarNames::ask;
};

/// Adds the cohort or, with `tables`, --table, and who and what of it is compared.
void addStudySource(CLI::App& command, StudySource& source, bool tables = true);

/// The cohort's study as its protocol and the options choose it. @pre there are a cohort and a protocol
analytics::StudyOptions protocolStudyOptions(const StudySource& source, const analytics::CohortDatabase& database);

/// The same of a source with or without a protocol.
analytics::StudyOptions cohortStudyOptions(StudySource& source, const analytics::CohortDatabase& database);

/// @throws Error as makeStudy() and makeTableStudy(); (invalid) where neither a cohort nor a table is named.
analytics::Study studyOf(StudySource& source, const analytics::StudyProgress& progress = {});

/// Writes a report as a page and on paper, where a file is named. @param recording that the page carries, or null
/// @throws Error as recorder::writeText and gui::pdfReport
void writeReport(const analytics::ReportDocument& document, const std::string& html, const std::string& pdf, bool force,
                 const analytics::CarriedRecording* recording = nullptr);

}  // namespace calot::apps
