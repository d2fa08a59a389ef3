// SPDX-License-Identifier: GPL-3.0-or-later
// Clips, cuts and tears: what they do to a vessel, and how clips sit.
#include "sim/vessel/beam_state.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

#include "tests/sim/vessel/support/beams.h"

namespace calot {
namespace {

/// A straight tube of 40 mm along x, 2 mm wide, joined at its middle by a branch.
BeamModel straightDuct() {
  BeamBranch trunk;
  for (int i = 0; i <= 40; ++i) trunk.node.emplace_back(0.001 * i, 0.0, 0.0);
  trunk.section = {0.001, 0.0004};
  trunk.material = {1e6, 0.45, 1060.0, 5.0, 0.01, 0.5};
  trunk.fixedStart = true;
  BeamBranch twig = trunk;
  for (int i = 0; i <= 40; ++i) twig.node[static_cast<std::size_t>(i)] = Vec3(0.02, 0.0005 * i, 0.0);
  twig.join = 20;
  twig.fixedStart = false;
  return BeamModel({trunk, twig});
}

ClipAttempt clipAt(const BeamModel& model, double place, double depth = 0.004) {
  return {pointAt(model, 0, place), 0.0015, 0.008, depth, 0.0, 1.0};
}

TEST(Clips, AWellSetClipEnclosesTheVesselAndIsNearNothing) {
  const BeamModel model = straightDuct();
  const BeamState state = restState(model);
  const ClipSeat seat = clipSeat(model, state, clipAt(model, 0.010));
  EXPECT_EQ(seat.enclosed, 1.0);
  EXPECT_FALSE(seat.missed);
  EXPECT_EQ(seat.clip, -1);
  EXPECT_EQ(seat.clipGap, ClipSeat::none);
  EXPECT_NEAR(seat.junctionGap, 0.010 - 0.00075, 1e-12);
  EXPECT_NEAR(seat.endGap, 0.010 - 0.00075, 1e-12) << "to the vessel's start";
}

TEST(Clips, DepthDecidesWhetherTheSectionIsEnclosed) {
  const BeamModel model = straightDuct();
  const BeamState state = restState(model);
  const double wide = 0.5 * std::numbers::pi * 0.001;  // half the flattened width
  const auto at = [&](double depth) { return clipSeat(model, state, clipAt(model, 0.01, depth)); };
  EXPECT_NEAR(at(1.001 * wide).enclosed, 1.0, 1e-12);
  EXPECT_NEAR(at(0.008 - 1.001 * wide).enclosed, 1.0, 1e-12);
  EXPECT_NEAR(at(0.008).enclosed, 0.5, 1e-12) << "the tips reach the middle of the vessel: half of it";
  EXPECT_FALSE(at(0.008).missed);
  EXPECT_TRUE(at(0.008 + 1.01 * wide).missed);
  EXPECT_TRUE(at(-1.01 * wide).missed);
}

TEST(Clips, OtherClipsJunctionsAndEndsAreSeen) {
  const BeamModel model = straightDuct();
  BeamState state = restState(model);
  setClip(model, state, clipAt(model, 0.008), 1.0);
  const auto at = [&](double place) { return clipSeat(model, state, clipAt(model, place)); };
  EXPECT_NEAR(at(0.009).clipGap, -0.0005, 1e-12) << "they overlap";
  EXPECT_EQ(at(0.010).clip, 0);
  EXPECT_NEAR(at(0.010).clipGap, 0.0005, 1e-12);
  EXPECT_NEAR(at(0.012).clipGap, 0.0025, 1e-12);
  EXPECT_NEAR(at(0.018).junctionGap, 0.002 - 0.00075, 1e-12);
  EXPECT_NEAR(at(0.020).junctionGap, -0.00075, 1e-12) << "across the junction";
  EXPECT_NEAR(at(0.0395).endGap, -0.00025, 1e-12) << "beyond the end";
  // A parting between them: neither the other clip nor the junction counts; the stump's end does.
  part(state, pointAt(model, 0, 0.0095), Parting::cut);
  EXPECT_EQ(at(0.010).clip, -1);
  EXPECT_LT(at(0.010).endGap, 0.0);
}

TEST(Clips, AClippedWallNeitherStretchesNorMovesAlong) {
  const BeamModel model = straightDuct();
  for (const bool clipped : {false, true}) {
    BeamState state = restState(model);
    if (clipped) setClip(model, state, {pointAt(model, 0, 0.030), 0.002, 0.008, 0.004, 0.0, 1.0}, 1.0);
    std::vector<BeamAttachment> pull{{40, 1e6, 1.0, model.rest()[40] + Vec3(0.002, 0.0, 0.0), Vec3::Zero()}};
    BeamLoads loads;
    loads.attachments = pull;
    ASSERT_LT(test::settle(model, state, loads, 0.01, 20000), 1e-9);
    BeamSolver solver;
    solver.solveUnconstrained(model, state, loads, 0.01);
    const BeamReport report = solver.advance(model, state);
    const double free = solver.strain()[10];
    EXPECT_GT(free, 0.04);
    // Tension is the same all along: E A times the strain of a free element.
    EXPECT_NEAR(solver.tension()[10], 1e6 * model.branches()[0].section.area() * free, 1e-6);
    EXPECT_NEAR(solver.tension()[30], solver.tension()[10], 1e-4 * report.maxTension);
    EXPECT_NEAR(solver.strain()[30] / free, clipped ? 0.02 : 1.0, 1e-3);
  }
}

/// Setting a clip on a stretched vessel keeps that stretch where the clip is, without a jerk.
TEST(Clips, SettingAClipMovesNothing) {
  const BeamModel model = straightDuct();
  BeamState state = restState(model);
  std::vector<BeamAttachment> pull{{40, 1e6, 1.0, model.rest()[40] + Vec3(0.003, 0.001, 0.0), Vec3::Zero()}};
  BeamLoads loads;
  loads.attachments = pull;
  ASSERT_LT(test::settle(model, state, loads, 0.01, 20000), 1e-9);
  const std::vector<Vec3> before = state.position;
  setClip(model, state, {pointAt(model, 0, 0.0303), 0.0024, 0.008, 0.004, 0.0, 1.0}, 1.0);
  setClip(model, state, {pointAt(model, 0, 0.0310), 0.0024, 0.008, 0.004, 0.0, 1.0}, 1.0);
  ASSERT_LT(test::settle(model, state, loads, 0.01, 20000), 1e-9);
  for (std::size_t n = 0; n < before.size(); ++n) EXPECT_LT((state.position[n] - before[n]).norm(), 1e-9);
  // Let loose, the wall under the clips stays nearly as long as it was.
  ASSERT_LT(test::settle(model, state, {}, 0.01, 20000), 1e-9);
  EXPECT_GT((state.position[31] - state.position[30]).norm(), 0.001 * (1.0 + 0.9 * 0.003 / 0.04));
  EXPECT_NEAR((state.position[11] - state.position[10]).norm(), 0.001, 1e-9);
}

TEST(Cuts, BetweenClipsNothingOpens) {
  const BeamModel model = straightDuct();
  BeamState state = restState(model);
  setClip(model, state, clipAt(model, 0.006), 1.0);
  setClip(model, state, clipAt(model, 0.009), 1.0);
  setClip(model, state, clipAt(model, 0.015), 1.0);
  const CutSides cut = cutSides(model, state, pointAt(model, 0, 0.012));
  EXPECT_EQ(cut.clipBefore, 1);
  EXPECT_EQ(cut.clipAfter, 2);
  EXPECT_EQ(cut.before, 2U);
  EXPECT_EQ(cut.after, 1U);
  EXPECT_NEAR(cut.gapBefore, 0.003 - 0.00075, 1e-12);
  EXPECT_FALSE(cut.opensBefore || cut.opensAfter || cut.throughClip);
}

TEST(Cuts, OpenSidesLeak) {
  const BeamModel model = straightDuct();
  BeamState state = restState(model);
  CutSides cut = cutSides(model, state, pointAt(model, 0, 0.012));
  EXPECT_TRUE(cut.opensBefore && cut.opensAfter);
  // A clip that is half on, and one beyond the junction, close nothing.
  setClip(model, state, clipAt(model, 0.006), 0.7);
  setClip(model, state, clipAt(model, 0.030), 1.0);
  cut = cutSides(model, state, pointAt(model, 0, 0.012));
  EXPECT_TRUE(cut.opensBefore && cut.opensAfter);
  setClip(model, state, clipAt(model, 0.009), 1.0);
  cut = cutSides(model, state, pointAt(model, 0, 0.012));
  EXPECT_FALSE(cut.opensBefore);
  EXPECT_TRUE(cut.opensAfter);
  // Through the clip itself: it no longer closes anything.
  cut = cutSides(model, state, pointAt(model, 0, 0.0092));
  EXPECT_TRUE(cut.throughClip && cut.opensBefore);
  // What is parted already has nothing behind it to leak.
  part(state, pointAt(model, 0, 0.015), Parting::cut);
  cut = cutSides(model, state, pointAt(model, 0, 0.012));
  EXPECT_FALSE(cut.opensAfter);
}

TEST(Tears, AVesselPulledTooFarTearsOnceAndLetsGo) {
  const BeamModel model = straightDuct();
  BeamState state = restState(model);
  BeamSolver solver;
  std::vector<BeamAttachment> pull{{40, 1e6, 1.0, model.rest()[40], Vec3(0.02, 0.0, 0.0)}};
  int torn = -1;
  double tension = 0.0;
  int tears = 0;
  for (int k = 0; k < 400; ++k) {
    BeamLoads loads;
    loads.attachments = pull;
    solver.solveUnconstrained(model, state, loads, 0.01);
    const BeamReport report = solver.advance(model, state);
    ASSERT_TRUE(test::isFinite(state));
    pull[0].target += 0.01 * pull[0].velocity;
    if (report.torn >= 0) {
      torn = report.torn;
      ++tears;
      EXPECT_GT(report.maxStrain, 0.5);
    }
    if (tears == 0) tension = report.maxTension;
  }
  ASSERT_EQ(tears, 1);
  EXPECT_EQ(state.parting[static_cast<std::size_t>(torn)], Parting::torn);
  EXPECT_GT(state.peakStrain[static_cast<std::size_t>(torn)], 0.5);
  EXPECT_NEAR(tension, 0.5 * 1e6 * model.branches()[0].section.area(), 0.1 * tension);
  // The held stump has gone back to its own length.
  solver.solveUnconstrained(model, state, {}, 0.01);
  EXPECT_LT(solver.advance(model, state).maxTension, 0.05 * tension);
  std::printf("tore at element %d under %.3f N\n", torn, tension);
}

TEST(CentreLine, NearestPlaceFindsArcLengths) {
  const BeamModel model({test::duct(40, true, true)});
  BeamState state = restState(model);
  for (const double place : {0.0, 0.0051, 0.02, 0.031}) {
    const BeamPoint where = pointAt(model, 0, place);
    const Pose pose = centreLine(model, state, where);
    double distance = 0.0;
    const Vec3 beside = pose.position + 0.001 * (pose.orientation * Vec3::UnitX());
    const BeamPoint found = closestPoint(model, state, 0, beside, distance);
    EXPECT_NEAR(found.arcLength, place, 5e-5);
    EXPECT_NEAR(distance, 0.001, 2e-5);
  }
  // Next to a stump, the stump is found, not the chord that was.
  part(state, pointAt(model, 0, 0.02), Parting::cut);
  for (std::size_t n = 20; n < model.nodes(); ++n) state.position[n] += Vec3(0.0, 0.03, 0.0);
  double distance = 0.0;
  const Vec3 stump = centreLine(model, state, pointAt(model, 0, 0.0195), Stump::before).position;
  EXPECT_NEAR(closestPoint(model, state, 0, stump, distance).arcLength, 0.0195, 1e-4);
  EXPECT_LT(distance, 1e-4);
}

}  // namespace
}  // namespace calot
