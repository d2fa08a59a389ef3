// SPDX-License-Identifier: GPL-3.0-or-later
// Dates as files hold them: ISO 8601 in UTC, to the second; and as people and spreadsheets write them.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace calot::recorder {

/// "2026-01-31T23:59:59Z", of a day that there is.
bool isDate(const std::string& text);

/// Now.
std::string presentDate();

/// "2026-01-01T00:00:00Z" moved, in whole seconds (parts of one are cut off); empty where that is no such time.
std::string shiftedDate(const std::string& utc, std::int64_t seconds);

/// Completes dates that do not say all themselves; where it is lacking and matters, they are refused.
struct DateStyle {
  enum class Order { unknown, dayFirst, monthFirst } order = Order::unknown;  ///< of 3/4/2026
  std::optional<int> zone = {};                                               ///< minutes east of UTC
};

/// A date as spreadsheets and people write it: 2026-01-31, 31.1.2026, 31/1/2026 or 1/31/2026, with 13:05, 13:05:09 or
/// 1:05 PM behind it, or days since 1899-12-30 (46053,5).
/// @return "2026-01-31T12:00:00Z" @throws Error (invalid) for another word, or one that could be two dates
std::string readMoment(std::string_view word, const DateStyle& style);
/// The day alone. @return "2026-01-31" @throws as above
std::string readDay(std::string_view word, const DateStyle& style);

/// Minutes of "Z", "+02:00", "-0530" or "+2"; nothing of other words.
std::optional<int> readZone(std::string_view word);

}  // namespace calot::recorder
