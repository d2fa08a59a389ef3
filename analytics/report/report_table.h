// SPDX-License-Identifier: GPL-3.0-or-later
// A table, shown identically on a terminal and in a page.
#pragma once

#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "analytics/report/text_table.h"

namespace calot::analytics {

struct ReportTable {
  std::string title;
  std::vector<std::pair<std::string, TextTable::Align>> columns;
  std::vector<std::vector<std::string>> rows;
};

/// Leaves out columns of which every cell is empty.
void dropEmptyColumns(ReportTable& table);

/// Title, table and an empty line, for a terminal of 120 columns.
void printTable(const ReportTable& content, std::ostream& out);
/// A sentence over as many lines as it needs.
void printWrapped(const std::string& text, std::ostream& out);

}  // namespace calot::analytics
