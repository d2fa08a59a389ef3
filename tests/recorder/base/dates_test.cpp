// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/base/dates.h"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "recorder/base/errors.h"

namespace calot::recorder {
namespace {

TEST(Dates, AreOfDaysThatThereAre) {
  EXPECT_TRUE(isDate("2026-01-31T23:59:59Z"));
  EXPECT_TRUE(isDate("2024-02-29T00:00:00Z"));
  for (const char* wrong :
       {"", "2026-01-31", "2026-01-31T23:59:59", "2026-01-31 23:59:59Z", "2026-13-01T00:00:00Z", "2026-00-01T00:00:00Z",
        "2025-02-29T00:00:00Z", "2026-04-31T00:00:00Z", "2026-01-31T24:00:00Z", "2026-01-31T23:60:00Z",
        "2026-01-31T23:59:60Z", "+026-01-31T23:59:59Z", "2026-01-31T23:59:59Z "})
    EXPECT_FALSE(isDate(wrong)) << wrong;
  EXPECT_TRUE(isDate(presentDate())) << presentDate();
}

TEST(Dates, MoveOverMonthsLeapDaysAndYears) {
  EXPECT_EQ(shiftedDate("2024-02-28T23:59:59Z", 1), "2024-02-29T00:00:00Z");
  EXPECT_EQ(shiftedDate("2025-02-28T23:59:59Z", 1), "2025-03-01T00:00:00Z");
  EXPECT_EQ(shiftedDate("2026-01-01T00:00:00Z", -1), "2025-12-31T23:59:59Z");
  EXPECT_EQ(shiftedDate("2026-01-01T00:00:00.75Z", 60), "2026-01-01T00:01:00Z");
  for (const char* bad : {"", "2026-01-01", "2026-02-30T00:00:00Z", "2026-01-01T24:00:00Z", "2026-01-01T00:00:00",
                          "yesterday at noon, by the clock Z"})
    EXPECT_EQ(shiftedDate(bad, 1), "") << bad;
}

using Order = DateStyle::Order;

TEST(Dates, AreReadAsSpreadsheetsWriteThem) {
  const DateStyle universal{Order::unknown, 0};
  for (const auto& [written, meant] : {std::pair("2026-01-31T13:05:09Z", "2026-01-31T13:05:09Z"),
                                       {"2026-01-31 13:05", "2026-01-31T13:05:00Z"},
                                       {"2026-01-31T13:05:09.25+02:00", "2026-01-31T11:05:09Z"},
                                       {"31.1.2026 13:05", "2026-01-31T13:05:00Z"},
                                       {"3.4.2026", "2026-04-03T00:00:00Z"},
                                       {"31/01/2026", "2026-01-31T00:00:00Z"},
                                       {"1/31/2026 1:05 PM", "2026-01-31T13:05:00Z"},
                                       {"1/31/2026 12:05:01 am", "2026-01-31T00:05:01Z"},
                                       {"4/4/2026", "2026-04-04T00:00:00Z"},
                                       {"45957,5", "2025-10-27T12:00:00Z"},
                                       {"45957.25", "2025-10-27T06:00:00Z"},
                                       {"45957", "2025-10-27T00:00:00Z"}})
    EXPECT_EQ(readMoment(written, universal), meant) << written;
  EXPECT_EQ(readMoment("2026-07-01 00:30", {Order::unknown, 120}), "2026-06-30T22:30:00Z");
  EXPECT_EQ(readMoment("3/4/2026", {Order::dayFirst, 0}), "2026-04-03T00:00:00Z");
  EXPECT_EQ(readMoment("3/4/2026", {Order::monthFirst, 0}), "2026-03-04T00:00:00Z");
  EXPECT_EQ(readDay("45957", {}), "2025-10-27");
  EXPECT_EQ(readDay("27.10.2025", {}), "2025-10-27");
}

TEST(Dates, AreAskedAboutWhereTheyCouldBeTwo) {
  const auto asked = [](const char* word, const DateStyle& style) {
    try {
      readMoment(word, style);
    } catch (const Error& e) {
      EXPECT_NE(e.fault().find(word), std::string::npos);
      return e.remedies();
    }
    ADD_FAILURE() << word;
    return std::vector<Remedy>();
  };
  EXPECT_EQ(asked("3/4/2026", {Order::unknown, 0}), std::vector{Remedy::sayDates});
  EXPECT_EQ(asked("2026-01-31 13:05", {}), std::vector{Remedy::sayZone});
  EXPECT_EQ(asked("45957,5", {}), std::vector{Remedy::sayZone});
  for (const char* none : {"", "yesterday", "31.1.26", "31/13/2026", "29.2.2025", "2026-01-31T24:00",
                           "1/31/2026 13:05 PM", "0:05", "2026", "1e300", "2026-01-31T12:00:00+25:00"})
    EXPECT_TRUE(asked(none, {Order::unknown, 0}).empty()) << none;
  EXPECT_TRUE(asked("31/1/2026", {Order::monthFirst, 0}).empty());
}

TEST(Dates, OfZones) {
  EXPECT_EQ(readZone("Z"), 0);
  EXPECT_EQ(readZone("+02:00"), 120);
  EXPECT_EQ(readZone("-0530"), -330);
  EXPECT_EQ(readZone("+2"), 120);
  for (const char* none : {"", "CET", "2", "+15", "+1:", "+-1"}) EXPECT_FALSE(readZone(none)) << none;
}

}  // namespace
}  // namespace calot::recorder
