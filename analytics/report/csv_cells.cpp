// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/report/csv_cells.h"

namespace calot::analytics {

std::string csvCell(const std::string& text) {
  std::string safe = text;
  if (!safe.empty() && std::string("=+-@\t\r").find(safe.front()) != std::string::npos) safe.insert(safe.begin(), '\'');
  if (safe.find_first_of(",\"\r\n") == std::string::npos) return safe;
  std::string quoted = "\"";
  for (const char c : safe) quoted += c == '"' ? std::string("\"\"") : std::string(1, c);
  return quoted + "\"";
}

std::string csvLine(const std::vector<std::string>& texts) {
  std::string line;
  for (const std::string& text : texts) {
    line += csvCell(text);
    line += ',';
  }
  if (!line.empty()) line.back() = '\n';
  return line;
}

}  // namespace calot::analytics
