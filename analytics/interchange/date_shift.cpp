// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/interchange/date_shift.h"

#include <fmt/format.h>
#include <sodium.h>

#include <chrono>
#include <cstdio>

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

}  // namespace calot::analytics
