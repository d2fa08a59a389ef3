// SPDX-License-Identifier: GPL-3.0-or-later
// The contact surface of fat: updated is rebuilt, restored is uninterrupted; and what contact makes of it.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstring>
#include <iostream>
#include <map>

#include "sim/contact/broad_phase.h"
#include "sim/contact/capsule_contact.h"
#include "sim/contact/surface_patches.h"
#include "sim/math/fields.h"
#include "tests/sim/fat/support/fat_bodies.h"

namespace calot {
namespace {

std::unique_ptr<const FatModel> lump(double cell = 0.00075) {
  return test::fatOn(test::lumpSurface({0.012, 0.010, 0.006}), test::fatSettings(cell), {test::floorPartner(-0.003)});
}

void expectSame(const FatBody& x, const FatBody& y, const FatState& state) {
  const ContactSurface& a = x.contact().surface();
  const ContactSurface& b = y.contact().surface();
  ASSERT_EQ(a.patches().size(), b.patches().size());
  ASSERT_EQ(x.contact().nodeCapacity(), y.contact().nodeCapacity());
  for (std::size_t p = 0; p < a.patches().size(); ++p) {
    ASSERT_EQ(a.patches()[p].first, b.patches()[p].first);
    ASSERT_EQ(a.patches()[p].last, b.patches()[p].last);
    ASSERT_LE(a.patches()[p].last - a.patches()[p].first, ContactSurface::maxPatchTriangles);
    const auto mine = a.patchCorners(static_cast<std::uint32_t>(p));
    const auto theirs = b.patchCorners(static_cast<std::uint32_t>(p));
    ASSERT_TRUE(std::equal(mine.begin(), mine.end(), theirs.begin(), theirs.end()));
    for (std::size_t t = a.patches()[p].first; t < a.patches()[p].last; ++t) {
      ASSERT_EQ(a.triangles()[t], b.triangles()[t]);
      ASSERT_EQ(a.name(t), b.name(t));
    }
  }
  std::vector<Vec3> here;
  std::vector<Vec3> there;
  x.contact().positions(state.solid.position, here);
  y.contact().positions(state.solid.position, there);
  ASSERT_EQ(std::memcmp(here.data(), there.data(), here.size() * sizeof(Vec3)), 0);
  for (int n = 0; n < static_cast<int>(here.size()); ++n) {
    ASSERT_EQ(x.contact().exists(n), y.contact().exists(n));
  }
  ASSERT_TRUE(std::equal(x.fill().begin(), x.fill().end(), y.fill().begin()));
  for (std::size_t t = 0; t < x.model().allTies().size(); ++t) ASSERT_EQ(x.tieShare(t), y.tieShare(t));
  ASSERT_EQ(x.volume().total(), y.volume().total());
}

/// Closed, manifold, and its neighbourhood is what its triangles say. Every vertex hangs on what is there.
void expectSound(const FatBody& body) {
  const ContactSurface& s = body.contact().surface();
  std::map<std::pair<int, int>, std::size_t> side;
  std::map<int, std::vector<std::uint32_t>> around;
  for (const ContactSurface::Patch& patch : s.patches()) {
    for (std::size_t t = patch.first; t < patch.last; ++t) {
      for (int k = 0; k < 3; ++k) {
        ASSERT_TRUE(side.insert({{s.triangles()[t][k], s.triangles()[t][(k + 1) % 3]}, t}).second);
        around[s.triangles()[t][k]].push_back(static_cast<std::uint32_t>(t));
        ASSERT_TRUE(body.contact().exists(s.triangles()[t][k]));
        ASSERT_LT(s.triangles()[t][k], 1 << 25);
      }
    }
  }
  for (const auto& [edge, t] : side) {
    const auto other = side.find({edge.second, edge.first});
    ASSERT_NE(other, side.end());
    const int k = s.triangles()[t][0] == edge.first ? 0 : (s.triangles()[t][1] == edge.first ? 1 : 2);
    ASSERT_EQ(static_cast<std::size_t>(s.neighbourTriangle(t, k)), other->second);
    const Index3& o = s.triangles()[other->second];
    ASSERT_EQ(s.opposite(t, k), o[0] + o[1] + o[2] - edge.first - edge.second);
    ASSERT_EQ(featureKey(s, t, static_cast<TriangleFeature>(k + 1)) >> 50U, 2U);
  }
  ContactSurface::Fan fan;
  for (auto& [node, triangles] : around) {
    const auto found = s.trianglesAround(node, fan);
    std::vector<std::uint32_t> sorted(found.begin(), found.end());
    std::sort(sorted.begin(), sorted.end());
    ASSERT_EQ(sorted, triangles);
    for (std::size_t c = 0; c < 8; ++c) {
      const MaterialPoint point = body.contact().anchor(node);
      bool held = false;
      for (const std::int32_t cube : body.model().cubesAt(point.node[c])) held = held || body.fill()[slot(cube)] > 0.0;
      ASSERT_TRUE(held);
    }
  }
}

std::vector<SweptCapsule> harshTool(Random& random) {
  std::vector<SweptCapsule> tool;
  const Box box{{-0.011, -0.009, -0.002}, {0.011, 0.009, 0.006}};
  const int pieces = 1 + static_cast<int>(random.next() % 2);
  for (int k = 0; k < pieces; ++k) {
    const double radius = random.uniform(0.0004, 0.002);
    const double segment = random.uniform(0.0, 0.006);
    const double length = random.uniform(0.0, 0.004);
    tool.push_back(test::randomSweep(random, box, radius, segment, length));
  }
  return tool;
}

/// Random forces and strokes of step `i`: the same for whoever asks.
void harshStep(test::FatRig& rig, int i) {
  Random random(static_cast<std::uint64_t>(i), 17);
  std::vector<Vec3> force(rig.model.solid().nodes(), Vec3::Zero());
  for (int k = 0; k < 3; ++k) {
    const double x = random.normal();
    const double y = random.normal();
    const double z = random.normal();
    force[random.next() % force.size()] = 0.004 * Vec3(x, y, z);
  }
  rig.move({0.0, 0.0, -2.0}, force);
  rig.body.stroke(rig.state, harshTool(random));
}

TEST(FatContact, UpdatedIsRebuiltAfterEveryHarshStroke) {
  const auto model = lump();
  test::FatRig rig(*model);
  FatBody fresh(*model);
  std::cout << "steps 0 to 149 of stream 17\n";
  const double whole = rig.body.volume().total();
  for (int i = 0; i < 150; ++i) {
    SCOPED_TRACE(i);
    ASSERT_NO_FATAL_FAILURE(harshStep(rig, i));
    ASSERT_TRUE(fresh.rebuild(rig.state));
    ASSERT_NO_FATAL_FAILURE(expectSame(rig.body, fresh, rig.state));
    if (i % 3 == 0) {
      ASSERT_NO_FATAL_FAILURE(expectSound(rig.body));
    }
  }
  std::cout << "left " << 100.0 * rig.body.volume().total() / whole << " %, "
            << rig.body.contact().surface().patches().size() << " patches\n";
  EXPECT_LT(rig.body.volume().total(), 0.7 * whole);
  EXPECT_GT(rig.body.volume().total(), 0.0);
  EXPECT_EQ(rig.body.growths(), 0U);
}

TEST(FatContact, RestoredGoesOnAsIfNothingHadBeen) {
  const auto model = lump();
  test::FatRig rig(*model);
  for (int i = 0; i < 20; ++i) harshStep(rig, i);
  const std::vector<std::byte> saved = test::bytesOfState(rig.state);
  for (int i = 20; i < 45; ++i) harshStep(rig, i);
  test::FatRig other(*model);
  for (int i = 100; i < 130; ++i) harshStep(other, i);  // another life
  ByteReader reader(saved);
  reader.read(other.state.solid);
  reader.read(other.state.carved);
  ASSERT_TRUE(reader.complete());
  ASSERT_TRUE(other.body.rebuild(other.state));
  for (int i = 20; i < 45; ++i) harshStep(other, i);
  EXPECT_EQ(test::bytesOfState(other.state), test::bytesOfState(rig.state));
  ASSERT_NO_FATAL_FAILURE(expectSame(rig.body, other.body, rig.state));
}

/// What a capsule finds on the fat.
struct Probe {
  std::vector<Vec3> skin;
  std::vector<Box> bounds;
  SortedGrid broad{0.02};
  std::vector<std::uint32_t> patches;

  void place(const test::FatRig& rig) {
    rig.body.contact().positions(rig.state.solid.position, skin);
    const std::vector<Box> before = bounds;
    patchBounds(rig.body.contact().surface(), skin, 0.0, bounds);
    if (before.size() == bounds.size()) {
      changedBounds(before, bounds, patches);
      broad.refit(bounds, patches);
    } else {
      broad.update(bounds);
    }
  }
  std::span<const std::uint32_t> near(const Vec3& p0, const Vec3& p1, double grow) {
    Box box;
    box.include(p0);
    box.include(p1);
    box.grow(grow);
    std::vector<BroadPhase::Pair> pairs;
    broad.pairs({&box, 1}, pairs);
    patches.clear();
    for (const BroadPhase::Pair& p : pairs) patches.push_back(p.leaf);
    return patches;
  }
  double gap(const test::FatRig& rig, const Vec3& p0, const Vec3& p1, double radius, double reach) {
    return minGap(rig.body.contact().surface(), skin, near(p0, p1, capsuleSearch(radius, reach)), p0, p1, radius,
                  reach);
  }
  std::vector<SurfaceContact> contacts(const test::FatRig& rig, const Vec3& p0, const Vec3& p1, double radius) {
    std::vector<SurfaceContact> out;
    capsuleContacts(rig.body.contact().surface(), skin, near(p0, p1, capsuleSearch(radius, 0.001)), p0, p1, radius,
                    0.001, 0, out);
    return out;
  }
};

TEST(FatContact, ACapsuleThatIsCarvedUnderFallsIn) {
  const auto model =
      test::fatOn(test::boxSurface({0.012, 0.010, 0.008}), test::fatSettings(0.00075), {test::floorPartner(-0.006)});
  test::FatRig rig(*model);
  rig.body.beginStep(rig.state);
  Probe probe;
  probe.place(rig);
  const auto at = [](double z) { return std::pair(Vec3(-0.004, 0.0, z), Vec3(0.004, 0.0, z)); };
  const auto settle = [&](double from) {  // goes down to where it touches
    double z = from;
    for (int i = 0; i < 60; ++i) z -= 0.9 * probe.gap(rig, at(z).first, at(z).second, 0.0015, 0.004);
    return z;
  };
  const double rested = settle(0.013);
  EXPECT_NEAR(rested, 0.0095, 2e-5);
  const auto [p0, p1] = at(rested + 0.0001);
  const std::vector<SurfaceContact> before = probe.contacts(rig, p0, p1, 0.0015);
  ASSERT_FALSE(before.empty());
  for (const SurfaceContact& c : before) {
    EXPECT_GT(c.normal[2], 0.99);
    EXPECT_NEAR(c.gap, 0.0001, 3e-5);
  }
  // A stroke elsewhere leaves names, places and order alone.
  const SweptCapsule elsewhere[1] = {
      {{-0.01, 0.007, 0.008}, {-0.008, 0.007, 0.008}, {0.008, 0.007, 0.008}, {0.01, 0.007, 0.008}, 0.001}};
  EXPECT_TRUE(rig.body.stroke(rig.state, elsewhere).changed);
  probe.place(rig);
  const std::vector<SurfaceContact> after = probe.contacts(rig, p0, p1, 0.0015);
  ASSERT_EQ(after.size(), before.size());
  for (std::size_t i = 0; i < after.size(); ++i) {
    EXPECT_EQ(after[i].key, before[i].key);
    EXPECT_EQ(after[i].gap, before[i].gap);
    EXPECT_EQ(after[i].node, before[i].node);
  }
  // A trench under it, 4 mm wide and deep.
  const SweptCapsule trench[1] = {
      {{-0.007, 0.0, 0.010}, {0.007, 0.0, 0.010}, {-0.007, 0.0, 0.006}, {0.007, 0.0, 0.006}, 0.002}};
  EXPECT_TRUE(rig.body.stroke(rig.state, trench).changed);
  probe.place(rig);
  EXPECT_NEAR(settle(rested), 0.0055, 1e-4);  // its bottom is at 4 mm
}

TEST(FatContact, BodiesThatCameToTheSameStateFindTheSame) {
  const auto model = lump();
  test::FatRig rig(*model);
  Random random(5, 1);
  Probe probe;
  std::size_t found = 0;
  for (int i = 0; i < 40; ++i) {
    SCOPED_TRACE(i);
    harshStep(rig, i);
    probe.place(rig);
    test::FatRig fresh(*model);
    fresh.state = rig.state;
    ASSERT_TRUE(fresh.body.rebuild(fresh.state));
    Probe other;
    other.place(fresh);
    for (int k = 0; k < 20; ++k) {
      const SweptCapsule c = test::randomSweep(random, {{-0.01, -0.008, 0.0}, {0.01, 0.008, 0.007}}, 0.001, 0.004, 0.0);
      const auto here = probe.contacts(rig, c.p0, c.p1, c.radius);
      const auto there = other.contacts(fresh, c.p0, c.p1, c.radius);
      ASSERT_EQ(here.size(), there.size());
      for (std::size_t j = 0; j < here.size(); ++j) {
        ASSERT_EQ(here[j].key, there[j].key);
        ASSERT_EQ(here[j].gap, there[j].gap);
        ASSERT_EQ(here[j].node, there[j].node);
        ASSERT_EQ(here[j].weight, there[j].weight);
        ASSERT_EQ(here[j].key >> 52U, 0U);
      }
      found += here.size();
    }
  }
  EXPECT_GT(found, 200U);
}

}  // namespace
}  // namespace calot
