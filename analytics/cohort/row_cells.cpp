// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/cohort/row_cells.h"

#include <fmt/format.h>

namespace calot::analytics {

Cell cellOf(const SQLite::Column& column) {
  if (column.isInteger()) return column.getInt64();
  if (column.isFloat()) return column.getDouble();
  if (column.isText()) return column.getString();
  if (column.isBlob()) {
    const auto* bytes = static_cast<const unsigned char*>(column.getBlob());
    return Blob(bytes, bytes + column.getBytes());
  }
  return std::monostate{};
}

void bindCell(SQLite::Statement& statement, int at, const Cell& cell) {
  if (const auto* i = std::get_if<std::int64_t>(&cell)) {
    statement.bind(at, *i);
  } else if (const auto* d = std::get_if<double>(&cell)) {
    statement.bind(at, *d);
  } else if (const auto* s = std::get_if<std::string>(&cell)) {
    statement.bind(at, *s);
  } else if (const auto* b = std::get_if<Blob>(&cell)) {
    statement.bind(at, b->data(), static_cast<int>(b->size()));
  } else {
    statement.bind(at);
  }
}

bool isEmpty(const Cell& cell) {
  const auto* s = std::get_if<std::string>(&cell);
  return std::holds_alternative<std::monostate>(cell) || (s != nullptr && s->empty());
}

std::string shownCell(const Cell& cell) {
  if (const auto* i = std::get_if<std::int64_t>(&cell)) return fmt::format("{}", *i);
  if (const auto* d = std::get_if<double>(&cell)) return fmt::format("{}", *d);
  if (const auto* s = std::get_if<std::string>(&cell)) return fmt::format("\"{}\"", *s);
  if (const auto* b = std::get_if<Blob>(&cell)) {
    const std::string hex = hexOf(*b);
    return hex.size() > 16 ? hex.substr(0, 16) + "..." : hex;
  }
  return "nothing";
}

std::string textOf(const Cell& cell) {
  const auto* s = std::get_if<std::string>(&cell);
  return s == nullptr ? std::string() : *s;
}

std::int64_t numberOf(const Cell& cell) {
  const auto* i = std::get_if<std::int64_t>(&cell);
  return i == nullptr ? 0 : *i;
}

std::string joined(const std::vector<std::string>& parts, const char* between) {
  std::string text;
  for (const std::string& part : parts) text += (text.empty() ? "" : between) + part;
  return text;
}

std::string hexOf(const Blob& bytes) {
  std::string hex;
  for (const unsigned char byte : bytes) hex += fmt::format("{:02x}", byte);
  return hex;
}

std::vector<Row> readRows(SQLite::Database& db, const TableFacts& table) {
  std::vector<std::string> columns, order;
  for (const ColumnFacts& c : table.columns) columns.push_back(quotedName(c.name));
  for (const std::string& k : table.key) order.push_back(quotedName(k));
  if (!table.number.empty()) order = {quotedName(table.number)};
  SQLite::Statement read(db, fmt::format("SELECT {} FROM {}{}", joined(columns, ", "), quotedName(table.name),
                                         order.empty() ? "" : " ORDER BY " + joined(order, ", ")));
  std::vector<Row> rows;
  while (read.executeStep()) {
    Row& row = rows.emplace_back();
    for (std::size_t c = 0; c < table.columns.size(); ++c)
      row[table.columns[c].name] = cellOf(read.getColumn(static_cast<int>(c)));
  }
  return rows;
}

}  // namespace calot::analytics
