// SPDX-License-Identifier: GPL-3.0-or-later
// What a body of fat is made of, and which it refuses.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/sim/fat/support/fat_bodies.h"
#include "tests/support/message.h"

namespace calot {
namespace {

constexpr double pi = 3.14159265358979323846;

TEST(FatModel, CubesHoldEveryInsideNodeAndCarryItsPlace) {
  const auto model =
      test::fatOn(test::lumpSurface({0.014, 0.012, 0.006}), test::fatSettings(0.00075), {test::floorPartner(-0.003)});
  ASSERT_NE(model, nullptr);
  const BrickLattice& lattice = model->lattice();
  std::vector<int> count(model->solid().cubes().size(), 0);
  for (std::uint32_t n = 0; n < model->field().value.size(); ++n) {
    if (!(model->field().value[n] < 0.0)) continue;
    const Index3 at = lattice.nodeAt(n);
    const int cube = model->cubeOfNode(at);
    ASSERT_GE(cube, 0);
    ++count[slot(cube)];
    const std::array<double, 8> share = model->shares(cube, at.cast<double>());
    Vec3 p = Vec3::Zero();
    for (std::size_t c = 0; c < 8; ++c)
      p += share[c] * model->solid().rest()[slot(model->solid().cubes()[slot(cube)][c])];
    ASSERT_LT((p - lattice.position(at)).norm(), 1e-15);
  }
  for (std::size_t c = 0; c < count.size(); ++c) {
    EXPECT_GT(count[c], 0);
    EXPECT_DOUBLE_EQ(model->restFill()[c], std::min(1.0, count[c] / 27.0));
  }
  EXPECT_GT(model->solid().cubes().size(), 200U);
  for (std::size_t n = 0; n < model->solid().nodes(); ++n) {
    const std::vector<std::int32_t> around = model->solid().elementsAt(n);
    EXPECT_TRUE(std::equal(around.begin(), around.end(), model->cubesAt(static_cast<int>(n)).begin()));
  }
}

TEST(FatModel, TiesStandForTheFatWithinReach) {
  std::vector<FatPartner> partners{test::floorPartner(-0.003), {}};
  partners[1].name = "wall";
  partners[1].distance = [](const Vec3& p) { return 0.010 - p[0]; };
  partners[1].reach = 0.001;
  partners[1].stiffness = 5e6;
  const auto model = test::fatOn(test::lumpSurface({0.014, 0.012, 0.006}), test::fatSettings(0.00075), partners);
  ASSERT_EQ(model->partners(), 2U);
  const double nodeVolume = std::pow(0.00075, 3);
  for (std::size_t p = 0; p < 2; ++p) {
    double stiffness = 0.0;
    for (const FatTie& tie : model->ties(p)) {
      stiffness += tie.stiffness;
      EXPECT_LE(partners[p].distance(tie.rest), partners[p].reach + 1e-12);  // both are convex
      EXPECT_EQ((tie.point.of(model->solid().rest()) - tie.rest).norm(), 0.0);
    }
    int nodes = 0;
    for (std::uint32_t n = 0; n < model->field().value.size(); ++n) {
      const bool in = model->field().value[n] < 0.0;
      nodes += in && partners[p].distance(model->lattice().position(model->lattice().nodeAt(n))) <= partners[p].reach;
    }
    EXPECT_GT(nodes, 100);
    EXPECT_NEAR(stiffness, partners[p].stiffness * nodeVolume * nodes, 1e-9 * stiffness);
  }
}

TEST(FatModel, WhatHangsOnNothingIsNotThereAtAll) {
  TriangleMesh two = test::boxSurface(Vec3::Constant(0.004));
  const int offset = two.vertices();
  const TriangleMesh other = test::boxSurface(Vec3::Constant(0.003));
  for (const Vec3& p : other.vertex) two.vertex.emplace_back(p + Vec3(0.0, 0.0, 0.012));
  for (const Index3& t : other.triangle) two.triangle.emplace_back(t.array() + offset);
  const auto model = test::fatOn(two, test::fatSettings(0.0005), {test::floorPartner(-0.002)});
  const FatBody body(*model);
  EXPECT_NEAR(body.volume().total(), std::pow(0.008, 3), 0.02 * std::pow(0.008, 3));
  for (const Vec3& p : model->solid().rest()) EXPECT_LT(p[2], 0.0065);
}

TEST(FatModel, VolumesAreThoseOfTheSurfaceAndOfRegions) {
  const Vec3 half(0.013, 0.011, 0.007);
  const std::vector<FatRegion> regions{{"left", [](const Vec3& p) { return p[0] < 0.0; }},
                                       {"right", [](const Vec3& p) { return p[0] >= 0.0; }}};
  const auto model =
      test::fatOn(test::lumpSurface(half, 0.0), test::fatSettings(0.00075), {test::floorPartner(-0.003)}, regions);
  const FatBody body(*model);
  const double volume = 4.0 / 3.0 * pi * half.prod();
  EXPECT_NEAR(body.volume().total(), volume, 0.005 * volume);
  EXPECT_DOUBLE_EQ(body.volume().inRegion(0) + body.volume().inRegion(1), body.volume().total());
  EXPECT_NEAR(body.volume().inRegion(0), 0.5 * volume, 0.04 * volume);
  EXPECT_EQ(model->regionName(1), "right");
}

TEST(FatModel, RefusesWhatCannotBe) {
  const TriangleMesh good = test::lumpSurface({0.010, 0.010, 0.006});
  const auto error = [](const TriangleMesh& mesh, const FatSettings& settings,
                        const std::vector<FatPartner>& partners) {
    std::string text;
    EXPECT_EQ(FatModel::make(mesh, settings, partners, {}, text), nullptr);
    EXPECT_NE(text, "");
    EXPECT_EQ(text.find('\n'), std::string::npos);
    return text;
  };
  const std::vector<FatPartner> floor{test::floorPartner(-0.003)};
  TriangleMesh open = good, nan = good;
  open.triangle.pop_back();
  nan.vertex[7][1] = std::numeric_limits<double>::quiet_NaN();
  const std::string loose = error(good, test::fatSettings(0.00075), {});
  EXPECT_EQ(error(good, test::fatSettings(0.00075), {test::floorPartner(-1.0)}), loose);
  error(good, test::fatSettings(0.05), floor);  // thinner than a cell
  expectDistinct({loose, error(good, test::fatSettings(1e-5), floor), error(good, test::fatSettings(0.0), floor),
                  error(good, test::fatSettings(0.00075, 0), floor), error({}, test::fatSettings(0.00075), floor),
                  error(open, test::fatSettings(0.00075), floor), error(nan, test::fatSettings(0.00075), floor)});
  FatSettings soft = test::fatSettings(0.00075);
  soft.material.lame.mu = -1.0;
  error(good, soft, floor);
  std::vector<FatPartner> negative = floor;
  negative[0].stiffness = -1.0;
  EXPECT_NE(error(good, test::fatSettings(0.00075), negative).find("floor"), std::string::npos);
}

TEST(FatModel, StatesOfOthersAreRefused) {
  const auto model =
      test::fatOn(test::lumpSurface({0.010, 0.010, 0.006}), test::fatSettings(0.00075), {test::floorPartner(-0.003)});
  const FatState good = restState(*model);
  EXPECT_TRUE(fits(*model, good));
  const auto refused = [&](const auto& spoil) {
    FatState bad = good;
    spoil(bad);
    FatBody body(*model);
    const double whole = body.volume().total();
    EXPECT_FALSE(fits(*model, bad));
    EXPECT_FALSE(body.rebuild(bad));
    EXPECT_EQ(body.volume().total(), whole);
  };
  refused([](FatState& s) { s.solid.position.pop_back(); });
  refused([](FatState& s) { s.solid.velocity[3][0] = std::numeric_limits<double>::infinity(); });
  refused([](FatState& s) { s.solid.rotation.clear(); });
  refused([](FatState& s) { s.solid.rotation[0][0][0] = 3.0; });
  refused([](FatState& s) { s.carved.brick.push_back(0); });
  refused([&](FatState& s) {
    s.carved.brick.push_back(1U << 20U);
    s.carved.value.emplace_back();
  });
  refused([&](FatState& s) {  // grown
    s.carved.brick.push_back(0);
    s.carved.value.emplace_back().fill(0.0);
    s.carved.value.back()[BrickLattice::brickNodes - 1] = -model->field().band;
    std::uint32_t b = 0;
    while (model->field().value[512 * b + 511] < 0.0) ++b;
    s.carved.brick.back() = b;
  });
}

}  // namespace
}  // namespace calot
