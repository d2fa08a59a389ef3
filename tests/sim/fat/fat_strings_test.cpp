// SPDX-License-Identifier: GPL-3.0-or-later
// Strings of fat between two blocks: which of them tear, and what is joined.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <utility>
#include <vector>

#include "tests/sim/fat/support/fat_bodies.h"

namespace calot::fat_strings_test {
namespace {

constexpr double half = 0.006;  // of the string's length (m)

/// Two blocks of 6 x 9 x 9 mm, held by a partner each, and a square bar between them. @param thick its half width
std::unique_ptr<const FatModel> dumbbell(const Vec3& middle, double thick) {
  TriangleMesh mesh;
  const auto square = [&mesh](double x, const Vec3& about, double halfWidth) {
    const auto first = static_cast<int>(mesh.vertex.size());
    for (const auto& [y, z] : {std::pair{1.0, 1.0}, {-1.0, 1.0}, {-1.0, -1.0}, {1.0, -1.0}}) {
      mesh.vertex.emplace_back(x, about[1] + halfWidth * y, about[2] + halfWidth * z);
      if (first == 0) continue;
      const int a = static_cast<int>(mesh.vertex.size()) - 1;
      const int b = a == first + 3 ? first : a + 1;
      mesh.triangle.emplace_back(a - 4, b - 4, b);
      mesh.triangle.emplace_back(a - 4, b, a);
    }
    return first;
  };
  constexpr double wide = 0.0045;
  square(-half - 0.006, Vec3::Zero(), wide);
  mesh.triangle.emplace_back(0, 3, 2);
  mesh.triangle.emplace_back(0, 2, 1);
  square(-half, Vec3::Zero(), wide);
  square(-half, middle, thick);
  square(half, middle, thick);
  square(half, Vec3::Zero(), wide);
  const int last = square(half + 0.006, Vec3::Zero(), wide);
  mesh.triangle.emplace_back(last, last + 1, last + 2);
  mesh.triangle.emplace_back(last, last + 2, last + 3);
  const auto partner = [](const char* name, double side) {
    FatPartner p;
    p.name = name;
    p.distance = [side](const Vec3& x) { return half + 0.003 - side * x[0]; };
    p.reach = 0.0;
    return p;
  };
  return test::fatOn(mesh, test::fatSettings(0.00075, 4), {partner("left", -1.0), partner("right", 1.0)});
}

/// A bar that is `nodes` wide and high: it lies about a node, or amid four.
std::unique_ptr<const FatModel> dumbbellOf(int nodes) {
  const BrickLattice lattice = dumbbell(Vec3::Zero(), 0.002)->lattice();
  Vec3 middle = ((-lattice.origin()) / lattice.cell()).array().round();
  if (nodes % 2 == 0) middle.array() += 0.5;
  middle = lattice.origin() + lattice.cell() * middle;
  middle[0] = 0.0;
  return dumbbell(middle, lattice.cell() * (0.5 * nodes - 0.1));
}

/// The string is stretched along x by `along`, all of it across by `across`; the blocks go along unstretched.
FatState stretched(const FatModel& model, double along, double across) {
  FatState state = restState(model);
  for (Vec3& p : state.solid.position) {
    p[0] += (along - 1.0) * std::clamp(p[0], -half, half);
    p[1] *= across;
    p[2] *= across;
  }
  return state;
}

bool joined(FatBody& body, const FatModel& model) {
  std::vector<std::uint32_t> thing(model.allTies().size(), 0);
  std::fill(thing.begin() + static_cast<std::ptrdiff_t>(model.firstTie(1)), thing.end(), 1);
  return body.joins(thing, 2);
}

FatStroke tearOf(const FatModel& model, FatState& state, bool& holds) {
  FatBody body(model);
  EXPECT_TRUE(body.rebuild(state));
  EXPECT_TRUE(joined(body, model));
  const FatStroke done = body.tear(state);
  holds = joined(body, model);
  EXPECT_TRUE(fits(model, state));
  return done;
}

TEST(FatStrings, TearUnderTensionAndNotWhenSlack) {
  const std::unique_ptr<const FatModel> model = dumbbellOf(1);
  const double cell = model->lattice().cell();
  bool holds = false;
  for (const auto& [along, across] : {std::pair{1.0, 1.0}, {1.4, 0.85}, {0.6, 1.0}}) {
    FatState slack = stretched(*model, along, across);
    const std::vector<std::byte> before = test::bytesOfState(slack);
    EXPECT_FALSE(tearOf(*model, slack, holds).changed) << along;
    EXPECT_TRUE(holds);
    EXPECT_EQ(test::bytesOfState(slack), before);
  }
  FatState taut = stretched(*model, 1.7, 0.8);
  const FatStroke torn = tearOf(*model, taut, holds);
  EXPECT_TRUE(torn.changed);
  EXPECT_FALSE(holds);
  EXPECT_EQ(torn.islands, 0.0) << "its ends hang on the blocks";
  EXPECT_GT(torn.removed, 0.0);
  EXPECT_LE(torn.nodes, 4U) << "one cube's fat";
  EXPECT_LT(torn.removed, 4.0 * cell * cell * cell);
  EXPECT_LT(std::abs(torn.where[0]), 1.7 * half);
}

/// Drawn out because it is pressed flat, it is not pulled.
TEST(FatStrings, DoNotTearUnderPressure) {
  const std::unique_ptr<const FatModel> model = dumbbellOf(1);
  bool holds = false;
  FatState flat = stretched(*model, 1.6, 0.6);
  EXPECT_FALSE(tearOf(*model, flat, holds).changed);
  EXPECT_TRUE(holds);
}

TEST(FatStrings, AThickOneHolds) {
  for (const int nodes : {2, 3, 4}) {
    SCOPED_TRACE(nodes);
    const std::unique_ptr<const FatModel> model = dumbbellOf(nodes);
    bool holds = false;
    FatState taut = stretched(*model, 2.0, 0.8);
    EXPECT_FALSE(tearOf(*model, taut, holds).changed);
    EXPECT_TRUE(holds);
  }
}

/// Turned as a whole, the same string tears.
TEST(FatStrings, AskForNoDirection) {
  const std::unique_ptr<const FatModel> model = dumbbellOf(1);
  const Quat turn(0.5, 0.5, -0.5, 0.5);
  const Quat oblique = Quat(0.9, 0.2, 0.3, -0.24).normalized();
  for (const Quat& q : {turn, oblique}) {
    FatState taut = stretched(*model, 1.7, 0.8);
    for (Vec3& p : taut.solid.position) p = Vec3(0.01, 0.02, -0.03) + q * p;
    bool holds = true;
    EXPECT_TRUE(tearOf(*model, taut, holds).changed);
    EXPECT_FALSE(holds);
  }
}

/// Pulled apart by a force, it tears once; a run that goes on from a saved State has the same bits.
TEST(FatStrings, TearAlikeAfterARestore) {
  const std::unique_ptr<const FatModel> model = dumbbellOf(1);
  std::vector<Vec3> force(model->solid().nodes(), Vec3::Zero());
  std::size_t pulled = 0;
  for (const Vec3& p : model->solid().rest()) pulled += p[0] > half ? 1 : 0;
  for (std::size_t n = 0; n < force.size(); ++n) {
    if (model->solid().rest()[n][0] > half) force[n] = Vec3(0.006, 0.0, 0.0) / static_cast<double>(pulled);
  }
  // The blocks' ties are weak: the right one gives way.
  test::FatRig rig(*model);
  std::unique_ptr<test::FatRig> restored;
  int torn = 0;
  for (int step = 0; step < 400; ++step) {
    if (step % 7 == 3) {
      restored = std::make_unique<test::FatRig>(*model);
      restored->state = rig.state;
      ASSERT_TRUE(restored->body.rebuild(restored->state));
    }
    const auto go = [&](test::FatRig& r) {
      r.move(Vec3::Zero(), force);
      return r.body.tear(r.state).changed;
    };
    const bool changed = go(rig);
    torn += changed ? 1 : 0;
    if (restored) {
      EXPECT_EQ(go(*restored), changed);
      ASSERT_EQ(test::bytesOfState(restored->state), test::bytesOfState(rig.state)) << step;
    }
  }
  EXPECT_EQ(torn, 1) << "once it is parted, nothing is pulled any more";
  EXPECT_FALSE(joined(rig.body, *model));
}

}  // namespace
}  // namespace calot::fat_strings_test
