// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/film/look_ahead.h"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <string>

namespace calot::gui {
namespace {

TEST(LookAhead, GivesEverythingInOrder) {
  LookAhead<std::uint64_t> numbers(100, [](std::uint64_t k) { return 3 * k; });
  for (std::uint64_t k = 0; k < 100; ++k) ASSERT_EQ(numbers.next(), 3 * k);
}

TEST(LookAhead, ThrowsWhereMakingThrewAndNotBefore) {
  LookAhead<int> numbers(10, [](std::uint64_t k) {
    if (k == 3) throw std::runtime_error("the fourth");
    return static_cast<int>(k);
  });
  for (int k = 0; k < 3; ++k) EXPECT_EQ(numbers.next(), k);
  for (int again = 0; again < 2; ++again) {
    try {
      (void)numbers.next();
      FAIL();
    } catch (const std::runtime_error& error) {
      EXPECT_EQ(std::string(error.what()), "the fourth");
    }
  }
}

TEST(LookAhead, StaysAFewAheadAndEndsWhenNobodyTakes) {
  std::atomic<int> made{0};
  {
    LookAhead<int> numbers(1000, [&](std::uint64_t k) {
      ++made;
      return static_cast<int>(k);
    });
    EXPECT_EQ(numbers.next(), 0);
  }
  EXPECT_LE(made.load(), 7) << "four ready, one taken, one in the making";
}

}  // namespace
}  // namespace calot::gui
