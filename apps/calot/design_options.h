// SPDX-License-Identifier: GPL-3.0-or-later
// The designs of `calot study` other than two groups.
#pragma once

#include <CLI/CLI.hpp>
#include <string>
#include <vector>

#include "analytics/design/design_report.h"
#include "apps/calot/study_options.h"

namespace calot::apps {

struct DesignOptions {
  std::string design;  ///< empty: implied by other options, else two groups
  std::string strata, against, finishedColumn, shape = "inverse";
  std::optional<double> criterion;
  std::vector<double> failureRates;
  std::size_t run = 1;
  double errorRatio = 1.0;
};

/// Adds --design and what single designs need. @pre addStudySource() was called
void addDesignOptions(CLI::App& command, DesignOptions& options);

/// Chosen or implied: three groups, strata. @throws Error (invalid) for options that the design does not take, or
/// lacks.
analytics::Design designOf(const DesignOptions& options, const StudySource& source);

/// @throws Error as analytics::cohortDesignData(), tableDesignData() and makeDesignReport().
analytics::DesignReport designReportOf(const DesignOptions& options, StudySource& source);

}  // namespace calot::apps
