// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/intake/manifests.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "recorder/base/text_words.h"

namespace calot::analytics {

ManifestTable::ManifestTable(CsvTable table, const std::vector<std::string>& known) : table_(std::move(table)) {
  const auto isKnown = [&](const std::string& column) {
    return column == "note" || std::any_of(known.begin(), known.end(), [&](const std::string& name) {
             return name.back() == ':' ? column.size() > name.size() && column.substr(0, name.size()) == name
                                       : column == name;
           });
  };
  for (const std::string& column : table_.columns) {
    if (!isKnown(column)) {
      std::string list;
      for (const std::string& name : known) list += name + (name.back() == ':' ? "..., " : ", ");
      throw Error(ErrorKind::invalid, Where{table_.path, "line 1"},
                  fmt::format("a column \"{}\" is not known here; rename or remove it (there are: {}note)",
                              recorder::shown(column), list));
    }
    static_cast<void>(table_.column(column));  // refuses what is there twice
  }
}

std::string ManifestTable::cell(const CsvRow& row, const std::string& column) const {
  const auto at = std::find(table_.columns.begin(), table_.columns.end(), column);
  return at == table_.columns.end() ? std::string() : row.cells[static_cast<std::size_t>(at - table_.columns.begin())];
}

std::filesystem::path ManifestTable::fileNamed(const std::string& cell) const {
  const std::filesystem::path file(cell);
  return file.is_absolute() ? file : std::filesystem::path(table_.path).parent_path() / file;
}

Error ManifestTable::fault(const CsvRow& row, const std::string& column, const std::string& what) const {
  return {ErrorKind::damaged, Where{table_.path, fmt::format("line {}", row.line)},
          fmt::format("column \"{}\": {}", recorder::shown(column), what)};
}

bool holdsControl(const std::string& name) {
  return std::any_of(name.begin(), name.end(), [](char c) { return (c >= 0 && c < ' ') || c == '\x7F'; });
}

}  // namespace calot::analytics
