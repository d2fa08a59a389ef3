// SPDX-License-Identifier: GPL-3.0-or-later
// Mechanics of fat that hangs on ties.
#include <gtest/gtest.h>

#include <cmath>
#include <iostream>

#include "sim/solid/solid.h"
#include "tests/sim/fat/support/fat_bodies.h"

namespace calot::fat_motion_test {
namespace {

const std::vector<FatPartner> floorOnly{test::floorPartner(-0.003)};

std::unique_ptr<const FatModel> lump() {
  return test::fatOn(test::lumpSurface({0.012, 0.010, 0.006}), test::fatSettings(0.00075), floorOnly);
}

/// A vertex of the surface near the top.
int topTriangle(const CarvedContact& contact, std::span<const Vec3> position) {
  double best = -1e300;
  int found = -1;
  for (const ContactSurface::Patch& patch : contact.surface().patches()) {
    for (std::size_t t = patch.first; t < patch.last; ++t) {
      const double z = position[slot(contact.surface().triangles()[t][0])][2];
      if (z > best) found = static_cast<int>(t);
      best = std::max(best, z);
    }
  }
  return found;
}

TEST(FatMotion, AtRestNothingMoves) {
  const auto model = lump();
  test::FatRig rig(*model);
  for (int i = 0; i < 50; ++i) rig.move(Vec3::Zero(), {});
  for (std::size_t n = 0; n < model->solid().nodes(); ++n) {
    EXPECT_LT((rig.state.solid.position[n] - model->solid().rest()[n]).norm(), 1e-13);
  }
}

TEST(FatMotion, HangsOnItsTiesUnderGravity) {
  const auto model = lump();
  test::FatRig rig(*model);
  const Vec3 gravity(3.0, 0.0, -9.0);
  for (int i = 0; i < 400; ++i) rig.move(gravity, {});
  Vec3 force;
  Vec3 moment;
  rig.tieForces(force, moment);
  const Vec3 weight = rig.mass() * gravity;
  EXPECT_LT((force + weight).norm(), 1e-5 * weight.norm());
  double sag = 0.0;
  for (std::size_t n = 0; n < model->solid().nodes(); ++n) {
    sag = std::max(sag, (rig.state.solid.position[n] - model->solid().rest()[n]).norm());
  }
  EXPECT_GT(sag, 1e-5);
  // A moved floor takes all of it along.
  for (int i = 0; i < 600; ++i) rig.move(Vec3::Zero(), {}, {0.002, -0.001, 0.003});
  for (std::size_t n = 0; n < model->solid().nodes(); ++n) {
    EXPECT_LT((rig.state.solid.position[n] - model->solid().rest()[n] - Vec3(0.002, -0.001, 0.003)).norm(), 2e-6);
  }
}

TEST(FatMotion, ForcesOnTheSurfaceKeepSumAndMoment) {
  const auto model = lump();
  test::FatRig rig(*model);
  Random random(4, 4);
  std::vector<Vec3> skin;
  const Vec3 press(2e-5, 1e-5, -5e-5);  // small: elements of small strain keep the moment to first order only
  Vec3 point = Vec3::Zero();
  rig.body.contact().positions(rig.state.solid.position, skin);
  const int triangle = topTriangle(rig.body.contact(), skin);
  const Index3 t = rig.body.contact().surface().triangles()[slot(triangle)];
  const Vec3 weight(0.2, 0.5, 0.3);
  for (int i = 0; i < 500; ++i) {
    std::vector<Vec3> force(model->solid().nodes(), Vec3::Zero());
    const SolidSolver::Impulse place = rig.body.contact().influence({t[0], t[1], t[2]}, weight);
    for (std::size_t k = 0; k < place.count; ++k) force[slot(place.node[k])] += place.weight[k] * press;
    rig.move(Vec3::Zero(), force);
  }
  rig.body.contact().positions(rig.state.solid.position, skin);
  for (int k = 0; k < 3; ++k) point += weight[k] * skin[slot(t[k])];
  Vec3 force;
  Vec3 moment;
  rig.tieForces(force, moment);
  EXPECT_LT((force + press).norm(), 2e-5 * press.norm());
  EXPECT_LT((moment + point.cross(press)).norm(), 2e-4 * point.cross(press).norm());
  // At every triangle, however bent the body, the nodes' mean place is the point.
  for (Vec3& p : rig.state.solid.position) {
    for (int a = 0; a < 3; ++a) p[a] += random.uniform(-5e-4, 5e-4);
  }
  rig.body.contact().positions(rig.state.solid.position, skin);
  std::size_t most = 0;
  for (const ContactSurface::Patch& patch : rig.body.contact().surface().patches()) {
    for (std::size_t i = patch.first; i < patch.last; ++i) {
      const Index3& c = rig.body.contact().surface().triangles()[i];
      const double u = random.uniform();
      const Vec3 w(u * (1.0 - 0.3), 0.3 * u, 1.0 - u);
      const SolidSolver::Impulse place = rig.body.contact().influence({c[0], c[1], c[2]}, w);
      ASSERT_LE(place.count, SolidSolver::Impulse::maxNodes);
      most = std::max(most, place.count);
      Vec3 mean = Vec3::Zero();
      double sum = 0.0;
      for (std::size_t k = 0; k < place.count; ++k) {
        mean += place.weight[k] * rig.state.solid.position[slot(place.node[k])];
        sum += place.weight[k];
      }
      EXPECT_NEAR(sum, 1.0, 1e-14);
      EXPECT_LT((mean - (w[0] * skin[slot(c[0])] + w[1] * skin[slot(c[1])] + w[2] * skin[slot(c[2])])).norm(), 1e-15);
    }
  }
  EXPECT_GT(most, 12U);
}

TEST(FatMotion, ComplianceOfRestKnowsTheTies) {
  const auto model = lump();
  test::FatRig rig(*model);
  const std::vector<Attachment> ties = model->restAttachments(rig.settings.step);
  RestCompliance rest(model->solid(), rig.settings, rig.executor, {ties, model->restFill()});
  RestCompliance free(model->solid(), rig.settings, rig.executor);
  std::vector<Vec3> skin;
  double largest = 0.0;
  double least = 1e300;
  double loosest = 0.0;
  const auto measure = [&](bool free_) {
    rig.body.contact().positions(rig.state.solid.position, skin);
    Random random(9, 9);
    for (const ContactSurface::Patch& patch : rig.body.contact().surface().patches()) {
      if (random.uniform() > 0.1) continue;
      const Index3& c = rig.body.contact().surface().triangles()[patch.first];
      SolidSolver::Impulse place = rig.body.contact().influence({c[0], c[1], c[2]}, Vec3::Constant(1.0 / 3.0));
      place.impulse = Vec3::UnitZ();
      std::vector<std::vector<Vec3>> response;
      rig.solver.responses(model->solid(), {&place, 1}, rig.settings, response);
      double exact = 0.0;
      for (std::size_t k = 0; k < place.count; ++k) exact += place.weight[k] * response[0][slot(place.node[k])][2];
      RestCompliance& used = free_ ? free : rest;
      used.precomputeCompliance({place.node.data(), place.count});
      Mat3 sum = Mat3::Zero();
      for (std::size_t a = 0; a < place.count; ++a) {
        for (std::size_t b = 0; b < place.count; ++b) {
          sum += place.weight[a] * place.weight[b] * rig.body.rotation(rig.state, place.node[a]) *
                 used.block(place.node[a], place.node[b]) * rig.body.rotation(rig.state, place.node[b]).transpose();
        }
      }
      largest = std::max(largest, sum(2, 2) / exact);
      least = std::min(least, sum(2, 2) / exact);
      loosest = std::max(loosest, exact);
    }
  };
  rig.move(Vec3::Zero(), {});
  measure(false);
  EXPECT_NEAR(largest, 1.0, 1e-3);
  EXPECT_NEAR(least, 1.0, 1e-3);
  std::cout << "with ties and fill: predicted over true compliance " << least << " to " << largest << "\n";
  largest = 0.0;
  least = 1e300;
  measure(true);
  std::cout << "without: " << least << " to " << largest << "\n";
  EXPECT_GT(std::max(largest, 1.0 / least), 1.5);
  // Carved: the prediction must not be much too stiff, or contact's passes overshoot.
  Random random(3, 3);
  for (int i = 0; i < 40; ++i) {
    const SweptCapsule tool[1] = {
        test::randomSweep(random, {{-0.009, -0.007, 0.0}, {0.009, 0.007, 0.006}}, 0.0015, 0.003, 0.002)};
    rig.move(Vec3::Zero(), {});
    rig.body.stroke(rig.state, tool);
  }
  rig.move(Vec3::Zero(), {});
  largest = 0.0;
  least = 1e300;
  measure(false);
  std::cout << "carved to " << 100.0 * rig.body.volume().total() / FatBody(*model).volume().total() << " %: " << least
            << " to " << largest << "\n";
  EXPECT_GT(least, 0.3);
}

}  // namespace
}  // namespace calot::fat_motion_test
