// SPDX-License-Identifier: GPL-3.0-or-later

#include "analytics/interchange/bundle_names.h"

#include <fmt/format.h>
#include <sodium.h>
#include <algorithm>
#include <chrono>
#include <cstdio>

#include "analytics/cohort/withdraw.h"

namespace calot::analytics {

std::int64_t drawShift() {
  [[maybe_unused]] static const int ready = sodium_init();
  constexpr std::uint32_t day = 86400, least = 30 * day, most = 365 * day;
  const std::uint32_t length = least + randombytes_uniform(most - least + 1);
  const bool earlier = randombytes_uniform(2) == 0;
  return earlier ? -static_cast<std::int64_t>(length) : static_cast<std::int64_t>(length);
}

std::string shiftedUtc(const std::string& utc, std::int64_t seconds) {
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

/// A figure, but for a day ("2026-01-31"), or a single letter.
bool saysNothing(std::string_view name) {
  const bool figure = std::all_of(name.begin(), name.end(),
                                  [](char c) { return (c >= '0' && c <= '9') || c == '.' || c == '-' || c == '+'; });
  const bool day = name.size() == 10 && std::count(name.begin(), name.end(), '-') == 2;
  return name.size() < 2 || (figure && !day);
}

bool inCell(char c) { return c != ',' && c != '"' && c != '\n'; }

}  // namespace

void OriginalNames::add(const std::string& name, const char* kind) {
  if (!saysNothing(name)) kindOf_.emplace(name, kind);
}

std::string OriginalNames::firstIn(std::string_view text, const std::set<std::string>& vocabulary) const {
  for (bool (*belongs)(char) : {inCell, isInWord}) {
    for (std::size_t i = 0; i < text.size();) {
      std::size_t end = i;
      while (end < text.size() && belongs(text[end])) ++end;
      const auto at = kindOf_.find(text.substr(i, end - i));
      if (at != kindOf_.end() && vocabulary.count(at->first) == 0) return at->second;
      i = end + 1;
    }
  }
  return {};
}

std::string NewNames::random(const char* kind, const std::string& old) {
  [[maybe_unused]] static const int ready = sodium_init();
  return named(kind, old, [&] {
    static constexpr char letters[] = "abcdefghjkmnpqrstuvwxyz23456789";
    std::string name = kind;
    for (int i = 0; i < 9; ++i) name += letters[randombytes_uniform(sizeof letters - 1)];
    return name;
  });
}

std::string NewNames::numbered(const char* kind, const std::string& old) {
  return named(kind, old, [&] { return fmt::format("{}{}", kind, ++last_[kind]); });
}

}  // namespace calot::analytics
