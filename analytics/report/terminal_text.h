// SPDX-License-Identifier: GPL-3.0-or-later
// Text of reports within the columns of a terminal: sentences that are wrapped, tables that leave out columns.
#pragma once

#include <cstddef>
#include <functional>
#include <ostream>
#include <string>

#include "analytics/report/report_document.h"

namespace calot::analytics {

/// Columns of the terminal that a stream writes to. What is printed to it afterwards fits them; std::ios::copyfmt
/// copies them. A stream without them is a file or a pipe: tables keep all columns there.
void setTerminalColumns(std::ostream& out, std::size_t columns);

/// The text in lines of at most `columns`, broken at blanks; its own line breaks stay. Lines below the first begin with
/// `indent` blanks. A longer word has a line of its own. A number stays with its unit ("12 mm", "95 %"), and the ends
/// of an interval with each other ("[0.50, 1.00]").
/// @param used columns that the first line begins with
std::string wrappedText(const std::string& text, std::size_t columns, std::size_t indent = 0, std::size_t used = 0);

/// Title, table and an empty line; 120 columns without a terminal.
void printTable(const ReportTable& table, std::ostream& out);
/// A sentence over as many lines as it needs; 120 columns at most.
void printWrapped(const std::string& text, std::ostream& out);

/// The beginning of a report: `flow` may be empty.
struct ReportOpening {
  std::string title;
  bool synthetic = false;
  std::vector<std::string> head;
  ReportTable flow;
};
/// A report for a terminal: its opening with the flow, then what `body` prints, between watermarks.
void printReport(const ReportOpening& opening, std::ostream& out, const std::function<void()>& body);

/// A whole document for a terminal; figures are left out.
void printDocument(const ReportDocument& document, std::ostream& out);

}  // namespace calot::analytics
