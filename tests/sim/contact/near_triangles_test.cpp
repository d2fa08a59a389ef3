// SPDX-License-Identifier: GPL-3.0-or-later
// Lists of near triangles, young, old or none: the contacts are the same, bit for bit.
#include "sim/contact/surface_surface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdio>
#include <span>
#include <utility>
#include <vector>

#include "sim/math/random.h"
#include "tests/sim/contact/support/body.h"
#include "tests/sim/scene/support/scenes.h"

namespace calot {
namespace {

using test::Body;

constexpr double reach = 4e-5;  // m, as in a step

/// As a step asks: patches in play, their bounds through the grid.
std::vector<BroadPhase::Pair> pairsOf(const SurfacePair& pair, const Body& a, std::span<const Vec3> positionA,
                                      const Body& b, std::span<const Vec3> positionB) {
  std::vector<std::uint32_t> play;
  SurfaceDisplacement movedA;
  SurfaceDisplacement movedB;
  measureDisplacement(a.surface, positionA, pair.vertexRest(), movedA);
  measureDisplacement(b.surface, positionB, pair.triangleRest(), movedB);
  patchesInPlay(pair, movedA, movedB, reach, play);
  SortedGrid grid(0.02);
  std::vector<Box> boxes;
  patchBounds(b.surface, positionB, 0.0, boxes);
  grid.update(boxes);
  patchBounds(a.surface, positionA, 0.0, boxes);
  std::vector<Box> queries;
  for (const std::uint32_t p : play) {
    queries.push_back(boxes[p]);
    queries.back().grow(pair.search(p, reach));
  }
  std::vector<BroadPhase::Pair> pairs;
  grid.pairs(queries, pairs);
  for (BroadPhase::Pair& p : pairs) p.query = play[p.query];
  return pairs;
}

std::vector<BroadPhase::Pair> allPairs(const Body& a, const Body& b) {
  std::vector<BroadPhase::Pair> pairs;
  for (std::uint32_t p = 0; p < a.surface.patches().size(); ++p) {
    for (std::uint32_t q = 0; q < b.surface.patches().size(); ++q) pairs.push_back({p, q});
  }
  return pairs;
}

std::vector<std::uint64_t> bitsOf(const VertexContact& c) {
  std::vector<std::uint64_t> bits{static_cast<std::uint64_t>(c.vertex), c.key};
  for (const int n : c.node) bits.push_back(static_cast<std::uint64_t>(n));
  for (const double x : {c.weight[0], c.weight[1], c.weight[2], c.normal[0], c.normal[1], c.normal[2], c.gap}) {
    bits.push_back(std::bit_cast<std::uint64_t>(x));
  }
  return bits;
}

bool same(const std::vector<VertexContact>& x, const std::vector<VertexContact>& y) {
  return std::equal(x.begin(), x.end(), y.begin(), y.end(),
                    [](const VertexContact& c, const VertexContact& d) { return bitsOf(c) == bitsOf(d); });
}

/// Holds warm lists, cold ones and none against each other. @return how many contacts there are
std::size_t agree(const SurfacePair& pair, const Body& a, std::span<const Vec3> positionA, const Body& b,
                  std::span<const Vec3> positionB, NearTriangles& warm) {
  const std::vector<BroadPhase::Pair> pairs = pairsOf(pair, a, positionA, b, positionB);
  std::vector<VertexContact> plain;
  surfaceContacts(pair, a.surface, positionA, b.surface, positionB, pairs, reach, plain);
  std::vector<VertexContact> remembered;
  surfaceContacts(pair, a.surface, positionA, b.surface, positionB, pairs, reach, remembered, &warm);
  // The cold ones are asked everything, as a broad phase may that knows nothing.
  NearTriangles cold;
  std::vector<VertexContact> fresh;
  surfaceContacts(pair, a.surface, positionA, b.surface, positionB, allPairs(a, b), reach, fresh, &cold);
  EXPECT_TRUE(same(plain, remembered)) << plain.size() << " and " << remembered.size();
  EXPECT_TRUE(same(plain, fresh)) << plain.size() << " and " << fresh.size();
  return plain.size();
}

/// A motion and deformation that wanders: each parameter goes a random step of a given size, and is drawn back to its
/// middle.
class Wander {
 public:
  Wander(Random& random, double step) : random_(random), step_(step) {}

  void goOn() {
    for (int a = 0; a < 3; ++a) {
      shift_[a] += 0.002 * step_ * random_.normal() - 0.01 * shift_[a];
      turn_[a] += 0.1 * step_ * random_.normal() - 0.01 * turn_[a];
      wave_[a] += 0.001 * step_ * random_.normal() - 0.02 * wave_[a];
    }
    fold_ += 0.25 * step_ * random_.normal() + 0.02 * (3.5 - fold_);
    crush_ += 0.1 * step_ * random_.normal() + 0.02 * (1.0 - crush_);
  }
  void startAt(double fold, const Vec3& shift) {
    fold_ = fold;
    shift_ = shift;
  }

  /// @param bend half the length of what is bent about the y axis, along x (m); 0: nothing
  [[nodiscard]] std::vector<Vec3> apply(std::span<const Vec3> rest, double bend) const {
    std::vector<Vec3> out(rest.begin(), rest.end());
    const Quat turn = Quat(1.0, turn_[0], turn_[1], turn_[2]).normalized();
    for (Vec3& p : out) {
      for (int a = 0; a < 3; ++a) p[a] += wave_[a] * std::sin(150.0 * p[(a + 1) % 3] + 60.0 * p[(a + 2) % 3]);
      p[2] *= crush_;
      if (bend > 0.0 && std::abs(fold_) > 1e-3) {
        const double radius = 2.0 * bend / fold_;
        const double bent = std::clamp(p[0], -bend, bend);
        const double t = bent / radius;
        const double straight = p[0] - bent;
        p = Vec3((radius - p[2]) * std::sin(t) + straight * std::cos(t), p[1],
                 radius - (radius - p[2]) * std::cos(t) + straight * std::sin(t));
      }
      p = turn * p + shift_;
    }
    return out;
  }

 private:
  Random& random_;
  double step_;
  double fold_ = 0.0;
  double crush_ = 1.0;
  Vec3 shift_ = Vec3::Zero();
  Vec3 turn_ = Vec3::Zero();
  Vec3 wave_ = Vec3::Zero();
};

constexpr std::array<double, 4> paces{0.01, 0.1, 0.5, 3.0};

TEST(NearTriangles, ASheetThatFoldsOntoItself) {
  SCOPED_TRACE("seed 771");
  Random random(771);
  const Body sheet(test::boxSurface(Vec3(-0.03, -0.01, 0.0), Vec3(0.03, 0.01, 0.003), {24, 8, 2}));
  const SurfacePair pair(sheet.surface, sheet.skin.vertex);
  for (const double pace : paces) {
    NearTriangles warm;
    Wander wander(random, pace);
    wander.startAt(3.6, Vec3::Zero());
    std::size_t found = 0;
    constexpr std::size_t steps = 40;
    for (std::size_t step = 0; step < steps; ++step) {
      wander.goOn();
      const std::vector<Vec3> at = wander.apply(sheet.skin.vertex, 0.01);
      found += agree(pair, sheet, at, sheet, at, warm);
      ASSERT_FALSE(::testing::Test::HasFailure()) << "pace " << pace << ", step " << step;
      if (step == steps / 2) warm.reset();
    }
    std::printf("pace %g: %zu contacts, %zu patches renewed, %zu vertices searched, %zu triangles looked at\n", pace,
                found, warm.counts().rebuilt, warm.counts().searched, warm.counts().tested);
    EXPECT_GT(found, 0U);
    EXPECT_GT(warm.counts().tested, 0U);
    if (pace == paces.front()) {
      EXPECT_LT(warm.counts().rebuilt, 6 * sheet.surface.patches().size()) << "old lists were used";
    }
  }
}

TEST(NearTriangles, ABallThatRollsIntoABentPlate) {
  SCOPED_TRACE("seed 772");
  Random random(772);
  const Body ball(test::sphereSurface(Vec3::Zero(), 0.012, 8));
  const Body plate(test::boxSurface(Vec3(-0.03, -0.03, -0.008), Vec3(0.03, 0.03, 0.008), {14, 14, 4}));
  // At rest in one another: some vertices have an offset, and a search that goes farther.
  for (const bool overlapping : {false, true}) {
    std::vector<Vec3> rest = ball.skin.vertex;
    for (Vec3& p : rest) p[2] += overlapping ? 0.017 : 0.03;
    const SurfacePair down(ball.surface, rest, plate.surface, plate.skin.vertex);
    const SurfacePair up(plate.surface, plate.skin.vertex, ball.surface, rest);
    for (const double pace : paces) {
      NearTriangles warmDown;
      NearTriangles warmUp;
      Wander ballWander(random, pace);
      Wander plateWander(random, pace);
      ballWander.startAt(0.0, Vec3(0.0, 0.0, 0.016));
      std::size_t found = 0;
      for (std::size_t step = 0; step < 60; ++step) {
        ballWander.goOn();
        plateWander.goOn();
        const std::vector<Vec3> a = ballWander.apply(ball.skin.vertex, 0.0);
        const std::vector<Vec3> b = plateWander.apply(plate.skin.vertex, 0.0);
        found += agree(down, ball, a, plate, b, warmDown);
        found += agree(up, plate, b, ball, a, warmUp);
        ASSERT_FALSE(::testing::Test::HasFailure()) << "pace " << pace << ", step " << step;
      }
      std::printf("pace %g: %zu contacts, %zu patches renewed\n", pace, found, warmDown.counts().rebuilt);
      EXPECT_GT(found, 0U);
    }
  }
}

/// Triangles drawn out to slivers and to points, and jumps: the lists' distances hold for them too.
TEST(NearTriangles, CrumpledSurfaces) {
  SCOPED_TRACE("seed 773");
  Random random(773);
  const Body ball(test::sphereSurface(Vec3::Zero(), 0.02, 9));
  const SurfacePair pair(ball.surface, ball.skin.vertex);
  NearTriangles warm;
  std::size_t found = 0;
  std::vector<Vec3> target = ball.skin.vertex;
  std::vector<Vec3> at = target;
  for (int step = 0; step < 150; ++step) {
    if (step % 15 == 0) {
      const double flat = random.uniform(0.0, 0.5);
      const double noise = random.uniform(0.0, 0.003);
      for (std::size_t v = 0; v < target.size(); ++v) {
        target[v] = ball.skin.vertex[v] + noise * Vec3(random.normal(), random.normal(), random.normal());
        target[v][2] *= flat;
        if (step % 45 == 30) target[v][0] = 0.004 * std::round(target[v][0] / 0.004);  // edges of no length
      }
    }
    for (std::size_t v = 0; v < at.size(); ++v) at[v] += 0.2 * (target[v] - at[v]);
    if (step % 45 == 44) at = target;
    found += agree(pair, ball, at, ball, at, warm);
    ASSERT_FALSE(::testing::Test::HasFailure()) << "step " << step;
  }
  std::printf("%zu contacts, %zu patches renewed in 150 steps\n", found, warm.counts().rebuilt);
  EXPECT_GT(found, 100U);
}

TEST(NearTriangles, SmallMotionsNeedNoSearch) {
  SCOPED_TRACE("seed 774");
  Random random(774);
  const Body sheet(test::boxSurface(Vec3(-0.03, -0.01, 0.0), Vec3(0.03, 0.01, 0.002), {30, 10, 1}));
  const SurfacePair pair(sheet.surface, sheet.skin.vertex);
  Wander bent(random, 0.0);
  bent.startAt(2.2, Vec3::Zero());
  const std::vector<Vec3> shape = bent.apply(sheet.skin.vertex, 0.01);
  NearTriangles warm;
  EXPECT_EQ(agree(pair, sheet, shape, sheet, shape, warm), 0U);
  const std::size_t first = warm.counts().rebuilt;
  EXPECT_GT(first, 5U) << "far from rest, so lists are made";
  for (int step = 0; step < 3; ++step) agree(pair, sheet, shape, sheet, shape, warm);
  EXPECT_GT(warm.counts().rebuilt, first) << "those that live for a third of the patches at a time,";
  EXPECT_LE(warm.counts().rebuilt, 3 * first) << "and once for each";
  const std::size_t settled = warm.counts().rebuilt;
  const std::size_t looked = warm.counts().tested;
  for (int step = 1; step <= 100; ++step) {
    std::vector<Vec3> at = shape;
    const Quat turn = Quat(1.0, 0.0, 0.0001 * step, 0.0).normalized();
    for (Vec3& p : at) {
      p = turn * p + Vec3(0.002 * step, 0.0, 0.0);  // carried 20 cm: displaced far, but not against one another
      p += 0.0001 * Vec3(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0));
    }
    EXPECT_EQ(agree(pair, sheet, at, sheet, at, warm), 0U);
  }
  EXPECT_EQ(warm.counts().rebuilt, settled) << "the lists hold";
  EXPECT_EQ(warm.counts().tested, looked) << "and nothing in them is near enough to be looked at";
  // Forgotten, they are made anew.
  warm.reset();
  EXPECT_EQ(warm.counts().rebuilt, 0U);
  agree(pair, sheet, shape, sheet, shape, warm);
  EXPECT_EQ(warm.counts().rebuilt, first);
}

/// Up to a tenth of a turn is told from the places; whatever they are, it stays rigid.
TEST(RigidMotion, IsToldFromPlaces) {
  SCOPED_TRACE("seed 776");
  Random random(776);
  const auto place = [&](double size) -> Vec3 {
    return size * Vec3(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0));
  };
  for (int i = 0; i < 200; ++i) {
    const double angle = random.uniform(0.0, 0.6);
    const Vec3 axis = place(1.0).normalized();
    const Quat turn(Eigen::AngleAxisd(angle, axis));
    const Vec3 shift = place(0.1);
    std::vector<Vec3> was(static_cast<std::size_t>(4 + i % 20));
    std::vector<Vec3> now;
    for (Vec3& p : was) p = place(0.03);
    for (const Vec3& p : was) now.push_back(turn * p + shift);
    const RigidMotion found(was, now);
    for (const Vec3& p : was) EXPECT_LT((found.rotation * p + found.shift - (turn * p + shift)).norm(), 3e-4) << angle;
  }
  const std::vector<Vec3> line{Vec3::Zero(), Vec3::UnitX(), 2.0 * Vec3::UnitX()};
  const std::vector<Vec3> other{Vec3::Zero(), Vec3::UnitY(), -3.0 * Vec3::UnitZ()};
  for (const auto& [was, now] : {std::pair{line, line}, std::pair{line, other}, std::pair{other, line},
                                 std::pair{std::vector<Vec3>{Vec3::UnitX()}, std::vector<Vec3>{Vec3::UnitZ()}},
                                 std::pair{line, std::vector<Vec3>(3, Vec3::Constant(1e200))}}) {
    const RigidMotion found(was, now);
    EXPECT_LT((found.rotation * found.rotation.transpose() - Mat3::Identity()).norm(), 1e-12);
    EXPECT_GT(found.rotation.determinant(), 0.0);
  }
}

/// What all near turn by together displaces nothing: lists live on until the rotation is a large one.
TEST(NearTriangles, ListsLiveWhileAllTurns) {
  const Body sheet(test::boxSurface(Vec3(-0.03, -0.01, 0.0), Vec3(0.03, 0.01, 0.002), {30, 10, 1}));
  const SurfacePair pair(sheet.surface, sheet.skin.vertex);
  Random random(775);
  Wander bent(random, 0.0);
  bent.startAt(2.2, Vec3::Zero());
  std::vector<Vec3> at = bent.apply(sheet.skin.vertex, 0.01);
  NearTriangles warm;
  agree(pair, sheet, at, sheet, at, warm);
  const std::size_t first = warm.counts().rebuilt;
  const Quat turn = Quat(1.0, 0.03, 0.04, 0.0).normalized();  // a tenth of a radian a step
  for (int step = 0; step < 100; ++step) {
    for (Vec3& p : at) p = turn * p;
    agree(pair, sheet, at, sheet, at, warm);
  }
  std::printf("%zu lists, renewed %zu times in 100 steps\n", first, warm.counts().rebuilt);
  EXPECT_LT(warm.counts().rebuilt, 40 * first);
}

}  // namespace
}  // namespace calot
