// SPDX-License-Identifier: GPL-3.0-or-later
// Figures of contact, holding and heat, by structure, from steps made by hand.
#include <gtest/gtest.h>

#include "tests/analytics/checkpoints/support/operation.h"
#include "tests/support/message.h"

namespace calot::analytics {
namespace {

using namespace support;

/// Who grips a vessel to be spared, without pressing on it, touches it: contact time by structure, of cystic and of
/// spared vessels, and the force on it count the grasp.
TEST(Holding, IsContact) {
  SceneDescription scene = operationScene();
  scene.procedure.spare = {"v1"};
  Operation o(scene);
  for (HandResult& hand : o.now.hand) hand.structureForce.assign(7, 0.0);
  o.steps(10);
  o.now.hand[0].grasping = 1U << bileDuct;
  o.now.hand[0].graspForce = 1.5;
  o.now.hand[0].gripForce = 4.0;
  o.steps(50);
  o.now.hand[0].grasping = 1U << cysticDuct;
  o.now.hand[0].graspForce = 0.5;
  o.now.hand[1].touching = 1U << cysticDuct;
  o.now.hand[1].structureForce[cysticDuct] = 0.25;
  o.steps(20);
  o.end();
  EXPECT_NEAR(*o.value("contact-time-union", "v1").value, 0.5, 1e-12);
  EXPECT_NEAR(*o.value("contact-time-union", "v2").value, 0.2, 1e-12);
  EXPECT_NEAR(*o.value("contact-time-sum", "v2").value, 0.4, 1e-12);
  EXPECT_NEAR(*o.value("spared-contact-time-union").value, 0.5, 1e-12);
  EXPECT_NEAR(*o.value("spared-contact-time-sum").value, 0.5, 1e-12);
  EXPECT_NEAR(*o.value("cystic-contact-time").value, 0.4, 1e-12);
  EXPECT_NEAR(*o.value("time-held", "v1").value, 0.5, 1e-12);
  EXPECT_NEAR(*o.value("time-held", "v2").value, 0.2, 1e-12);
  EXPECT_EQ(*o.value("time-held", "organ-a").value, 0.0);
  EXPECT_NEAR(*o.value("crush-dose", "v1").value, 4.0 * 0.5, 1e-12);
  EXPECT_NEAR(*o.value("crush-dose", "v2").value, 4.0 * 0.2, 1e-12);
  EXPECT_NEAR(*o.value("structure-force-p99", "v1").value, 1.5, 1e-12);
  EXPECT_NEAR(*o.value("structure-force-p99", "v2").value, 0.75, 1e-12) << "both hands";
  EXPECT_NEAR(*o.value("structure-force-impulse", "v1").value, 1.5 * 0.5, 1e-12);
  EXPECT_NEAR(*o.value("structure-force-impulse", "v2").value, 0.75 * 0.2, 1e-12);
}

/// Results of earlier versions know what was held, and not how hard.
TEST(Holding, IsContactInEarlierRecordings) {
  recorder::AttemptHeader header = operationHeader();
  header.stepResultVersion = 4;
  Operation o(operationScene(), header, Origin::observables);
  o.now.hand[1].grasping = 1U << cysticDuct;
  o.steps(30);
  o.end();
  EXPECT_NEAR(*o.value("contact-time-union", "v2").value, 0.3, 1e-12);
  EXPECT_NEAR(*o.value("time-held", "v2").value, 0.3, 1e-12);
  expectNotApplicable(o.value("crush-dose", "v2"), {"version 4"});
  expectNotApplicable(o.value("thermal-injury"), {"vessel"});
}

TEST(ThermalInjury, OfWhatIsToBeSpared) {
  SceneDescription scene = operationScene();
  scene.procedure.spare = {"v1", "v3"};
  Operation o(scene);
  o.steps(5);
  EXPECT_EQ(*o.value("thermal-injury").value, 0.0);
  o.now.vessel[0].injured = 0.0015;
  o.now.vessel[1].injured = 0.004;  // the cystic duct is to be divided anyway
  o.now.vessel[2].injured = 0.0005;
  o.steps(5);
  o.end();
  const CheckpointValue v = o.value("thermal-injury");
  EXPECT_NEAR(*v.value, 0.002, 1e-15);
  EXPECT_EQ(v.note, "v1 1.50 mm, v2 4.00 mm, v3 0.50 mm");
}

}  // namespace
}  // namespace calot::analytics
