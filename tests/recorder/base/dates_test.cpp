// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/base/dates.h"

#include <gtest/gtest.h>

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

}  // namespace
}  // namespace calot::recorder
