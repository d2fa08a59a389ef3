// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/report/value_tree.h"

#include <fmt/format.h>

#include <sstream>

#include "analytics/report/figure_number.h"
#include "recorder/base/csv.h"

namespace calot::analytics {
namespace {

using Path = ValueTree::json_pointer;

const ValueTree& at(const ValueTree& row, const Path& path) {
  static const ValueTree nothing;
  return row.contains(path) ? row.at(path) : nothing;
}

std::string csvCellOf(const ValueTree& value) {
  if (value.is_string()) return csvCell(value.get_ref<const std::string&>());
  if (value.is_boolean()) return value.get<bool>() ? "yes" : "no";
  if (value.is_number_float()) return fmt::format("{}", value.get<double>());
  if (value.is_number()) return value.dump();
  std::string list;
  for (const ValueTree& each : value) list += (list.empty() ? "" : "; ") + each.get<std::string>();
  return csvCell(list);
}

std::string number(const ValueTree& value, const char* format) {
  return value.is_number() ? fmt::format(fmt::runtime(format), value.get<double>()) : "-";
}

/// Both ends of an interval as `text` has them.
std::string range(const ValueTree& value, CellText text) {
  if (!value.contains("lower")) return "-";
  return fmt::format("[{}, {}]", text(value["lower"]), text(value["upper"]));
}

}  // namespace

std::string csvText(const ValueTree& rows, const std::string& columns) {
  std::vector<Path> paths;
  std::string text;
  std::istringstream words(columns);
  for (std::string word; words >> word;) {
    const std::size_t mark = word.find('=');
    const std::string name = word.substr(0, mark);
    text += (paths.empty() ? "" : ",") + name;
    paths.emplace_back(mark == std::string::npos ? "/" + name : word.substr(mark + 1));
  }
  text += '\n';
  for (const ValueTree& row : rows) {
    for (const Path& path : paths) text += csvCellOf(at(row, path)) + ',';
    text.back() = '\n';
  }
  return text;
}

ReportTable tableOf(const std::string& title, const ValueTree& rows, const std::vector<TreeColumn>& columns) {
  std::vector<std::string> titles;
  titles.reserve(columns.size());
  for (const TreeColumn& column : columns) titles.push_back(column.title);
  ReportTable table = tableOf(title, titles);
  for (const ValueTree& row : rows) {
    std::vector<std::string>& cells = table.rows.emplace_back();
    for (const TreeColumn& column : columns) {
      const ValueTree& value = at(row, Path(column.path));
      const auto* const figure = std::get_if<FigureText>(&column.text);
      cells.push_back(figure != nullptr ? (*figure)(value, row) : std::get<CellText>(column.text)(value));
    }
  }
  return table;
}

std::string plain(const ValueTree& value) {
  if (value.is_null()) return "";
  return value.is_string() ? value.get<std::string>() : value.dump();
}
std::string digits4(const ValueTree& value) { return value.is_number() ? significant(value.get<double>()) : "-"; }
std::string digits3(const ValueTree& value) { return value.is_number() ? significant(value.get<double>(), 3) : "-"; }
std::string share2(const ValueTree& value) { return number(value, "{:.2f}"); }
std::string share3(const ValueTree& value) { return number(value, "{:.3f}"); }
std::string signed2(const ValueTree& value) { return number(value, "{:+.2f}"); }
std::string signed3(const ValueTree& value) { return number(value, "{:+.3f}"); }
std::string pValue(const ValueTree& value) { return value.is_number() ? pText(value.get<double>()) : "-"; }
std::string range4(const ValueTree& value) { return range(value, digits4); }
std::string range3(const ValueTree& value) { return range(value, digits3); }
std::string shares2(const ValueTree& value) { return range(value, share2); }
std::string shares3(const ValueTree& value) { return range(value, share3); }

namespace {

std::string figureCell(const ValueTree& value, const ValueTree& row, int digits) {
  if (!value.is_number()) return "-";
  const bool ofScript = row.contains("source_sha256");
  const std::string name = row.value("checkpoint", row.value("figure", std::string()));
  return figureNumber(ofScript ? nullptr : definitionOfFigure(name), value.get<double>(), digits);
}

std::string figureRange(const ValueTree& value, const ValueTree& row, int digits) {
  if (!value.contains("lower")) return "-";
  return fmt::format("[{}, {}]", figureCell(value["lower"], row, digits), figureCell(value["upper"], row, digits));
}

}  // namespace

std::string figure4(const ValueTree& value, const ValueTree& row) { return figureCell(value, row, 4); }
std::string figure3(const ValueTree& value, const ValueTree& row) { return figureCell(value, row, 3); }
std::string figureRange4(const ValueTree& value, const ValueTree& row) { return figureRange(value, row, 4); }
std::string figureRange3(const ValueTree& value, const ValueTree& row) { return figureRange(value, row, 3); }

}  // namespace calot::analytics
