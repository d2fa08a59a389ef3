// SPDX-License-Identifier: GPL-3.0-or-later
#include "analytics/shards/shard.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "recorder/base/errors.h"

namespace calot::analytics {
namespace {

std::vector<Dealt> randomCohort(std::mt19937_64& random, std::size_t count) {
  std::vector<Dealt> list;
  for (std::size_t i = 0; i < count; ++i) {
    // A few recordings of the whole operation among thousands of short exercises.
    const bool whole = random() % 50 == 0;
    list.push_back({whole ? "cholecystectomy/3 18" : fmt::format("exercise/{} 18", random() % 3),
                    whole ? 10'000 + random() % 10'000 : 50 + random() % 400, fmt::format("{:08x}", random())});
  }
  return list;
}

TEST(Shards, EachRecordingIsInOneShareAndSharesAreEven) {
  std::mt19937_64 random(5);
  for (const std::size_t count : {0U, 1U, 7U, 500U, 3001U}) {
    const std::vector<Dealt> cohort = randomCohort(random, count);
    for (const std::uint32_t shares : {1U, 2U, 7U, 64U, 1000U}) {
      const auto dealt = deal(cohort, shares);
      ASSERT_EQ(dealt.size(), shares);
      std::set<std::size_t> seen;
      std::size_t least = count, most = 0;
      std::uint64_t steps = 0, mostSteps = 0;
      for (const std::vector<std::size_t>& share : dealt) {
        EXPECT_TRUE(std::is_sorted(share.begin(), share.end()));
        std::uint64_t own = 0;
        for (const std::size_t i : share) {
          EXPECT_TRUE(seen.insert(i).second);
          own += cohort[i].size;
        }
        least = std::min(least, share.size());
        most = std::max(most, share.size());
        steps += own;
        mostSteps = std::max(mostSteps, own);
      }
      EXPECT_EQ(seen.size(), count);
      EXPECT_LE(most - least, 1U);
      // Dealt by size, no share exceeds the mean by more than the longest recording of each of the four kinds.
      EXPECT_LE(mostSteps, steps / shares + 20'000 + 3 * 450 + 1);
    }
  }
}

TEST(Shards, DealingDependsOnTheListAlone) {
  std::mt19937_64 random(6);
  std::vector<Dealt> cohort = randomCohort(random, 200);
  const auto dealt = deal(cohort, 8);
  EXPECT_EQ(deal(cohort, 8), dealt);
  const auto namesOf = [&](const std::vector<std::vector<std::size_t>>& shares) {
    std::vector<std::set<std::string>> names;
    for (const auto& share : shares) {
      std::set<std::string>& own = names.emplace_back();
      for (const std::size_t i : share) own.insert(cohort[i].name);
    }
    return names;
  };
  const auto before = namesOf(dealt);
  std::reverse(cohort.begin(), cohort.end());
  EXPECT_EQ(namesOf(deal(cohort, 8)), before);
}

TEST(Shards, DigestTellsListsFromEachOther) {
  const std::vector<Dealt> list{{"a", 1, "x"}, {"a", 2, "y"}};
  EXPECT_EQ(digestOf(list).size(), 16U);
  EXPECT_EQ(digestOf(list), digestOf({{"a", 1, "x"}, {"a", 2, "y"}}));
  EXPECT_NE(digestOf(list), digestOf({{"a", 1, "x"}, {"a", 3, "y"}}));
  EXPECT_NE(digestOf(list), digestOf({{"a", 2, "y"}, {"a", 1, "x"}}));
  EXPECT_NE(digestOf(list), digestOf({{"a", 1, "x"}}));
}

TEST(Shards, Names) {
  EXPECT_EQ(shardNamed("3/8"), (Shard{3, 8}));
  for (const char* wrong :
       {"", "3", "0/8", "9/8", "3/0", "3/8x", " 3/8", "-1/8", "3//8", "4294967297/4294967298", "1/1000001"})
    EXPECT_THROW(shardNamed(wrong), Error) << wrong;
}

}  // namespace
}  // namespace calot::analytics
