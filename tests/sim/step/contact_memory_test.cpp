// SPDX-License-Identifier: GPL-3.0-or-later
// What a step's contact problem knows from the steps before: forces that go on, compliance that was learned.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <Eigen/Cholesky>
#include <span>
#include <utility>
#include <vector>

#include "sim/math/linear.h"
#include "sim/math/random.h"
#include "sim/step/contact_block.h"
#include "sim/step/stages.h"

namespace calot {
namespace {

using Rows = Eigen::VectorXd;
using Matrix = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

std::span<const double> spanOf(const Rows& rows) { return {rows.data(), static_cast<std::size_t>(rows.size())}; }

Rows randomRows(std::size_t count, Random& random) {
  return Rows::NullaryExpr(static_cast<Eigen::Index>(count),
                           [&](Eigen::Index) { return 2.0 * random.uniform() - 1.0; });
}

/// Symmetric and positive definite.
Matrix randomCompliance(std::size_t count, Random& random) {
  const auto n = static_cast<Eigen::Index>(count);
  Matrix root(n, n);
  for (Eigen::Index j = 0; j < n; ++j) root.col(j) = randomRows(count, random);
  return root * root.transpose() + 0.1 * Matrix::Identity(n, n);
}

std::uint64_t keyOf(std::uint64_t capsule, std::uint64_t structure, std::uint64_t point) {
  return capsule << 56U | structure << structureShift | point;
}

/// An instrument's touch, with a frame of its own.
ContactBlock touch(std::size_t hand, std::uint64_t key, const Vec3& normal) {
  ContactBlock block;
  ToolOnTissue of;
  of.tool.hand = hand;
  block.of = of;
  block.key = key;
  block.limit = 10.0;
  const Mat3 frame = alongAxis(normal, Vec3::UnitX()).toRotationMatrix();
  block.direction = {normal, frame.col(0), frame.col(1)};
  return block;
}

ContactSystem systemOf(std::vector<ContactBlock> blocks, const Matrix& compliance) {
  ContactSystem contact;
  contact.blocks = std::move(blocks);
  contact.numberRows();
  contact.tissueCompliance.assign(compliance.data(), compliance.data() + compliance.size());
  return contact;
}

Eigen::Map<const Matrix> complianceOf(const ContactSystem& contact) {
  const auto n = static_cast<Eigen::Index>(contact.rows);
  return {contact.tissueCompliance.data(), n, n};
}

std::vector<ContactBlock> threeTouches() {
  return {touch(0, keyOf(0, 1, 7), Vec3::UnitZ()), touch(0, keyOf(1, 1, 8), Vec3::UnitX()),
          touch(1, keyOf(0, 1, 7), Vec3(0.6, 0.0, 0.8))};
}

TEST(LearnedCompliance, GivesTheMeasuredResponseAndStaysSymmetricAndPositive) {
  SCOPED_TRACE("seed 2101");
  Random random(2101);
  for (int trial = 0; trial < 50; ++trial) {
    ContactSystem contact = systemOf(threeTouches(), randomCompliance(9, random));
    const Rows change = randomRows(9, random);
    const Rows expected = complianceOf(contact) * change;
    const Rows response = randomCompliance(9, random) * change;
    correctCompliance(spanOf(change), spanOf(response), spanOf(expected), contact);
    const Matrix corrected = complianceOf(contact);
    EXPECT_LT((corrected * change - response).norm(), 1e-9 * response.norm());
    EXPECT_LT((corrected - corrected.transpose()).norm(), 1e-12 * corrected.norm());
    EXPECT_EQ(corrected.llt().info(), Eigen::Success);
  }
}

TEST(LearnedCompliance, IsOfThePlacesNotOfTheirOrderOrFrames) {
  SCOPED_TRACE("seed 2102");
  Random random(2102);
  const Rows change = randomRows(9, random);
  const Rows response = randomCompliance(9, random) * change;
  ContactSystem before = systemOf(threeTouches(), randomCompliance(9, random));
  learnResponse(spanOf(change), spanOf(response), before);

  std::vector<ContactBlock> blocks = threeTouches();
  std::rotate(blocks.begin(), blocks.begin() + 1, blocks.end());
  const Mat3 turn = Eigen::AngleAxisd(0.3, Vec3(1.0, 2.0, 3.0).normalized()).toRotationMatrix();
  for (ContactBlock& block : blocks) {
    for (Vec3& direction : block.direction) direction = turn * direction;
  }
  ContactSystem now = systemOf(blocks, randomCompliance(9, random));
  now.learned = before.learned;
  recallResponses(now);
  const auto inFrame = [&](const Rows& rows) {
    Rows out(9);
    for (const ContactBlock& to : now.blocks) {
      for (const ContactBlock& from : before.blocks) {
        if (from.key != to.key || from.tool()->hand != to.tool()->hand) continue;
        Vec3 sum = Vec3::Zero();
        for (std::size_t k = 0; k < 3; ++k) sum += rows[static_cast<Eigen::Index>(from.row + k)] * from.direction[k];
        for (std::size_t k = 0; k < 3; ++k) out[static_cast<Eigen::Index>(to.row + k)] = sum.dot(to.direction[k]);
      }
    }
    return out;
  };
  EXPECT_LT((complianceOf(now) * inFrame(change) - inFrame(response)).norm(), 1e-9 * response.norm());
}

TEST(LearnedCompliance, IsLeftAsideWhenThePlaceIsNoLongerTouched) {
  SCOPED_TRACE("seed 2103");
  Random random(2103);
  ContactSystem contact = systemOf(threeTouches(), randomCompliance(9, random));
  Rows change = Rows::Zero(9);
  change[0] = 1.0;
  learnResponse(spanOf(change), spanOf(randomRows(9, random)), contact);
  contact.blocks[0].key = keyOf(0, 1, 9);
  const std::vector<double> estimate = contact.tissueCompliance;
  recallResponses(contact);
  EXPECT_EQ(contact.tissueCompliance, estimate);
}

TEST(LearnedCompliance, LeavesPlacesThatAreNewAsTheyWereEstimated) {
  SCOPED_TRACE("seed 2104");
  Random random(2104);
  ContactSystem before = systemOf({threeTouches()[0]}, randomCompliance(3, random));
  const Rows change = randomRows(3, random);
  const Rows response = randomCompliance(3, random) * change;
  learnResponse(spanOf(change), spanOf(response), before);
  ContactSystem now = systemOf(threeTouches(), randomCompliance(9, random));
  now.learned = before.learned;
  Rows all = Rows::Zero(9);
  all.head(3) = change;
  const Rows estimated = complianceOf(now) * all;
  recallResponses(now);
  EXPECT_LT((complianceOf(now) * all - estimated).tail(6).norm(), 1e-9);
}

TEST(LearnedCompliance, ForgetsTheOldest) {
  SCOPED_TRACE("seed 2105");
  Random random(2105);
  ContactSystem contact = systemOf(threeTouches(), randomCompliance(9, random));
  for (int i = 0; i < 30; ++i) {
    const Rows change = randomRows(9, random);
    learnResponse(spanOf(change), spanOf(change), contact);
    ASSERT_TRUE(fits(contact.learned));
    const std::size_t points = contact.learned.points.size();
    EXPECT_LE(points, 8U);
    EXPECT_LT((contact.learned.force[3 * (points - 1)] -
               Vec3(change[0] * contact.blocks[0].direction[0] + change[1] * contact.blocks[0].direction[1] +
                    change[2] * contact.blocks[0].direction[2]))
                  .norm(),
              1e-15);
  }
  EXPECT_EQ(contact.learned.points.size(), 8U);
}

/// A State in which the left hand's capsule 0 pressed structure 1 at point 7.
State pressed(const Vec3& force) {
  State state;
  state.hand[0].touches.key = {keyOf(0, 1, 7)};
  state.hand[0].touches.force = {force};
  return state;
}

Vec3 carriedBy(const ContactSystem& contact, std::size_t block) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 0; k < 3; ++k)
    sum += contact.carried[contact.blocks[block].row + k] * contact.blocks[block].direction[k];
  return sum;
}

TEST(WarmStart, SlidingInstrumentKeepsItsForce) {
  const Vec3 force(0.1, -0.2, 0.7);
  ContactSystem contact;
  contact.blocks = {touch(0, keyOf(0, 1, 8), Vec3::UnitZ()), touch(0, keyOf(1, 1, 9), Vec3::UnitZ()),
                    touch(1, keyOf(0, 1, 8), Vec3::UnitZ()), touch(0, keyOf(0, 2, 8), Vec3::UnitZ())};
  loadWarmStart(pressed(force), contact);
  EXPECT_LT((carriedBy(contact, 0) - force).norm(), 1e-15);
  for (std::size_t other = 1; other < 4; ++other) EXPECT_TRUE(carriedBy(contact, other).isZero()) << other;
}

TEST(WarmStart, NewPointsTakeOverBeforeOldOnesAndTheDeepestOfThem) {
  const Vec3 force(0.0, 0.0, 0.7);
  State state = pressed(force);
  state.hand[0].touches.key.push_back(keyOf(0, 1, 5));
  state.hand[0].touches.force.emplace_back(0.0, 0.0, 0.1);
  ContactSystem contact;
  contact.blocks = {touch(0, keyOf(0, 1, 5), Vec3::UnitZ()), touch(0, keyOf(0, 1, 8), Vec3::UnitZ()),
                    touch(0, keyOf(0, 1, 9), Vec3::UnitZ())};
  contact.blocks[0].gap[0] = -3e-3;
  contact.blocks[1].gap[0] = -1e-3;
  contact.blocks[2].gap[0] = -2e-3;
  loadWarmStart(state, contact);
  EXPECT_DOUBLE_EQ(carriedBy(contact, 0)[2], 0.1);
  EXPECT_TRUE(carriedBy(contact, 1).isZero());
  EXPECT_DOUBLE_EQ(carriedBy(contact, 2)[2], 0.7);
}

TEST(WarmStart, TakesOverOnlyWhatTheNewPointAdmits) {
  ContactSystem contact;
  contact.blocks = {touch(0, keyOf(0, 1, 8), Vec3::UnitX())};
  contact.blocks[0].limit = 0.5;
  loadWarmStart(pressed(Vec3(0.2, 0.0, 0.7)), contact);
  EXPECT_DOUBLE_EQ(contact.carried[0], 0.2);
  EXPECT_NEAR(std::hypot(contact.carried[1], contact.carried[2]), 0.1, 1e-15);
  loadWarmStart(pressed(Vec3(-0.2, 0.0, 0.7)), contact);
  EXPECT_TRUE(carriedBy(contact, 0).isZero());
}

}  // namespace
}  // namespace calot
