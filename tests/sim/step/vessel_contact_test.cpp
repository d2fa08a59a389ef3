// SPDX-License-Identifier: GPL-3.0-or-later
// Vessels against organs and against one another: they do not pass, keep momentum, gain no energy, slide freely, rest,
// and cost nothing where they are far apart.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <vector>

#include "sim/contact/surface_patches.h"
#include "sim/step/tissue_contacts.h"
#include "sim/vessel/beam_state.h"
#include "tests/sim/scene/support/scenes.h"

namespace calot {
namespace {

constexpr double radius = 0.002;

VesselDescription tube(const std::string& name, const Vec3& from, const Vec3& to, std::uint32_t elements) {
  VesselDescription d;
  d.name = name;
  d.appearance = "duct";
  d.path = {from, 0.5 * (from + to), to};
  d.elements = elements;
  d.radius = radius;
  d.material = {2e5, 0.45, 1050.0, 1.0, 0.005};
  return d;
}

/// A duct held at its ends 5 mm over the block.
SceneDescription overBlock(std::uint32_t tetrahedra, std::uint32_t elements, std::uint32_t ticksPerStep) {
  SceneDescription scene = test::blockScene(tetrahedra, 8);
  scene.name = "duct over a block";
  scene.ticksPerStep = ticksPerStep;
  const double height = test::blockTop + 0.005 + radius;
  VesselDescription d = tube("duct", Vec3(-0.045, 0.0, height), Vec3(0.045, 0.0, height), elements);
  d.start.kind = d.end.kind = VesselEndDescription::Kind::fixed;
  scene.vessels.push_back(d);
  scene.hands[1].home = Vec3(0.05, 0.05, 0.08);
  return scene;
}

/// The same with a block that is lifted by 12 mm in half a second, against the duct.
SceneDescription liftedBlock(std::uint32_t tetrahedra, std::uint32_t elements, std::uint32_t ticksPerStep) {
  SceneDescription scene = overBlock(tetrahedra, elements, ticksPerStep);
  scene.organs[0].anchors.clear();
  scene.vessels[0].material.youngModulus = 1.5e6;
  RetractionDescription lift;
  lift.organ = "block";
  lift.centre = Vec3(0.0, 0.0, -0.1);
  lift.radius = 0.095;
  lift.displacement = Vec3(0.0, 0.0, 0.012);
  lift.duration = 0.5;
  lift.stiffness = 3000.0;
  lift.damping = 30.0;
  scene.retraction.push_back(lift);
  for (HandDescription& hand : scene.hands) hand.home = Vec3(hand.home[0], 0.08, 0.1);
  return scene;
}

/// A block that hangs free, without damping by mass.
SceneDescription freeBlock(std::uint32_t tetrahedra) {
  SceneDescription scene = test::blockScene(tetrahedra, 8);
  scene.organs[0].anchors.clear();
  scene.organs[0].material.massDamping = 0.0;
  scene.solver.sleeping = false;
  scene.solver.tolerance = scene.solver.responseTolerance = 1e-7;
  scene.solver.speedTolerance = scene.solver.responseSpeedTolerance = 0.0;
  for (HandDescription& hand : scene.hands) hand.home = Vec3(hand.home[0], 0.08, 0.1);
  return scene;
}

/// How far a vessel's wall stands in an organ: its centre line in nine places of each element against every triangle
/// (m; below zero: how far from it).
double depthIn(const Model& model, const State& state, std::size_t organ, std::size_t tree) {
  const OrganModel& o = model.organs()[organ];
  std::vector<Vec3> skin;
  o.embedding.map(state.organ[organ].position, skin);
  std::vector<std::uint32_t> all(o.surface.patches().size());
  std::iota(all.begin(), all.end(), 0U);
  const BeamModel& beams = model.vesselTrees()[tree].beams;
  double deepest = -1.0;
  for (const BeamElement& e : beams.elements()) {
    const double wall = beams.branches()[static_cast<std::size_t>(e.branch)].section.outerRadius;
    for (int k = 0; k <= 8; ++k) {
      const Vec3 p = state.vessel[tree].position[static_cast<std::size_t>(e.a)] +
                     k / 8.0 *
                         (state.vessel[tree].position[static_cast<std::size_t>(e.b)] -
                          state.vessel[tree].position[static_cast<std::size_t>(e.a)]);
      const NearestPoint near = nearestPoint(o.surface, skin, all, p, 0.1);
      if (!near.found) continue;
      const double distance = std::sqrt(near.point.squaredDistance);
      deepest = std::max(deepest, wall + (near.inside ? distance : -distance));
    }
  }
  return deepest;
}

Vec3 momentumOf(const Model& model, const State& state) {
  Vec3 p = Vec3::Zero();
  for (std::size_t o = 0; o < state.organ.size(); ++o) {
    for (std::size_t n = 0; n < state.organ[o].velocity.size(); ++n)
      p += model.organs()[o].solid.mass()[n] * state.organ[o].velocity[n];
  }
  for (std::size_t t = 0; t < state.vessel.size(); ++t) {
    for (std::size_t n = 0; n < state.vessel[t].velocity.size(); ++n)
      p += model.vesselTrees()[t].beams.mass()[n] * state.vessel[t].velocity[n];
  }
  return p;
}

double kineticEnergy(const Model& model, const State& state) {
  double e = 0.0;
  for (std::size_t o = 0; o < state.organ.size(); ++o) {
    for (std::size_t n = 0; n < state.organ[o].velocity.size(); ++n)
      e += 0.5 * model.organs()[o].solid.mass()[n] * state.organ[o].velocity[n].squaredNorm();
  }
  for (std::size_t t = 0; t < state.vessel.size(); ++t) {
    for (std::size_t n = 0; n < state.vessel[t].velocity.size(); ++n)
      e += 0.5 * model.vesselTrees()[t].beams.mass()[n] * state.vessel[t].velocity[n].squaredNorm();
  }
  return e;
}

void throwVessel(State& state, std::size_t tree, const Vec3& velocity) {
  std::fill(state.vessel[tree].velocity.begin(), state.vessel[tree].velocity.end(), velocity);
}

TEST(VesselContact, PressedByAnOrganItDoesNotPass) {
  for (const std::uint32_t tetrahedra : {300U, 1500U}) {
    for (const std::uint32_t elements : {20U, 60U}) {
      for (const std::uint32_t ticks : {2U, 10U, 20U}) {
        SCOPED_TRACE(testing::Message() << tetrahedra << " tetrahedra, " << elements << " elements, " << ticks
                                        << " ms");
        const std::unique_ptr<const Model> model = test::buildModel(liftedBlock(tetrahedra, elements, ticks));
        ASSERT_TRUE(model);
        test::Rig rig(*model);
        double deepest = -1.0;
        double force = 0.0;
        for (double t = 0.0; t < 1.0; t += model->stepSeconds()) {
          const StepResult& result = rig.step(model->scene().hands[0].home);
          deepest = std::max(deepest, depthIn(*model, rig.state, 0, 0));
          force = std::accumulate(rig.state.tissue.force.begin(), rig.state.tissue.force.end(), 0.0);
          EXPECT_EQ(result.misses & miss::speed, 0U) << "at " << t << " s";
        }
        EXPECT_GT(force, 0.2) << "it must be pressed";
        EXPECT_GT(deepest, -1e-4);
        EXPECT_LT(deepest, 4e-4);
      }
    }
  }
}

TEST(VesselContact, ThrownAtAnOrganItDoesNotPass) {
  for (const std::uint32_t ticks : {1U, 5U, 10U, 20U}) {
    for (const double speed : {0.1, 0.5, 2.0}) {
      SCOPED_TRACE(testing::Message() << ticks << " ms, " << speed << " m/s");
      SceneDescription scene = test::blockScene(300, 8);
      scene.ticksPerStep = ticks;
      scene.vessels.push_back(tube("loose", Vec3(-0.02, 0.004, 0.03), Vec3(0.02, 0.004, 0.03), 20));
      for (HandDescription& hand : scene.hands) hand.home = Vec3(hand.home[0], 0.08, 0.1);
      const std::unique_ptr<const Model> model = test::buildModel(scene);
      ASSERT_TRUE(model);
      test::Rig rig(*model);
      throwVessel(rig.state, 0, Vec3(0.0, 0.0, -speed));
      rig.state.vessel[0].quietSteps = 0;
      double deepest = -1.0;
      for (double t = 0.0; t < 0.2; t += model->stepSeconds()) {
        rig.step(scene.hands[0].home);
        deepest = std::max(deepest, depthIn(*model, rig.state, 0, 0));
      }
      EXPECT_GT(deepest, -2e-3) << "it must have come down";
      EXPECT_LT(deepest, 1.2e-3);
      double lowest = 1.0;
      for (const Vec3& p : rig.state.vessel[0].position) lowest = std::min(lowest, p[2]);
      EXPECT_GT(lowest, test::blockTop - 0.004) << "and be above the block";
    }
  }
}

TEST(VesselContact, AFreePairKeepsItsMomentumAndGainsNoEnergy) {
  for (const std::uint32_t ticks : {1U, 5U, 10U, 20U}) {
    SCOPED_TRACE(testing::Message() << ticks << " ms");
    SceneDescription scene = freeBlock(300);
    scene.ticksPerStep = ticks;
    VesselDescription loose = tube("loose", Vec3(-0.02, 0.004, 0.02), Vec3(0.02, 0.006, 0.021), 20);
    loose.material.massDamping = 0.0;
    scene.vessels.push_back(loose);
    const std::unique_ptr<const Model> model = test::buildModel(scene);
    ASSERT_TRUE(model);
    test::Rig rig(*model);
    throwVessel(rig.state, 0, Vec3(0.05, 0.0, -0.3));
    const Vec3 before = momentumOf(*model, rig.state);
    const double most = kineticEnergy(*model, rig.state);
    bool met = false;
    for (double t = 0.0; t < 0.2; t += model->stepSeconds()) {
      rig.step(scene.hands[0].home);
      met = met || !rig.state.tissue.key.empty();
      EXPECT_LT((momentumOf(*model, rig.state) - before).norm(), 2e-4 * before.norm()) << "at " << t;
      EXPECT_LE(kineticEnergy(*model, rig.state), most * (1.0 + 1e-6)) << "at " << t;
    }
    EXPECT_TRUE(met);
  }
}

TEST(VesselContact, SlidesWithoutFrictionAsOrgansDo) {
  SceneDescription scene = freeBlock(300);
  VesselDescription loose = tube("loose", Vec3(-0.02, 0.0, 0.018), Vec3(0.02, 0.0, 0.018), 20);
  loose.material.massDamping = 0.0;
  scene.vessels.push_back(loose);
  const std::unique_ptr<const Model> model = test::buildModel(scene);
  ASSERT_TRUE(model);
  test::Rig rig(*model);
  throwVessel(rig.state, 0, Vec3(0.0, 0.1, -0.05));
  double mass = 0.0;
  for (const double m : model->vesselTrees()[0].beams.mass()) mass += m;
  bool met = false;
  for (int i = 0; i < 10; ++i) {
    rig.step(scene.hands[0].home);
    met = met || !rig.state.tissue.key.empty();
    double along = 0.0;
    for (std::size_t n = 0; n < rig.state.vessel[0].velocity.size(); ++n)
      along += model->vesselTrees()[0].beams.mass()[n] * rig.state.vessel[0].velocity[n][1];
    EXPECT_NEAR(along, 0.1 * mass, 0.005 * mass * 0.1 + 1e-9);
  }
  EXPECT_TRUE(met);
}

TEST(VesselContact, HangingByACutEndItComesToRestOnTheOrgan) {
  for (const std::uint32_t ticks : {5U, 10U}) {
    SceneDescription scene = test::blockScene(400, 8);
    scene.ticksPerStep = ticks;
    scene.gravity = Vec3(0.0, 0.0, -9.81);
    const double height = test::blockTop + 0.008;
    VesselDescription d = tube("duct", Vec3(-0.045, 0.0, height), Vec3(0.045, 0.0, height), 30);
    d.material.youngModulus = 5e4;
    d.material.massDamping = 10.0;
    d.start.kind = d.end.kind = VesselEndDescription::Kind::fixed;
    scene.vessels.push_back(d);
    for (HandDescription& hand : scene.hands) hand.home = Vec3(hand.home[0], 0.08, 0.1);
    const std::unique_ptr<const Model> model = test::buildModel(scene);
    ASSERT_TRUE(model);
    test::Rig rig(*model);
    rig.state.vessel[0].parting[24] = Parting::cut;
    rig.state.vessel[0].partedAt[24] = 0.5;
    rig.state.vessel[0].quietSteps = 0;  // it slept, as drawn
    double deepest = -1.0;
    for (double t = 0.0; t < 5.0; t += model->stepSeconds()) {
      rig.step(scene.hands[0].home);
      deepest = std::max(deepest, depthIn(*model, rig.state, 0, 0));
    }
    EXPECT_GT(deepest, -1e-4) << "it must have come down";
    EXPECT_LT(deepest, 4e-4);
    double fastest = 0.0;
    for (const Vec3& v : rig.state.vessel[0].velocity) fastest = std::max(fastest, v.norm());
    EXPECT_LT(fastest, 1e-4) << "and lie still";
    const StepResult& result = rig.step(scene.hands[0].home);
    EXPECT_TRUE(result.vessel[0].asleep) << "so that it sleeps";
    EXPECT_TRUE(result.organ[0].asleep);
  }
}

TEST(VesselContact, WhatIsDrawnIntoEachOtherDoesNotPush) {
  SceneDescription scene = test::blockScene(300, 8);
  scene.solver.sleeping = false;
  // One runs into the block, one along its surface half sunk in, one crosses the second.
  scene.vessels.push_back(tube("into", Vec3(0.01, 0.0, 0.04), Vec3(0.012, 0.002, -0.005), 30));
  scene.vessels.push_back(tube("along", Vec3(-0.02, -0.02, 0.0155), Vec3(-0.01, 0.02, 0.0145), 30));
  scene.vessels.push_back(tube("across", Vec3(-0.025, 0.0, 0.017), Vec3(-0.002, 0.0, 0.018), 20));
  for (VesselDescription& v : scene.vessels) v.start.kind = VesselEndDescription::Kind::fixed;
  for (HandDescription& hand : scene.hands) hand.home = Vec3(hand.home[0], 0.08, 0.1);
  const std::unique_ptr<const Model> model = test::buildModel(scene);
  ASSERT_TRUE(model);
  test::Rig rig(*model);
  for (int i = 0; i < 100; ++i) {
    const StepResult& result = rig.step(scene.hands[0].home);
    for (const double force : rig.state.tissue.force) EXPECT_EQ(force, 0.0);
    EXPECT_LT(result.contact.tissueDepth, 1e-9);
  }
  EXPECT_LT(rig.state.organ[0].maxDisplacement, 1e-12);
  for (const BeamState& vessel : rig.state.vessel) EXPECT_LT(vessel.maxDisplacement, 1e-12);
}

TEST(VesselContact, TwoVesselsDoNotPassEachOther) {
  for (const std::uint32_t ticks : {2U, 10U, 20U}) {
    for (const std::uint32_t elements : {10U, 40U}) {
      SCOPED_TRACE(testing::Message() << ticks << " ms, " << elements << " elements");
      SceneDescription scene = freeBlock(300);
      scene.ticksPerStep = ticks;
      VesselDescription over = tube("over", Vec3(-0.02, 0.001, 0.06), Vec3(0.02, 0.0, 0.06), elements);
      over.material.massDamping = 0.0;
      VesselDescription under = tube("under", Vec3(0.0, -0.02, 0.045), Vec3(0.002, 0.02, 0.046), elements);
      under.material.massDamping = 0.0;
      scene.vessels = {over, under};
      const std::unique_ptr<const Model> model = test::buildModel(scene);
      ASSERT_TRUE(model);
      test::Rig rig(*model);
      throwVessel(rig.state, 0, Vec3(0.0, 0.0, -0.4));
      const Vec3 before = momentumOf(*model, rig.state);
      const double most = kineticEnergy(*model, rig.state);
      double nearest = 1.0;
      bool met = false;
      for (double t = 0.0; t < 0.06; t += model->stepSeconds()) {
        rig.step(scene.hands[0].home);
        met = met || !rig.state.tissue.key.empty();
        EXPECT_LT((momentumOf(*model, rig.state) - before).norm(), 1e-6 * before.norm());
        EXPECT_LE(kineticEnergy(*model, rig.state), most * (1.0 + 1e-9));
        std::vector<VesselCapsule> a, b;
        vesselCapsules(model->vesselTrees()[0].beams, rig.state.vessel[0], 0, a);
        vesselCapsules(model->vesselTrees()[1].beams, rig.state.vessel[1], 0, b);
        for (const VesselCapsule& p : a) {
          for (const VesselCapsule& q : b) {
            const SegmentSegment s = closestSegments(p.p0, p.p1, q.p0, q.p1);
            nearest = std::min(nearest, std::sqrt(s.squaredDistance) * (s.first[2] > s.second[2] ? 1.0 : -1.0));
          }
        }
      }
      EXPECT_TRUE(met);
      EXPECT_GT(nearest, 2.0 * radius - 1e-3);
    }
  }
}

TEST(VesselContact, OneThatSleepsIsWokenByAPressAndNotByATouch) {
  const std::unique_ptr<const Model> model = test::buildModel(overBlock(300, 40, 10));
  ASSERT_TRUE(model);
  test::Rig rig(*model);
  for (int i = 0; i < 60; ++i) EXPECT_TRUE(rig.step(Vec3(0.003, 0.0, 0.06)).organ[0].asleep);
  bool duct = false;
  bool block = false;
  for (int i = 0; i < 100 && !block; ++i) {  // presses the duct alone, until that presses the block
    const StepResult& result = rig.step(Vec3(0.003, 0.0, 0.04 - 0.0003 * i));
    duct = duct || !result.vessel[0].asleep;
    block = !result.organ[0].asleep;
    EXPECT_TRUE(!block || result.hand[0].structureForce[1] > 0.0);
  }
  EXPECT_TRUE(duct);
  EXPECT_TRUE(block);
}

TEST(VesselContact, WhatIsFarApartIsNotSearched) {
  SceneDescription scene = overBlock(300, 40, 10);
  scene.vessels[0].path = {Vec3(-0.045, 0.0, 0.04), Vec3(0.0, 0.0, 0.04), Vec3(0.045, 0.0, 0.04)};
  scene.vessels.push_back(tube("other", Vec3(-0.045, 0.02, 0.04), Vec3(0.045, 0.02, 0.04), 40));
  const std::unique_ptr<const Model> model = test::buildModel(scene);
  ASSERT_TRUE(model);
  SerialExecutor executor;
  Bodies bodies(*model, executor);
  Surfaces surfaces(*model, bodies, nullptr, executor);
  State state = initialState(*model, 1);
  bodies.beginStep(state);
  TissueTravel travel(*model);
  VesselContacts contacts(*model, travel);
  std::vector<ContactBlock> blocks;
  for (int i = 0; i < 20; ++i) {  // both move about, 25 mm over the block
    for (BeamState& v : state.vessel) {
      for (Vec3& p : v.position) p[2] += 0.0005 * (i % 2 == 0 ? 1.0 : -1.0);
    }
    surfaces.invalidate();
    surfaces.refresh(state);
    travel.follow(surfaces, bodies, state, {true, true, true});
    contacts.run(surfaces, travel, state, bodies.step(), {true, true, true}, blocks);
    EXPECT_EQ(contacts.searches(), 0U);
    EXPECT_TRUE(blocks.empty());
  }
  // Near it, searches are repeated only after motion.
  for (Vec3& p : state.vessel[0].position) p[2] = test::blockTop + radius + 0.002;
  std::size_t first = 0;
  for (int i = 0; i < 10; ++i) {
    surfaces.invalidate();
    surfaces.refresh(state);
    travel.follow(surfaces, bodies, state, {true, true, true});
    contacts.run(surfaces, travel, state, bodies.step(), {true, true, true}, blocks);
    if (i == 0) first = contacts.searches();
    EXPECT_TRUE(i == 0 || contacts.searches() == 0U);
  }
  EXPECT_GT(first, 0U);
  travel.follow(surfaces, bodies, state, {false, false, false});
  contacts.run(surfaces, travel, state, bodies.step(), {false, false, false}, blocks);
  EXPECT_EQ(contacts.searches(), 0U) << "what sleeps";
  EXPECT_TRUE(blocks.empty());
}

TEST(VesselContact, WhatIsRememberedChangesNothing) {
  const std::unique_ptr<const Model> model = test::buildModel(overBlock(300, 40, 10));
  ASSERT_TRUE(model);
  test::Rig warm(*model);
  test::Rig cold(*model);
  for (int i = 0; i < 150; ++i) {
    const double z = 0.03 - 0.016 * std::sin(0.06 * i);
    cold.stepper.invalidate();
    warm.step(Vec3(0.003, 0.0001 * i, z));
    cold.step(Vec3(0.003, 0.0001 * i, z));
    ASSERT_EQ(digestOf(warm.state), digestOf(cold.state)) << "step " << i;
  }
  EXPECT_GT(warm.state.organ[0].maxDisplacement, 0.0);
}

TEST(VesselContact, RestoresInMidContact) {
  const std::unique_ptr<const Model> model = test::buildModel(overBlock(300, 40, 10));
  ASSERT_TRUE(model);
  test::Rig rig(*model);
  for (int i = 0; i < 60; ++i) rig.step(Vec3(0.003, 0.0, 0.04 - 0.0005 * i));
  ASSERT_FALSE(rig.state.tissue.key.empty());
  EXPECT_TRUE(std::is_sorted(rig.state.tissue.key.begin(), rig.state.tissue.key.end()));
  test::Rig other(*model);
  ASSERT_TRUE(restoreState(*model, saveState(rig.state), other.state));
  other.stepper.invalidate();
  for (int i = 60; i < 90; ++i) {
    rig.step(Vec3(0.003, 0.0, 0.014));
    other.step(Vec3(0.003, 0.0, 0.014));
    ASSERT_EQ(digestOf(rig.state), digestOf(other.state)) << "step " << i;
  }
}

}  // namespace
}  // namespace calot
