// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/base/dates.h"

#include <fmt/chrono.h>

#include <chrono>

namespace calot::recorder {

bool isDate(const std::string& text) {
  static const std::string form = "0000-00-00T00:00:00Z";
  if (text.size() != form.size()) return false;
  for (std::size_t i = 0; i < form.size(); ++i) {
    if (form[i] == '0' ? text[i] < '0' || text[i] > '9' : text[i] != form[i]) return false;
  }
  const std::chrono::year_month_day day = std::chrono::year(std::stoi(text.substr(0, 4))) /
                                          std::chrono::month(static_cast<unsigned>(std::stoi(text.substr(5, 2)))) /
                                          std::chrono::day(static_cast<unsigned>(std::stoi(text.substr(8, 2))));
  return day.ok() && text.substr(11, 2) < "24" && text[14] < '6' && text[17] < '6';
}

std::string presentDate() {
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}Z",
                     fmt::gmtime(std::chrono::system_clock::to_time_t(std::chrono::system_clock::now())));
}

}  // namespace calot::recorder
