// SPDX-License-Identifier: GPL-3.0-or-later
// What a stroke takes off, against what it swept.
#include "sim/carving/carved_field.h"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "sim/carving/carved_surface.h"
#include "sim/math/elementary.h"
#include "tests/sim/carving/support/carving_bodies.h"

namespace calot {
namespace {

constexpr double pi = 3.14159265358979323846;

/// A block that holds any stroke of these tests, 30 mm a side.
FieldModel block(double cell) {
  const BrickLattice lattice = BrickLattice::around({Vec3::Constant(-0.015), Vec3::Constant(0.015)}, cell, 2);
  return test::fieldOf(lattice, 3.0, [](const Vec3& p) { return p.cwiseAbs().maxCoeff() - 0.015; });
}

/// Volume inside the surface (m^3), by its triangles.
double volumeOf(const CarvedField& field) {
  CarvedSurface surface(field.lattice());
  surface.rebuild(field);
  return signedVolume(test::meshOf(field, surface));
}

/// What a list of strokes takes off the block (m^3).
double carved(double cell, const std::vector<std::vector<SweptCapsule>>& strokes) {
  const FieldModel model = block(cell);
  CarvedField field(model);
  CarvedBricks state;
  const double before = volumeOf(field);
  for (const std::vector<SweptCapsule>& tool : strokes) {
    field.begin();
    test::carveAtRest(field, tool);
    field.commit(state);
  }
  return before - volumeOf(field);
}

/// Errors at three cells, the last of which is to be within 1 % and the order about two.
void expectConverging(const std::vector<std::vector<SweptCapsule>>& strokes, double truth) {
  double last = 1e300;
  for (const double cell : {0.001, 0.0005, 0.00025}) {
    const double error = std::abs(carved(cell, strokes) / truth - 1.0);
    std::cout << "  cell " << 1e3 * cell << " mm: " << 100.0 * error << " % off " << 1e9 * truth << " mm^3\n";
    EXPECT_LT(error, std::max(0.6 * last, 2e-4));
    last = error;
  }
  EXPECT_LT(last, 0.01);
}

TEST(Carve, StraightSweepTakesItsVolume) {
  // Across its axis: the stadium's area times the width, and half a capsule at each end.
  const double r = 0.0015;
  const double length = 0.004;
  const double sweep = 0.006;
  const Vec3 u = Vec3(1.0, 0.3, -0.2).normalized();
  const Vec3 v = u.cross(Vec3(0.1, 0.2, 1.0)).normalized();
  const Vec3 from = -0.5 * length * u - 0.5 * sweep * v + Vec3(0.00013, 0.00029, -0.00021);
  std::vector<std::vector<SweptCapsule>> strokes;
  const int steps = 4;
  for (int i = 0; i < steps; ++i) {
    const Vec3 a = from + (sweep * i / steps) * v;
    const Vec3 b = from + (sweep * (i + 1) / steps) * v;
    strokes.push_back({{a, a + length * u, b, b + length * u, r}});
  }
  // Minkowski sum of a rectangle and a ball.
  expectConverging(strokes, 2.0 * r * length * sweep + pi * r * r * (length + sweep) + 4.0 / 3.0 * pi * r * r * r);
}

TEST(Carve, SweepAlongAnArcTakesItsVolume) {
  // A ball on a circle, in chords: a bent tube by Pappus, with round ends.
  const double r = 0.002;
  const double bend = 0.008;
  const double angle = 1.5;
  const int steps = 150;
  std::vector<std::vector<SweptCapsule>> strokes;
  const auto at = [&](int i) {
    const double a = angle * i / steps;
    return Vec3(bend * cosine(a) - 0.005, bend * sine(a) - 0.004, 0.0003);
  };
  for (int i = 0; i < steps; ++i) strokes.push_back({{at(i), at(i), at(i + 1), at(i + 1), r}});
  expectConverging(strokes, pi * r * r * bend * angle + 4.0 / 3.0 * pi * r * r * r);
}

/// Largest height of ridges along the bottom of a groove, by the surface's vertices below the path (m).
double ridges(bool sweep, double step) {
  const FieldModel model = block(0.00025);
  CarvedField field(model);
  CarvedBricks state;
  const double r = 0.0015;
  const double depth = 0.0145;
  for (double x = -0.01; x < 0.01; x += step) {
    const Vec3 a(x, 0.0, depth);
    const Vec3 b(x + step, 0.0, depth);
    field.begin();
    test::carveAtRest(field, {sweep ? SweptCapsule{a, a, b, b, r} : SweptCapsule{b, b, b, b, r}});
    field.commit(state);
  }
  CarvedSurface surface(model.lattice);
  surface.rebuild(field);
  double highest = -1.0;
  for (const Vec3& p : test::meshOf(field, surface).vertex) {
    const bool bottom = std::abs(p[1]) < 0.0002 && std::abs(p[0]) < 0.006 && p[2] > 0.0 && p[2] < 0.0149;
    if (bottom) highest = std::max(highest, p[2] - (depth - r));
  }
  return highest;
}

TEST(Carve, StampingLeavesRidgesSweepingNone) {
  for (const double step : {0.002, 0.0028}) {
    const double stamped = ridges(false, step);
    const double swept = ridges(true, step);
    // A ball moved by s leaves r - sqrt(r^2 - s^2 / 4) standing.
    const double expected = 0.0015 - std::sqrt(0.0015 * 0.0015 - 0.25 * step * step);
    std::cout << "steps of " << 1e3 * step << " mm: stamped ridges " << 1e3 * stamped << " mm (expected "
              << 1e3 * expected << "), swept " << 1e3 * swept << " mm\n";
    EXPECT_NEAR(stamped, expected, 0.00012);  // their sharp tops fall between nodes
    EXPECT_LT(swept, 0.00006);                // what a cell of 0.25 mm leaves of the groove's curve
  }
}

/// Affine tissue: x = A X + b now, and carried along from before.
class Affine final : public TissueMotion {
 public:
  Affine(const BrickLattice& lattice, const Mat3& now, const Vec3& shiftNow, const Mat3& before,
         const Vec3& shiftBefore)
      : lattice_(lattice), now_(now), before_(before), shiftNow_(shiftNow), shiftBefore_(shiftBefore) {}
  void fillLanes(std::size_t /*box*/, const Index3& first, int count, NodeLanes& out) const override {
    for (int i = 0; i < count; ++i) {
      const Vec3 rest = lattice_.position(first + Index3(i, 0, 0));
      const Vec3 x = now_ * rest + shiftNow_;
      const Vec3 y = before_ * rest + shiftBefore_;
      for (int k = 0; k < 3; ++k) {
        out.now[k][i] = x[k];
        out.before[k][i] = y[k];
        for (int c = 0; c < 3; ++c) out.gradient[3 * k + c][i] = now_(k, c);
      }
    }
  }

 private:
  const BrickLattice& lattice_;
  Mat3 now_;
  Mat3 before_;
  Vec3 shiftNow_;
  Vec3 shiftBefore_;
};

TEST(Carve, IsRelativeToTheTissue) {
  // Tool and tissue move together: it takes off what it does at rest, not what it swept in the world.
  const FieldModel model = block(0.0005);
  const double depth = carveDepth * model.lattice.cell();
  const Vec3 shift(0.004, -0.002, 0.001);
  const Vec3 a(-0.002, 0.0, 0.0);
  const Vec3 b(0.002, 0.001, 0.0);
  CarvedField still(model);
  still.begin();
  test::carveAtRest(still, {{a, b, a, b, 0.0015}});
  CarvedField moved(model);
  moved.begin();
  const std::vector<SweptCapsule> tool{{a, b, a + shift, b + shift, 0.0015}};
  const std::vector<NodeBox> all{{Index3::Zero(), model.lattice.nodes()}};
  carve(moved, tool, all, Affine(model.lattice, Mat3::Identity(), shift, Mat3::Identity(), Vec3::Zero()), depth);
  EXPECT_GT(still.changed().size(), 0U);
  double worst = 0.0;
  for (std::size_t n = 0; n < model.value.size(); ++n) {
    worst = std::max(worst, std::abs(still.values()[n] - moved.values()[n]));
  }
  EXPECT_LT(worst, 1e-15);
}

TEST(Carve, FieldStaysADistanceUnderStretchAndRotation) {
  // A ball carved in tissue that is drawn out and turned is an ellipsoid at rest; near its surface the field's slope
  // is one, as it would not be without the divisor (0.5 to 1.6 here).
  const FieldModel model = block(0.00025);
  Mat3 stretch = Mat3::Identity();
  stretch.diagonal() << 1.6, 0.8, 0.5;
  Mat3 turn;
  turn << 0.36, 0.48, -0.8, -0.8, 0.6, 0.0, 0.48, 0.64, 0.6;
  const Mat3 f = turn * stretch;
  CarvedField field(model);
  field.begin();
  const std::vector<SweptCapsule> tool{{Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), Vec3::Zero(), 0.004}};
  const std::vector<NodeBox> all{{Index3::Zero(), model.lattice.nodes()}};
  carve(field, tool, all, Affine(model.lattice, f, Vec3::Zero(), f, Vec3::Zero()), model.band);
  CarvedSurface surface(model.lattice);
  surface.rebuild(field);
  int checked = 0;
  Index3 n;
  for (n[2] = 20; n[2] < 100; ++n[2]) {
    for (n[1] = 20; n[1] < 100; ++n[1]) {
      for (n[0] = 20; n[0] < 100; ++n[0]) {
        if (std::abs(field.value(model.lattice.node(n))) > 0.3 * model.lattice.cell()) continue;
        Vec3 slope;
        for (int k = 0; k < 3; ++k) {
          const Index3 e = Index3::Unit(k);
          slope[k] = (field.value(model.lattice.node(n + e)) - field.value(model.lattice.node(n - e))) /
                     (2.0 * model.lattice.cell());
        }
        EXPECT_NEAR(slope.norm(), 1.0, 0.06);
        ++checked;
        // Where it is: on the ellipsoid |F X| = radius.
        EXPECT_NEAR((f * model.lattice.position(n)).norm(), 0.004, 0.6 * model.lattice.cell());
      }
    }
  }
  EXPECT_GT(checked, 300);
  const double hole = -volumeOf(field) + 27e-6;
  EXPECT_NEAR(hole / (4.0 / 3.0 * pi * 0.004 * 0.004 * 0.004 / f.determinant()), 1.0, 0.01);
}

TEST(Carve, HowNodesAreDealtIntoBoxesDoesNotMatter) {
  const FieldModel model = test::lump(41);
  Random random(3, 3);
  CarvedField one(model);
  CarvedField many(model);
  CarvedBricks stateOne;
  CarvedBricks stateMany;
  std::vector<NodeBox> cells;
  for (int z = 0; z < 41; z += 5) {
    for (int y = 0; y < 41; y += 3) {
      for (int x = 0; x < 41; x += 4) {
        const Index3 lower(x, y, z);
        cells.push_back({lower, (lower + Index3(4, 3, 5)).cwiseMin(model.lattice.nodes())});
      }
    }
  }
  const double depth = carveDepth * model.lattice.cell();
  for (int i = 0; i < 30; ++i) {
    const Box box{{-0.02, -0.015, -0.008}, {0.02, 0.015, 0.008}};
    const std::vector<SweptCapsule> tool{test::randomSweep(random, box, 0.0015, 0.003, 0.002)};
    one.begin();
    test::carveAtRest(one, tool);
    one.commit(stateOne);
    many.begin();
    carve(many, tool, cells, UndeformedTissue(model.lattice), depth);
    many.commit(stateMany);
  }
  EXPECT_GT(stateOne.brick.size(), 10U);
  EXPECT_EQ(one.values(), many.values());
  EXPECT_EQ(stateOne.brick, stateMany.brick);
  EXPECT_EQ(stateOne.value, stateMany.value);
}

}  // namespace
}  // namespace calot
