// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/contact/surface_surface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "sim/geometry/surface_distance.h"
#include "sim/math/random.h"
#include "tests/sim/contact/support/body.h"
#include "tests/sim/scene/support/scenes.h"

namespace calot {
namespace {

using test::Body;

/// Through the broad phase, as a step does it.
std::vector<VertexContact> contacts(const SurfacePair& pair, const Body& a, std::span<const Vec3> positionA,
                                    const Body& b, std::span<const Vec3> positionB, double reach) {
  SortedGrid grid(0.02);
  std::vector<Box> boxes;
  patchBounds(b.surface, positionB, 0.0, boxes);
  grid.update(boxes);
  std::vector<Box> queries;
  patchBounds(a.surface, positionA, 0.0, queries);
  for (std::uint32_t p = 0; p < queries.size(); ++p) queries[p].grow(pair.search(p, reach));
  std::vector<BroadPhase::Pair> pairs;
  grid.pairs(queries, pairs);
  std::vector<VertexContact> out;
  surfaceContacts(pair, a.surface, positionA, b.surface, positionB, pairs, reach, out);
  // Asking for the patches in play alone changes nothing.
  std::vector<std::uint32_t> play;
  SurfaceDisplacement movedA;
  SurfaceDisplacement movedB;
  measureDisplacement(a.surface, positionA, pair.vertexRest(), movedA);
  measureDisplacement(b.surface, positionB, pair.triangleRest(), movedB);
  patchesInPlay(pair, movedA, movedB, reach, play);
  std::vector<VertexContact> fewer;
  std::erase_if(pairs,
                [&](const BroadPhase::Pair& p) { return !std::binary_search(play.begin(), play.end(), p.query); });
  surfaceContacts(pair, a.surface, positionA, b.surface, positionB, pairs, reach, fewer);
  EXPECT_EQ(out.size(), fewer.size());
  for (std::size_t i = 0; i < std::min(out.size(), fewer.size()); ++i) {
    EXPECT_EQ(out[i].key, fewer[i].key);
    EXPECT_EQ(out[i].gap, fewer[i].gap);
  }
  return out;
}

std::vector<Vec3> moved(std::span<const Vec3> points, const Vec3& by) {
  std::vector<Vec3> out(points.begin(), points.end());
  for (Vec3& p : out) p += by;
  return out;
}

double least(const std::vector<VertexContact>& found) {
  double gap = 1e9;
  for (const VertexContact& c : found) gap = std::min(gap, c.gap);
  return gap;
}

Vec3 footOf(const VertexContact& c, std::span<const Vec3> position) {
  Vec3 foot = Vec3::Zero();
  for (std::size_t k = 0; k < 3; ++k)
    foot += c.weight[static_cast<int>(k)] * position[static_cast<std::size_t>(c.node[k])];
  return foot;
}

TEST(SurfaceSurface, ABoxAboveABoxCountsItsCorners) {
  const Body below(test::boxSurface(Vec3(-0.03, -0.03, -0.02), Vec3(0.03, 0.03, 0.0), {6, 6, 2}));
  const Body above(test::boxSurface(Vec3(-0.0101, -0.0102, 0.01), Vec3(0.0103, 0.0104, 0.03), {2, 2, 2}));
  const SurfacePair pair(above.surface, above.skin.vertex, below.surface, below.skin.vertex);
  for (const double offset : pair.restOffset()) EXPECT_EQ(offset, 0.0);
  for (const double gap : {0.0009, 0.0001, -0.0005, -0.0049}) {
    const std::vector<Vec3> at = moved(above.skin.vertex, Vec3(0.0, 0.0, gap - 0.01));
    const std::vector<VertexContact> found = contacts(pair, above, at, below, below.skin.vertex, 0.001);
    ASSERT_FALSE(found.empty()) << gap;
    for (const VertexContact& c : found) {
      EXPECT_NEAR(c.gap, gap, 1e-12);
      EXPECT_LT((c.normal - Vec3::UnitZ()).norm(), 1e-9) << "outward on either side";
      const Vec3& v = at[static_cast<std::size_t>(c.vertex)];
      EXPECT_LT((footOf(c, below.skin.vertex) + c.gap * c.normal - v).norm(), 1e-9);
    }
    for (std::size_t i = 1; i < found.size(); ++i) EXPECT_LT(found[i - 1].key, found[i].key);
  }
  EXPECT_TRUE(
      contacts(pair, above, moved(above.skin.vertex, Vec3(0.0, 0.0, -0.0089)), below, below.skin.vertex, 0.001).empty())
      << "beyond reach";
  const std::vector<Vec3> deep = moved(above.skin.vertex, Vec3(0.0, 0.0, -0.0152));
  EXPECT_TRUE(contacts(pair, above, deep, below, below.skin.vertex, 0.001).empty()) << "deeper than is looked";
}

TEST(SurfaceSurface, AThinSheetHasTwoSides) {
  const Body sheet(test::boxSurface(Vec3(-0.03, -0.03, -0.001), Vec3(0.03, 0.03, 0.001), {8, 8, 1}));
  const Body ball(test::sphereSurface(Vec3(0.0, 0.0, 0.03), 0.01, 4));
  const SurfacePair pair(ball.surface, ball.skin.vertex, sheet.surface, sheet.skin.vertex);
  for (const double side : {1.0, -1.0}) {
    for (const double gap : {0.0005, 0.0001}) {
      std::vector<Vec3> at = moved(ball.skin.vertex, Vec3(0.0, 0.0, -0.03 + side * (0.011 + gap)));
      const std::vector<VertexContact> found = contacts(pair, ball, at, sheet, sheet.skin.vertex, 0.001);
      ASSERT_FALSE(found.empty());
      for (const VertexContact& c : found) {
        EXPECT_GT(c.gap, 0.0);
        EXPECT_LT((c.normal - side * Vec3::UnitZ()).norm(), 1e-6);
      }
    }
  }
}

TEST(SurfaceSurface, TwoSpheresTouchAtOnePlace) {
  // Vertices at the poles meet: the gap is exact.
  const Body a(test::sphereSurface(Vec3(0.0, 0.0, 0.0), 0.015, 6));
  const Body b(test::sphereSurface(Vec3(0.0, 0.0, 0.05), 0.015, 6));
  const SurfacePair up(a.surface, a.skin.vertex, b.surface, b.skin.vertex);
  const SurfacePair down(b.surface, b.skin.vertex, a.surface, a.skin.vertex);
  for (const double gap : {0.0008, -0.0004, -0.003}) {
    const std::vector<Vec3> at = moved(b.skin.vertex, Vec3(0.0, 0.0, -0.02 + gap));
    const std::vector<VertexContact> fromA = contacts(up, a, a.skin.vertex, b, at, 0.001);
    const std::vector<VertexContact> fromB = contacts(down, b, at, a, a.skin.vertex, 0.001);
    EXPECT_NEAR(least(fromA), gap, 0.05 * 0.003) << "facets are flatter than the sphere";
    EXPECT_NEAR(least(fromA), least(fromB), 1e-12) << "the scene is symmetric";
    const auto deepest =
        std::min_element(fromA.begin(), fromA.end(), [](const auto& x, const auto& y) { return x.gap < y.gap; });
    EXPECT_LT(deepest->normal[2], -0.9) << "from b's surface towards a's vertex";
  }
}

/// Against the signed distance, vertex by vertex.
TEST(SurfaceSurface, AgreesWithTheSignedDistance) {
  SCOPED_TRACE("seed 331");
  Random random(331);
  const Body a(test::sphereSurface(Vec3::Zero(), 0.012, 7));
  SurfaceDescription bent = test::boxSurface(Vec3(-0.03, -0.03, -0.004), Vec3(0.03, 0.03, 0.004), {12, 12, 2});
  for (Vec3& p : bent.vertex) p[2] += 0.005 * std::sin(120.0 * p[0]) * std::cos(90.0 * p[1]);
  const Body b(bent);
  const SurfaceDistance distance(TriangleMesh{b.skin.vertex, b.skin.triangle}, InsideRule::pseudonormal);
  const SurfacePair pair(a.surface, moved(a.skin.vertex, Vec3(1.0, 0.0, 0.0)), b.surface, b.skin.vertex);
  constexpr double reach = 0.002;
  int inside = 0;
  int outside = 0;
  for (int trial = 0; trial < 60; ++trial) {
    std::vector<Vec3> at = moved(
        a.skin.vertex, Vec3(random.uniform(-0.02, 0.02), random.uniform(-0.02, 0.02), random.uniform(-0.02, 0.02)));
    for (Vec3& p : at) p += 0.0003 * Vec3(random.normal(), random.normal(), random.normal());
    const std::vector<VertexContact> found = contacts(pair, a, at, b, b.skin.vertex, reach);
    double expected = reach;
    for (std::size_t v = 0; v < at.size(); ++v) {
      const double d = distance.signedDistance(at[v]);
      if (d < reach && d >= -maxOverlap) expected = std::min(expected, d);
    }
    if (expected < reach) {
      ASSERT_FALSE(found.empty());
      EXPECT_NEAR(least(found), expected, 1e-12) << "the deepest of all is among them";
    }
    for (const VertexContact& c : found) {
      EXPECT_NEAR(c.gap, distance.signedDistance(at[static_cast<std::size_t>(c.vertex)]), 1e-12);
      (c.gap < 0.0 ? inside : outside) += 1;
      EXPECT_NEAR(c.weight.sum(), 1.0, 1e-12);
      EXPECT_NEAR(c.normal.norm(), 1.0, 1e-12);
    }
  }
  std::printf("%d inside, %d outside\n", inside, outside);
  EXPECT_GT(inside, 50);
  EXPECT_GT(outside, 50);
}

TEST(SurfaceSurface, WhatOverlapsAtRestCountsFromThere) {
  const Body a(test::sphereSurface(Vec3(0.0, 0.0, 0.022), 0.015, 6));
  const Body b(test::sphereSurface(Vec3(0.0, 0.0, 0.0), 0.015, 6));
  const SurfacePair pair(a.surface, a.skin.vertex, b.surface, b.skin.vertex);
  EXPECT_LT(*std::min_element(pair.restOffset().begin(), pair.restOffset().end()), -0.006)
      << "deeper at rest than is looked elsewhere";
  EXPECT_TRUE(contacts(pair, a, a.skin.vertex, b, b.skin.vertex, 0.0).empty());
  for (const VertexContact& c : contacts(pair, a, a.skin.vertex, b, b.skin.vertex, 0.001)) EXPECT_GE(c.gap, 0.0);
  for (const double push : {0.0005, 0.002}) {
    const std::vector<VertexContact> found =
        contacts(pair, a, moved(a.skin.vertex, Vec3(0.0, 0.0, -push)), b, b.skin.vertex, 0.001);
    EXPECT_LT(least(found), -0.8 * push);
    EXPECT_GT(least(found), -1.2 * push);
  }
  const std::vector<Vec3> apart = moved(a.skin.vertex, Vec3(0.0, 0.0, 0.001));
  EXPECT_GE(least(contacts(pair, a, apart, b, b.skin.vertex, 0.002)), 0.0);
}

/// Bodies that start apart, come near, turn, are bent, pass into one another: what the displacements settle unseen is
/// never what a look would have found. Every vertex against the signed distance.
TEST(SurfaceSurface, DisplacementsSettleNothingWrongly) {
  SCOPED_TRACE("seed 332");
  Random random(332);
  const Body a(test::sphereSurface(Vec3(0.0, 0.0, 0.022), 0.012, 8));
  const Body b(test::boxSurface(Vec3(-0.03, -0.03, -0.008), Vec3(0.03, 0.03, 0.008), {14, 14, 4}));
  ASSERT_GT(a.surface.patches().size(), 8U);
  const SurfacePair pair(a.surface, a.skin.vertex, b.surface, b.skin.vertex);
  constexpr double reach = 0.001;
  int touching = 0;
  int free = 0;
  for (int trial = 0; trial < 150; ++trial) {
    std::vector<Vec3> at = a.skin.vertex;
    std::vector<Vec3> below = b.skin.vertex;
    const Quat turn = Quat(1.0, 0.5 * random.normal(), 0.5 * random.normal(), 0.5 * random.normal()).normalized();
    const Vec3 centre(random.uniform(-0.02, 0.02), random.uniform(-0.02, 0.02), random.uniform(0.012, 0.024));
    for (Vec3& p : at) p = centre + turn * (p - Vec3(0.0, 0.0, 0.022));
    const double bend = 0.004 * random.normal();
    const Vec3 drift = 0.01 * Vec3(random.normal(), random.normal(), random.normal());
    for (Vec3& p : below) p += drift + Vec3(0.0, 0.0, bend * std::sin(100.0 * p[0]));
    if (trial % 2 == 0) {
      for (Vec3& p : at) p += drift;  // carried along: near, though far from where they were
    }
    const SurfaceDistance distance(TriangleMesh{below, b.skin.triangle}, InsideRule::pseudonormal);
    double expected = reach;
    for (const Vec3& p : at) {
      const double d = distance.signedDistance(p);
      if (d >= -maxOverlap) expected = std::min(expected, d);
    }
    const std::vector<VertexContact> found = contacts(pair, a, at, b, below, reach);
    if (expected < reach) {
      ++touching;
      ASSERT_NEAR(least(found), expected, 1e-12) << trial;
    } else {
      ++free;
      ASSERT_TRUE(found.empty()) << trial;
    }
  }
  std::printf("%d touching, %d free\n", touching, free);
  EXPECT_GT(touching, 20);
  EXPECT_GT(free, 20);
}

/// A sheet of 60 x 20 x 2 mm, bent about the y axis by the given angle: a flat sheet at 0, a U at pi.
SurfaceDescription bentSheet(double angle, double thickness = 0.002) {
  SurfaceDescription s = test::boxSurface(Vec3(-0.03, -0.01, 0.0), Vec3(0.03, 0.01, 0.002), {30, 10, 1});
  // The middle third is bent, the outer thirds stay straight.
  constexpr double bend = 0.01;
  for (Vec3& p : s.vertex) {
    const double x = p[0];
    p[1] *= 1.0 + 5.0 * x;  // one end is narrower: no two faces in one plane
    const double z = p[2] * (thickness / 0.002);
    if (angle == 0.0) {
      p[2] = z;
      continue;
    }
    const double radius = 2.0 * bend / angle;
    const double t = std::clamp(x, -bend, bend) / radius;
    const double rest = x - std::clamp(x, -bend, bend);
    p = Vec3((radius - z) * std::sin(t) + rest * std::cos(t), p[1],
             radius - (radius - z) * std::cos(t) + rest * std::sin(t));
  }
  return s;
}

TEST(SurfaceSurface, AFoldedSheetTouchesItself) {
  const Body body(bentSheet(0.0));
  const SurfacePair pair(body.surface, body.skin.vertex);
  EXPECT_TRUE(pair.self());
  for (const double offset : pair.restOffset()) EXPECT_EQ(offset, 0.0);
  for (std::size_t v = 0; v < body.skin.vertex.size(); ++v) {
    for (const std::uint32_t t : body.surface.trianglesAround(static_cast<int>(v))) {
      ASSERT_TRUE(pair.excluded(static_cast<int>(v), t)) << "a vertex never touches its own triangles";
    }
  }
  const auto at = [&](double angle, double thickness) {
    const std::vector<Vec3> position = bentSheet(angle, thickness).vertex;
    return contacts(pair, body, position, body, position, 0.001);
  };
  for (const double angle : {0.0, 0.5, 1.5, 2.5}) EXPECT_TRUE(at(angle, 0.002).empty()) << "bent by " << angle;
  EXPECT_TRUE(at(0.0, 0.0008).empty()) << "squeezed: its two sides are no contact";
  EXPECT_TRUE(at(1.5, 0.0012).empty());
  // Bent beyond a U, its ends come together at the plane of symmetry, and pass through one another.
  int open = 0;
  int apart = 0;
  int overlap = 0;
  for (double angle = 3.0; angle < 3.75; angle += 0.02) {
    const std::vector<Vec3> position = bentSheet(angle).vertex;
    const std::vector<VertexContact> found = contacts(pair, body, position, body, position, 0.001);
    double end = 1.0;  // how far the right end is from the plane of symmetry
    for (std::size_t v = 0; v < position.size(); ++v) {
      if (body.skin.vertex[v][0] > 0.029) end = std::min(end, position[v][0]);
    }
    if (2.0 * end > 0.0011) {
      EXPECT_TRUE(found.empty()) << angle;
      ++open;
    } else if (end > 0.0) {
      EXPECT_GE(least(found), 0.0) << angle;
      EXPECT_NEAR(least(found), 2.0 * end, 3e-4) << angle << ": the other end is its mirror image";
      ++apart;
    } else if (end < -1e-4) {
      EXPECT_LT(least(found), 0.0) << angle;
      EXPECT_GE(least(found), 2.0 * end - 1e-9) << angle;
      ++overlap;
    }
    for (const VertexContact& c : found) {
      const Vec3& v = body.skin.vertex[static_cast<std::size_t>(c.vertex)];
      EXPECT_GT((v - footOf(c, body.skin.vertex)).norm(), 0.02) << "places far apart at rest";
    }
  }
  EXPECT_GT(open, 3);
  EXPECT_GT(apart, 0);
  EXPECT_GT(overlap, 3);
}

SurfaceDescription readObj(const std::string& name) {
  std::ifstream file(std::string(CALOT_SOURCE_DIR) + "/assets/organs/" + name);
  SurfaceDescription s;
  std::string line;
  while (std::getline(file, line)) {
    std::istringstream in(line);
    std::string kind;
    in >> kind;
    if (kind == "v") {
      Vec3 p;
      in >> p[0] >> p[1] >> p[2];
      s.vertex.push_back(p);
    } else if (kind == "f") {
      Index3 t;
      for (int k = 0; k < 3; ++k) {
        std::string corner;
        in >> corner;
        t[k] = std::stoi(corner.substr(0, corner.find('/'))) - 1;
      }
      s.triangle.push_back(t);
    }
  }
  return s;
}

TEST(SurfaceSurface, AGallbladderRestsInItsFossa) {
  const Body liver(readObj("liver.obj"));
  const Body gallbladder(readObj("gallbladder.obj"));
  ASSERT_GT(liver.skin.triangle.size(), 100U);
  ASSERT_GT(gallbladder.skin.triangle.size(), 100U);
  const SurfacePair onLiver(gallbladder.surface, gallbladder.skin.vertex, liver.surface, liver.skin.vertex);
  const SurfacePair onGallbladder(liver.surface, liver.skin.vertex, gallbladder.surface, gallbladder.skin.vertex);
  const SurfacePair liverItself(liver.surface, liver.skin.vertex);
  const SurfacePair gallbladderItself(gallbladder.surface, gallbladder.skin.vertex);
  const auto both = [&](const std::vector<Vec3>& at, double reach) {
    std::vector<VertexContact> found = contacts(onLiver, gallbladder, at, liver, liver.skin.vertex, reach);
    const std::vector<VertexContact> more = contacts(onGallbladder, liver, liver.skin.vertex, gallbladder, at, reach);
    found.insert(found.end(), more.begin(), more.end());
    return found;
  };
  EXPECT_TRUE(both(gallbladder.skin.vertex, 0.0).empty());
  const std::vector<VertexContact> near = both(gallbladder.skin.vertex, 0.001);
  for (const VertexContact& c : near) EXPECT_GE(c.gap, 0.0);
  std::printf("at rest %zu rows within 1 mm; deepest overlap %.2f mm and %.2f mm\n", near.size(),
              1e3 * std::abs(*std::min_element(onLiver.restOffset().begin(), onLiver.restOffset().end())),
              1e3 * std::abs(*std::min_element(onGallbladder.restOffset().begin(), onGallbladder.restOffset().end())));
  EXPECT_TRUE(contacts(liverItself, liver, liver.skin.vertex, liver, liver.skin.vertex, 0.0).empty());
  EXPECT_TRUE(
      contacts(gallbladderItself, gallbladder, gallbladder.skin.vertex, gallbladder, gallbladder.skin.vertex, 0.0)
          .empty());
  // Pushed towards the middle of the liver it is held; drawn away it is free.
  Vec3 centre = Vec3::Zero();
  for (const Vec3& p : liver.skin.vertex) centre += p / static_cast<double>(liver.skin.vertex.size());
  Vec3 bladder = Vec3::Zero();
  for (const Vec3& p : gallbladder.skin.vertex) bladder += p / static_cast<double>(gallbladder.skin.vertex.size());
  const Vec3 towards = (centre - bladder).normalized();
  EXPECT_LT(least(both(moved(gallbladder.skin.vertex, 0.002 * towards), 0.001)), -0.0005);
}

}  // namespace
}  // namespace calot
