// SPDX-License-Identifier: GPL-3.0-or-later
// Rows of any table, for work that must reach every table (schema_facts.h).
#pragma once

#include <SQLiteCpp/SQLiteCpp.h>

#include <cstdint>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include "analytics/cohort/schema_facts.h"

namespace calot::analytics {

using Blob = std::vector<unsigned char>;
/// Content of a column of a row: null, number, text or bytes.
using Cell = std::variant<std::monostate, std::int64_t, double, std::string, Blob>;
using Row = std::map<std::string, Cell>;  ///< by column

Cell cellOf(const SQLite::Column& column);
void bindCell(SQLite::Statement& statement, int at, const Cell& cell);
bool isEmpty(const Cell& cell);           ///< nothing, or an empty text
std::string shownCell(const Cell& cell);  ///< for a message: texts in quotation marks, long bytes cut
std::string textOf(const Cell& cell);     ///< of anything but a text: empty
std::int64_t numberOf(const Cell& cell);  ///< of anything but a whole number: 0
std::string hexOf(const Blob& bytes);
std::string joined(const std::vector<std::string>& parts, const char* between);

/// Every row of a table, in its primary key's order.
std::vector<Row> readRows(SQLite::Database& db, const TableFacts& table);

}  // namespace calot::analytics
