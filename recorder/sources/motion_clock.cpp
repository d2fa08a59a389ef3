// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/motion_clock.h"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <vector>

#include "recorder/base/dates.h"
#include "recorder/base/text_words.h"

namespace calot::recorder {
namespace {

constexpr double daySeconds = 86400.0;

/// Days from 1970-01-01 of the Gregorian calendar; nothing for a day that it has not. @pre 0 <= y
std::optional<std::int64_t> dayNumber(std::int64_t y, std::int64_t m, std::int64_t d) {
  constexpr std::array<std::int64_t, 13> before{0, 31, 59, 90, 120, 151, 181, 212, 243, 273, 304, 334, 365};
  if (y < 1 || m < 1 || m > 12 || d < 1) return {};
  const std::int64_t leapDay = y % 4 == 0 && (y % 100 != 0 || y % 400 == 0) ? 1 : 0;
  const auto month = static_cast<std::size_t>(m);
  if (d > before[month] - before[month - 1] + (m == 2 ? leapDay : 0)) return {};
  const std::int64_t years = y - 1;
  constexpr std::int64_t epoch = 719162;  // days from 0001-01-01
  return 365 * years + years / 4 - years / 100 + years / 400 + before[month - 1] + (m > 2 ? leapDay : 0) + d - 1 -
         epoch;
}

bool readDigits(std::string_view text, std::int64_t& value) {
  const auto [end, code] = std::from_chars(text.data(), text.data() + text.size(), value);
  return code == std::errc() && end == text.data() + text.size() && !text.empty() && text.front() != '-';
}

/// "250" as 0.250. @return false: other characters than digits
bool readFraction(std::string_view digits, double& value) {
  // Digits and powers of ten that doubles hold: the quotient is the nearest one.
  constexpr std::array<double, 16> powers{1e0, 1e1, 1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                          1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15};
  std::int64_t whole = 0;
  value = 0.0;
  if (digits.empty()) return true;
  if (digits.size() < powers.size()) {
    if (!readDigits(digits, whole)) return false;
    value = static_cast<double>(whole) / powers[digits.size()];
    return true;
  }
  if (digits.find_first_not_of("0123456789") != std::string_view::npos) return false;
  std::string fault;
  value = readFiniteNumber("0." + std::string(digits), fault);
  return true;
}

}  // namespace

MotionClock::Time MotionClock::number(std::string_view text, std::string& fault) {
  Time time;
  const char* const end = text.data() + text.size();
  const auto [point, code] = std::from_chars(text.data(), end, time.whole);
  const bool plain = code == std::errc() && text.front() != '-';
  if (plain && point == end) return time;
  if (plain && (*point == '.' || *point == ',') &&
      readFraction({point + 1, static_cast<std::size_t>(end - point - 1)}, time.part))
    return time;
  const double value = readFiniteNumber(text, fault);  // signs, exponents
  if (text.find(':') != std::string_view::npos)
    fault += text.find('-') != std::string_view::npos ? "; \"unit\": \"iso\" in the map reads dates"
                                                      : "; \"unit\": \"time-of-day\" in the map reads times of day";
  const double whole = std::floor(value);
  if (!(std::abs(whole) < 9e18)) {
    fault = fmt::format("\"{}\" is beyond every clock", shown(text));
    return {};
  }
  return {static_cast<std::int64_t>(whole), value - whole};
}

MotionClock::Time MotionClock::timeOfDay(std::string_view text, std::string& fault) {
  std::int64_t parts[4] = {};
  std::size_t count = 0;
  std::string_view rest = text;
  std::string_view fraction;
  for (; count < 4; ++count) {
    const std::size_t end = std::min(rest.find_first_of(count == 2 ? ":.," : ":"), rest.size());
    if (!readDigits(rest.substr(0, end), parts[count])) break;
    if (count == 2 && end < rest.size() && rest[end] != ':') fraction = rest.substr(end + 1);
    if (end == rest.size() || !fraction.empty()) {
      rest = {};
      ++count;
      break;
    }
    rest.remove_prefix(end + 1);
  }
  double part = 0.0;
  if (count < 3 || !rest.empty() || parts[0] > 23 || parts[1] > 59 || parts[2] > 60 || parts[3] > 999 ||
      !readFraction(fraction, part)) {
    fault = fmt::format("\"{}\" is no time of day; 13:05:09.250 or 13:05:09:250 is expected", shown(text));
    return {};
  }
  return {3600 * parts[0] + 60 * parts[1] + parts[2], static_cast<double>(parts[3]) / 1000.0 + part};
}

MotionClock::Time MotionClock::date(std::string_view text, std::string& fault) const {
  const auto fail = [&](const char* what) {
    fault = fmt::format("\"{}\" {}", shown(text), what);
    return Time{};
  };
  std::int64_t y = 0, m = 0, d = 0;
  if (text.size() < 19 || text[4] != '-' || text[7] != '-' || (text[10] != 'T' && text[10] != ' ') ||
      !readDigits(text.substr(0, 4), y) || !readDigits(text.substr(5, 2), m) || !readDigits(text.substr(8, 2), d))
    return fail("is no date; 2026-01-31T13:05:09.250Z is expected");
  const std::optional<std::int64_t> day = dayNumber(y, m, d);
  if (!day) return fail("is no day of the calendar");
  const std::size_t zoneAt = std::min(text.find_first_of("Zz+-U", 19), text.size());
  const std::string_view zone = zoneAt < text.size() ? text.substr(zoneAt) : std::string_view(format_.zone);
  if (zone.empty())
    return fail("states no zone, and local time is put back in autumn: say \"zone\" in the map (\"+02:00\", \"Z\")");
  const std::optional<int> minutes = readZone(zone);
  if (!minutes) return fail("has an unknown zone; Z or +02:00 is expected");
  std::string_view clock = text.substr(11, zoneAt - 11);
  while (!clock.empty() && clock.back() == ' ') clock.remove_suffix(1);
  Time time = timeOfDay(clock, fault);
  time.whole += *day * 86400 - 60 * *minutes;
  return time;
}

double MotionClock::seconds(std::string_view text, std::string_view nanoseconds, std::string& fault) {
  const bool dated = format_.unit == ClockUnit::iso, ofDay = format_.unit == ClockUnit::timeOfDay;
  Time time = dated ? date(text, fault) : ofDay ? timeOfDay(text, fault) : number(text, fault);
  if (!nanoseconds.empty()) {
    std::int64_t ns = 0;
    if (!readDigits(nanoseconds, ns) || ns >= 1'000'000'000)
      fault = fmt::format("\"{}\" is no number of nanoseconds", shown(nanoseconds));
    time.part += static_cast<double>(ns) * 1e-9;
  }
  if (!fault.empty()) return 0.0;
  if (!begun_) first_ = time;
  constexpr double seconds[] = {1.0, 1e-3, 1e-6, 1e-9};
  const auto unit = static_cast<std::size_t>(format_.unit);
  const double scale = unit < 4 ? seconds[unit] : format_.unit == ClockUnit::frame ? 1.0 / format_.rate : 1.0;
  // Unsigned: the difference of two numbers of any sign is defined, and right where it fits.
  const auto whole =
      static_cast<std::int64_t>(static_cast<std::uint64_t>(time.whole) - static_cast<std::uint64_t>(first_.whole));
  const double period = ofDay ? daySeconds : format_.wraps * scale;
  double since = static_cast<double>(whole) * scale + (time.part - first_.part) * scale + wrapped_;
  if (begun_ && period > 0.0 && since < last_ - 0.5 * period) {
    wrapped_ += period;
    since += period;
  }
  begun_ = true;
  last_ = since;
  return std::round(since * 1e12) / 1e12;
}

}  // namespace calot::recorder
