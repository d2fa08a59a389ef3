// SPDX-License-Identifier: GPL-3.0-or-later
// Strokes on fat that is deformed and moves.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "sim/math/fields.h"
#include "tests/sim/fat/support/fat_bodies.h"

namespace calot::fat_stroke_test {
namespace {

constexpr double pi = 3.14159265358979323846;

/// A capsule that moves straight, across its axis, within the body: what it takes off.
double sweptVolume(double r, double segment, double way) {
  return pi * r * r * segment + 4.0 / 3.0 * pi * r * r * r + way * (2.0 * r * segment + pi * r * r);
}

struct Block {
  std::unique_ptr<const FatModel> model =
      test::fatOn(test::boxSurface({0.012, 0.010, 0.008}), test::fatSettings(0.0005, 4), {test::floorPartner(-0.007)});
  SweptCapsule tool{{-0.003, -0.002, 0.0}, {0.001, -0.002, 0.001}, {-0.003, 0.003, 0.0}, {0.001, 0.003, 0.001}, 0.002};
  double segment = (tool.p1 - tool.p0).norm();
  double way = 0.005;
};

/// Deforms rest by x = A X + b, at both ends of the step, the earlier shifted by `slide`.
FatStroke strokeOn(const FatModel& model, const Mat3& a, const Vec3& b, const Vec3& slide, const SweptCapsule& tool,
                   double& left) {
  FatBody body(model);
  FatState state = restState(model);
  for (std::size_t n = 0; n < model.solid().nodes(); ++n) {
    state.solid.position[n] = a * model.solid().rest()[n] + b - slide;
  }
  body.beginStep(state);
  for (Vec3& p : state.solid.position) p += slide;
  const FatStroke stroke = body.stroke(state, {&tool, 1});
  left = body.volume().total();
  return stroke;
}

TEST(FatStroke, TakesOffTheSweepInTheMaterial) {
  const Block block;
  const double swept = sweptVolume(block.tool.radius, block.segment, block.way);
  double left = 0.0;
  const FatStroke rest = strokeOn(*block.model, Mat3::Identity(), Vec3::Zero(), Vec3::Zero(), block.tool, left);
  std::cout << "at rest " << 100.0 * (rest.removed / swept - 1.0) << " % off\n";
  EXPECT_NEAR(rest.removed, swept, 0.01 * swept);
  EXPECT_EQ(rest.islands, 0.0);
  const Vec3 middle = 0.25 * (block.tool.p0 + block.tool.p1 + block.tool.q0 + block.tool.q1);
  EXPECT_LT((rest.where - middle).norm(), 5e-5);

  // Turned by a right angle and moved: the same, to rounding.
  Mat3 turn;
  turn << 0.0, -1.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0;
  const Vec3 shift(0.03, -0.02, 0.05);
  const SweptCapsule turned = test::placed(block.tool, {shift, Quat(turn)});
  double leftTurned = 0.0;
  const FatStroke moved = strokeOn(*block.model, turn, shift, Vec3::Zero(), turned, leftTurned);
  EXPECT_NEAR(moved.removed, rest.removed, 1e-6 * rest.removed);
  EXPECT_LT((moved.where - (shift + turn * rest.where)).norm(), 1e-4);  // of whole nodes

  // Tissue that slides past a tool that stays.
  SweptCapsule still = block.tool;
  const Vec3 slide = still.p0 - still.q0;  // the tissue's motion, seen from the tool
  still.p0 = still.q0;
  still.p1 = still.q1;
  const FatStroke slid = strokeOn(*block.model, Mat3::Identity(), Vec3::Zero(), slide, still, left);
  EXPECT_NEAR(slid.removed, rest.removed, 1e-6 * rest.removed);

  // Stretched: what is taken off in W is more than that at rest by det F.
  const Mat3 stretch = Vec3(1.25, 0.9, 1.1).asDiagonal();
  const FatStroke stretched = strokeOn(*block.model, stretch, Vec3::Zero(), Vec3::Zero(), block.tool, left);
  const double atRest = swept / (1.25 * 0.9 * 1.1);
  std::cout << "stretched " << 100.0 * (stretched.removed / atRest - 1.0) << " % off\n";
  EXPECT_NEAR(stretched.removed, atRest, 0.015 * atRest);
}

TEST(FatStroke, AToolThatIsFarOrStillTouchesNothing) {
  const Block block;
  FatBody body(*block.model);
  FatState state = restState(*block.model);
  const std::vector<std::byte> before = test::bytesOfState(state);
  body.beginStep(state);
  const SweptCapsule far = test::placed(block.tool, {{0.05, 0.0, 0.0}, Quat::Identity()});
  EXPECT_FALSE(body.stroke(state, {&far, 1}).changed);
  EXPECT_EQ(test::bytesOfState(state), before);
  EXPECT_TRUE(body.stroke(state, {&block.tool, 1}).changed);
  SweptCapsule still = block.tool;
  still.p0 = still.q0;
  still.p1 = still.q1;
  EXPECT_LT(body.stroke(state, {&still, 1}).removed, 1e-15);  // it has been there, to rounding
  EXPECT_FALSE(body.stroke(state, {&still, 1}).changed);
}

/// Cuts a block through above its floor.
TEST(FatStroke, WhatIsCutLooseLeavesWithItsCubes) {
  const Block block;
  FatBody body(*block.model);
  FatState state = restState(*block.model);
  for (Vec3& v : state.solid.velocity) v = Vec3(0.01, 0.0, 0.02);
  const double whole = body.volume().total();
  double removed = 0.0;
  double islands = 0.0;
  for (int i = 0; i <= 30; ++i) {
    const double y = -0.015 + 0.001 * i;
    const SweptCapsule cut[1] = {
        {{-0.016, y, -0.002}, {0.016, y, -0.002}, {-0.016, y + 0.001, -0.002}, {0.016, y + 0.001, -0.002}, 0.0008}};
    body.beginStep(state);
    const FatStroke stroke = body.stroke(state, cut);
    removed += stroke.removed;
    islands += stroke.islands;
  }
  // Left: the lowest 5.2 mm of 16 mm.
  EXPECT_NEAR(body.volume().total(), 0.0052 / 0.016 * whole, 0.03 * whole);
  EXPECT_NEAR(removed, whole - body.volume().total(), 1e-9 * whole);
  EXPECT_NEAR(islands, 0.0092 / 0.016 * whole, 0.05 * whole);
  int empty = 0;
  int still = 0;
  for (std::size_t c = 0; c < body.fill().size(); ++c) {
    const double z = block.model->solid().rest()[slot(block.model->solid().cubes()[c][0])][2];
    if (z > -0.001) {
      EXPECT_EQ(body.fill()[c], 0.0);
    }
    empty += body.fill()[c] == 0.0 ? 1 : 0;
  }
  EXPECT_GT(empty, 100);
  for (std::size_t n = 0; n < state.solid.velocity.size(); ++n) {
    const bool loose = block.model->solid().rest()[n][2] > 0.001;
    if (loose) {
      EXPECT_EQ(state.solid.velocity[n].norm(), 0.0);
    }
    still += loose ? 1 : 0;
  }
  EXPECT_GT(still, 100);
  // And it still can be solved.
  SolidSolver solver;
  SerialExecutor executor;
  const SolveReport report = solver.solveUnconstrained(block.model->solid(), state.solid, {0.0, 0.0, -9.81}, {}, {},
                                                       executor, {{}, body.fill()});
  EXPECT_TRUE(report.converged);
}

TEST(FatStroke, TiesFadeWithWhatTheyHold) {
  const Block block;
  FatBody body(*block.model);
  FatState state = restState(*block.model);
  double before = 0.0;
  for (std::size_t t = 0; t < block.model->allTies().size(); ++t) before += body.tieShare(t);
  EXPECT_EQ(before, static_cast<double>(block.model->allTies().size()));
  const SweptCapsule low[1] = {
      {{-0.004, -0.004, -0.008}, {0.004, -0.004, -0.008}, {-0.004, 0.004, -0.008}, {0.004, 0.004, -0.008}, 0.0025}};
  body.beginStep(state);
  EXPECT_TRUE(body.stroke(state, low).changed);
  int gone = 0;
  int part = 0;
  int whole = 0;
  for (std::size_t t = 0; t < block.model->allTies().size(); ++t) {
    const double share = body.tieShare(t);
    gone += share == 0.0 ? 1 : 0;
    part += share > 0.0 && share < 1.0 ? 1 : 0;
    whole += share == 1.0 ? 1 : 0;
    const Vec3& p = block.model->allTies()[t].rest;
    if (std::abs(p[0]) < 0.003 && std::abs(p[1]) < 0.003) {
      EXPECT_EQ(share, 0.0);
    }
    if (std::abs(p[0]) > 0.0095) {
      EXPECT_EQ(share, 1.0);
    }
  }
  EXPECT_GT(gone, 5);
  EXPECT_GT(part, 5);
  EXPECT_GT(whole, 5);
}

}  // namespace
}  // namespace calot::fat_stroke_test
