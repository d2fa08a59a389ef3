// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/base/dates.h"

#include <fmt/chrono.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <regex>

#include "recorder/base/errors.h"
#include "recorder/base/text_words.h"

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

std::string shiftedDate(const std::string& utc, std::int64_t seconds) {
  using namespace std::chrono;
  int y = 0, h = 0, m = 0, s = 0, used = 0;
  unsigned mo = 0, d = 0;
  if (std::sscanf(utc.c_str(), "%4d-%2u-%2uT%2d:%2d:%2d%n", &y, &mo, &d, &h, &m, &s, &used) != 6) return {};
  if (utc.back() != 'Z' || h > 23 || m > 59 || s > 60) return {};
  const year_month_day date{year(y), month(mo), day(d)};
  if (!date.ok()) return {};
  const sys_seconds moved = sys_days(date) + hours(h) + minutes(m) + std::chrono::seconds(s + seconds);
  const auto midnight = floor<days>(moved);
  const year_month_day to(midnight);
  const hh_mm_ss clock(moved - midnight);
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}Z", static_cast<int>(to.year()),
                     static_cast<unsigned>(to.month()), static_cast<unsigned>(to.day()), clock.hours().count(),
                     clock.minutes().count(), clock.seconds().count());
}

namespace {

using namespace std::chrono_literals;
using std::chrono::sys_days;

struct WrittenDate {
  std::chrono::sys_seconds moment;
  bool zoned = false;
};

[[noreturn]] void failDate(std::string_view word, const char* what, std::vector<Remedy> remedies = {}) {
  throw Error(ErrorKind::invalid, {}, fmt::format("\"{}\" {}", shown(word), what), std::move(remedies));
}

/// A number of days, as spreadsheets store dates. Numbers of other centuries are not taken for one.
std::optional<WrittenDate> dayNumber(std::string word) {
  std::replace(word.begin(), word.end(), ',', '.');
  std::string fault;
  const double days = readFiniteNumber(word, fault);
  if (!fault.empty() || days < 20000.0 || days > 80000.0) return {};
  const std::chrono::seconds seconds(std::llround(days * 86400.0));
  return WrittenDate{sys_days(std::chrono::year(1899) / 12 / 30) + seconds};
}

WrittenDate writtenDate(std::string_view word, const DateStyle& style) {
  constexpr std::size_t longest = 40;
  static const std::regex form(
      R"((\d{1,4})([-./])(\d{1,2})\2(\d{1,4})(?:[T ]+(\d{1,2}):(\d\d)(?::(\d\d)(?:[.,]\d+)?)?(?: ?([AaPp])[Mm])? ?(Z|UTC|[-+]\d\d:?\d\d)?)?)");
  const std::string text(word.substr(0, longest + 1));
  std::smatch part;
  if (const auto days = dayNumber(text)) return *days;
  if (text.size() > longest || !std::regex_match(text, part, form))
    failDate(word, "is not a date such as 2026-01-31 or 2026-01-31T12:00:00Z");
  const auto number = [&](std::size_t i) { return part[i].matched ? std::stoi(part[i].str()) : 0; };
  int year = number(1), month = number(3), day = number(4);
  if (part[1].length() != 4) {
    if (part[4].length() != 4) failDate(word, "has no year of four digits");
    const bool monthFirst = style.order == DateStyle::Order::monthFirst && part[2] != ".";
    const bool ordered = part[2] == "." || style.order != DateStyle::Order::unknown;
    year = number(4);
    if (!ordered && year > 0 && number(1) <= 12 && month <= 12 && number(1) != month)
      failDate(word, "is one of two dates, by whether day or month comes first", {Remedy::sayDates});
    day = number(1);
    if (monthFirst || (!ordered && month > 12)) std::swap(day, month);
  }
  const std::chrono::year_month_day date = std::chrono::year(year) / month / day;
  const std::optional<int> zone = part[9].matched ? readZone(part[9].str()) : std::nullopt;
  int hour = number(5);
  const bool half = part[8].matched;
  if (!date.ok() || hour > (half ? 12 : 23) || (half && hour == 0) || number(6) > 59 || number(7) > 59 ||
      (part[9].matched && !zone))
    failDate(word, "is not a date that there is");
  if (half) hour = hour % 12 + (part[8] == "P" || part[8] == "p" ? 12 : 0);
  return {sys_days(date) + hour * 1h + number(6) * 1min + number(7) * 1s - zone.value_or(0) * 1min, zone.has_value()};
}

}  // namespace

std::optional<int> readZone(std::string_view word) {
  if (word == "Z" || word == "z" || word == "UTC") return 0;
  static const std::regex form(R"(([-+])(\d\d?)(?::?(\d\d))?)");
  std::cmatch part;
  if (!std::regex_match(word.data(), word.data() + word.size(), part, form)) return {};
  const int minutes = 60 * std::stoi(part[2].str()) + (part[3].matched ? std::stoi(part[3].str()) : 0);
  return minutes > 14 * 60 ? std::nullopt : std::optional(part[1] == "-" ? -minutes : minutes);
}

std::string readMoment(std::string_view word, const DateStyle& style) {
  WrittenDate date = writtenDate(word, style);
  if (!date.zoned && !style.zone) failDate(word, "is of a zone that nobody said", {Remedy::sayZone});
  if (!date.zoned) date.moment -= *style.zone * 1min;
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}Z", fmt::gmtime(std::chrono::system_clock::to_time_t(date.moment)));
}

std::string readDay(std::string_view word, const DateStyle& style) {
  const auto time = std::chrono::system_clock::to_time_t(writtenDate(word, style).moment);
  return fmt::format("{:%Y-%m-%d}", fmt::gmtime(time));
}

}  // namespace calot::recorder
