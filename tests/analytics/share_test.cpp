// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/cohort_files.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "recorder/base/errors.h"

namespace calot::analytics {
namespace {

using Sized = std::vector<std::pair<std::uint64_t, std::string>>;

/// A few recordings of a whole operation among many short exercises.
Sized randomFiles(std::mt19937_64& random, std::size_t count) {
  Sized files;
  for (std::size_t i = 0; i < count; ++i)
    files.emplace_back(random() % 50 == 0 ? 10'000 + random() % 10'000 : 50 + random() % 400,
                       fmt::format("{:016x}", random()));
  return files;
}

TEST(Shares, HoldEachFileOnceAndAreEven) {
  std::mt19937_64 random(5);
  for (const std::size_t count : {0U, 1U, 7U, 500U, 3001U}) {
    const Sized files = randomFiles(random, count);
    for (const std::uint32_t of : {1U, 2U, 7U, 64U, 1000U}) {
      std::set<std::size_t> seen;
      std::size_t fewest = count, most = 0;
      std::uint64_t total = 0, largest = 0;
      for (std::uint32_t number = 1; number <= of; ++number) {
        const std::vector<std::size_t> share = indicesOf({number, of}, files);
        EXPECT_TRUE(std::is_sorted(share.begin(), share.end()));
        std::uint64_t own = 0;
        for (const std::size_t i : share) {
          EXPECT_TRUE(seen.insert(i).second);
          own += files[i].first;
        }
        fewest = std::min(fewest, share.size());
        most = std::max(most, share.size());
        total += own;
        largest = std::max(largest, own);
      }
      EXPECT_EQ(seen.size(), count);
      EXPECT_LE(most - fewest, 1U);
      EXPECT_LE(largest, total / of + 20'000 + 450);  // dealt by size: the mean and one long recording at most
    }
  }
}

TEST(Shares, DependOnTheListAlone) {
  std::mt19937_64 random(6);
  Sized files = randomFiles(random, 200);
  const auto namesOf = [&] {
    std::vector<std::set<std::string>> names;
    for (std::uint32_t number = 1; number <= 8; ++number) {
      std::set<std::string>& own = names.emplace_back();
      for (const std::size_t i : indicesOf({number, 8}, files)) own.insert(files[i].second);
    }
    return names;
  };
  const auto before = namesOf();
  std::reverse(files.begin(), files.end());
  EXPECT_EQ(namesOf(), before);
}

TEST(Shares, Names) {
  EXPECT_EQ(shareNamed("3/8"), (Share{3, 8}));
  for (const char* wrong :
       {"", "3", "0/8", "9/8", "3/0", "3/8x", " 3/8", "-1/8", "3//8", "4294967297/4294967298", "1/1000001"})
    EXPECT_THROW(shareNamed(wrong), Error) << wrong;
}

}  // namespace
}  // namespace calot::analytics
