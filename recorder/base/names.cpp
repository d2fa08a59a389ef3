// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/base/names.h"

#include <fmt/format.h>
#include <utf8proc.h>
#include <algorithm>
#include <cstdlib>
#include <map>
#include <memory>
#include <utility>

#include "recorder/base/errors.h"
#include "recorder/base/text_words.h"

namespace calot::recorder {
namespace {

std::string mapped(std::string_view name, unsigned options) {
  utf8proc_uint8_t* out = nullptr;
  const utf8proc_ssize_t bytes =
      utf8proc_map(reinterpret_cast<const utf8proc_uint8_t*>(name.data()), static_cast<utf8proc_ssize_t>(name.size()),
                   &out, static_cast<utf8proc_option_t>(options | UTF8PROC_STABLE));
  const std::unique_ptr<utf8proc_uint8_t, decltype(&std::free)> owned(out, &std::free);
  return bytes < 0 ? std::string(name)
                   : std::string(reinterpret_cast<const char*>(out), static_cast<std::size_t>(bytes));
}

bool isDigit(char c) { return c >= '0' && c <= '9'; }

/// Equal for names that are similar.
std::string keyOfName(std::string_view name) {
  const std::string folded = mapped(name, UTF8PROC_COMPOSE | UTF8PROC_COMPAT | UTF8PROC_CASEFOLD);
  std::string key;
  for (std::size_t i = 0; i < folded.size(); ++i) {
    // A zero in front of a digit, but not behind a digit or a decimal point.
    const char before = key.empty() ? ' ' : key.back();
    const bool leads = folded[i] == '0' && !isDigit(before) && before != '.' && before != ',';
    if (!leads || i + 1 == folded.size() || !isDigit(folded[i + 1])) key += folded[i];
  }
  return key;
}

struct Spelling {
  std::string stored, composed, place;
};

}  // namespace

std::string composedName(std::string_view name) { return mapped(name, UTF8PROC_COMPOSE); }

void spellNames(CsvTable& table, const std::vector<NameColumn>& columns, SimilarNames similar) {
  for (const NameColumn& column : columns) {
    if (column.name.empty() || !table.has(column.name)) continue;
    const std::size_t at = table.column(column.name);
    std::map<std::string, std::vector<Spelling>> spellings;
    for (const std::string& name : column.known)
      spellings[keyOfName(name)].push_back({name, composedName(name), "stored already"});
    for (CsvRow& row : table.rows) {
      std::string& cell = row.cells[at];
      if (cell.empty()) continue;
      const std::string name = composedName(cell);
      std::vector<Spelling>& alike = spellings[keyOfName(name)];
      const auto same = std::find_if(alike.begin(), alike.end(), [&](const Spelling& s) { return s.composed == name; });
      if (same != alike.end()) {
        cell = same->stored;
      } else if (alike.empty() || similar == SimilarNames::two) {
        alike.push_back({name, name, fmt::format("of line {}", row.line)});
        cell = name;
      } else if (similar == SimilarNames::one) {
        cell = alike.front().stored;
      } else {
        throw Error(ErrorKind::refused, Where{table.path, fmt::format("line {}", row.line)},
                    fmt::format("column \"{}\": \"{}\" and \"{}\" ({}) are one name or two", shown(column.name),
                                shown(name), shown(alike.front().stored), alike.front().place),
                    {Remedy::sayNames});
      }
    }
  }
}

}  // namespace calot::recorder
