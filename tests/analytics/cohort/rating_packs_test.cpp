// SPDX-License-Identifier: GPL-3.0-or-later
// Packs for raters: what is drawn, and what is stored.
#include "analytics/cohort/blinding.h"

#include <gtest/gtest.h>

#include <set>
#include <string>
#include <vector>

#include "recorder/base/errors.h"
#include "tests/analytics/cohort/support/cohort_support.h"

namespace calot::analytics {
namespace {

TEST(RatingPacks, eachRaterHasNamesAnOrderAndAKeyOfTheirOwn) {
  std::vector<std::string> attempts;
  for (int i = 0; i < 40; ++i) attempts.push_back("attempt " + std::to_string(i));
  const RatingPack pack = drawRatingPack({"goals", 1, std::string(64, 'a'), "{}"}, {"R1", "R2"}, attempts);
  ASSERT_EQ(pack.raters.size(), 2U);
  std::set<std::string> names;
  std::vector<std::vector<std::string>> orders;
  for (const PackedRater& rater : pack.raters) {
    std::vector<std::string> order;
    for (const PackedFilm& film : rater.films) {
      EXPECT_TRUE(names.insert(film.name).second) << film.name;
      order.push_back(film.attempt);
    }
    EXPECT_NE(order, attempts);  // by chance with a probability of 1 / 40!
    EXPECT_EQ(std::set<std::string>(order.begin(), order.end()),
              std::set<std::string>(attempts.begin(), attempts.end()));
    orders.push_back(order);
  }
  EXPECT_NE(orders[0], orders[1]);
  EXPECT_NE(pack.id, drawRatingPack(pack.form, {"R1"}, attempts).id);
}

TEST(AnalysisLocks, aMaskIsDrawnOnceAndALockStays) {
  const support::Folder folder;
  const std::string path = folder.file("c.db"), protocol(64, '1'), other(64, '2');
  CohortDatabase(path, CohortDatabase::Access::create);
  EXPECT_FALSE(readGroupMask(path, protocol));
  const bool swapped = drawGroupMask(path, protocol);
  for (int i = 0; i < 20; ++i) EXPECT_EQ(drawGroupMask(path, protocol), swapped);
  EXPECT_EQ(readGroupMask(path, protocol), swapped);
  EXPECT_FALSE(readGroupMask(path, other));

  bool added = false;
  AnalysisLock lock{protocol, "p version 1", "key: any\n", std::string(64, 'b'), "calot", "", "me"};
  EXPECT_EQ(storeAnalysisLock(path, lock, added).by, "me");
  EXPECT_TRUE(added);
  lock.by = "another";
  lock.valuesSha256 = std::string(64, 'c');
  const AnalysisLock kept = storeAnalysisLock(path, lock, added);
  EXPECT_FALSE(added);
  EXPECT_EQ(kept.by, "me");
  EXPECT_EQ(readAnalysisLock(path, protocol)->valuesSha256, std::string(64, 'b'));
  EXPECT_FALSE(readAnalysisLock(path, other));
  lock.by.clear();
  EXPECT_THROW(storeAnalysisLock(path, lock, added), Error);
}

}  // namespace
}  // namespace calot::analytics
