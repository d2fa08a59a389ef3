// SPDX-License-Identifier: GPL-3.0-or-later
// Results of a design as tables, sentences, figures and JSON: the same on the terminal, in a page and on paper.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <ostream>
#include <string>
#include <vector>

#include "analytics/design/design_data.h"
#include "analytics/report/report_document.h"

namespace calot::analytics {

struct DesignReport {
  std::string title;
  bool synthetic = false;
  std::vector<std::string> head;
  ReportTable flow;
  std::vector<ReportTable> tables;
  std::vector<std::string> notes;  ///< whole sentences
  std::vector<Drawing> drawings;
  std::string methods;                ///< what was done, without population and software
  nlohmann::ordered_json json;        ///< "results" of designJson()
  std::vector<std::string> attempts;  ///< uuids of a cohort's attempts that are in it
};

/// The design's analysis of the data.
/// @throws Error (refused) where no figure can be analysed or a figure does not fit the design, with the reason.
DesignReport makeDesignReport(const DesignData& data, const DesignChoices& choices);

ReportDocument designDocument(const DesignReport& report);
void printDesign(const DesignReport& report, std::ostream& out);
/// Everything with all digits; missing numbers are null with a reason.
std::string designJson(const DesignReport& report);

}  // namespace calot::analytics
