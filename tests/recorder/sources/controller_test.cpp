// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/source.h"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

#include "recorder/base/errors.h"
#include "recorder/sources/pointing.h"

namespace calot::recorder {
namespace {

SceneDescription twoPorts() {
  SceneDescription scene;
  scene.hands[0].port = Vec3(0.05, 0.1, 0.0);
  scene.hands[1].port = Vec3(-0.05, 0.1, 0.0);
  scene.hands[0].home = Vec3(0.02, 0.03, 0.0);
  scene.hands[1].home = Vec3(-0.02, 0.03, 0.0);
  return scene;
}

TEST(ControllerSamples, goEvenlyFromCommandToCommand) {
  const SceneDescription scene = twoPorts();
  ControllerSamples controller(scene);
  HandCommands wanted = controller.hands();
  wanted[1].tip += Vec3(0.0, -0.01, 0.0);
  wanted[1].jaw = 0.5;
  wanted[1].buttons = button::lock;
  wanted[1].instrument = InstrumentKind::hook;
  std::vector<TickSamples> ticks(10);
  controller.next(wanted, ticks);
  for (std::size_t i = 0; i < ticks.size(); ++i) {
    const double share = static_cast<double>(i + 1) / 10.0;
    const InstrumentSample& right = ticks[i].hand[1];
    EXPECT_NEAR(right.position.y(), 0.03 - 0.01 * share, 1e-6);
    EXPECT_NEAR(right.jaw, 0.5 * share, 1e-4);
    EXPECT_EQ(right.buttons, button::lock);
    EXPECT_EQ(right.instrument, InstrumentKind::hook);
    EXPECT_TRUE(right.valid);
    const Quat along = pointing(scene.hands[1].port, right.position);
    EXPECT_LT((right.orientation.coeffs() - along.coeffs()).cwiseAbs().maxCoeff(), 1e-4);
    EXPECT_LT((ticks[i].hand[0].position - scene.hands[0].home).norm(), 1e-6);
  }
  controller.next(wanted, ticks);
  EXPECT_EQ(ticks.front().hand[1].position, ticks.back().hand[1].position);
}

TEST(ControllerSamples, refuseWhatIsNoCommandAndStayAsTheyWere) {
  ControllerSamples controller(twoPorts());
  std::vector<TickSamples> ticks(10);
  const HandCommands before = controller.hands();
  const auto refused = [&](auto&& change) {
    HandCommands wrong = before;
    change(wrong[0]);
    EXPECT_THROW(controller.next(wrong, ticks), Error);
    EXPECT_EQ(controller.hands()[0].tip, before[0].tip);
    EXPECT_EQ(controller.hands()[0].jaw, before[0].jaw);
  };
  refused([](HandCommand& c) { c.tip.x() = std::numeric_limits<double>::quiet_NaN(); });
  refused([](HandCommand& c) { c.roll = std::numeric_limits<double>::infinity(); });
  refused([](HandCommand& c) { c.jaw = std::numeric_limits<double>::quiet_NaN(); });
  refused([](HandCommand& c) { c.instrument = static_cast<InstrumentKind>(77); });
}

TEST(ControllerProvenance, isMarked) {
  const Provenance provenance = controllerProvenance("reach", "3");
  EXPECT_EQ(provenance.kind, OperatorKind::performer);
  EXPECT_EQ(provenance.profile, "controller:reach");
  EXPECT_EQ(provenance.profileVersion, "3");
  EXPECT_TRUE(provenance.device.empty());
  EXPECT_THROW(controllerProvenance("", "1"), Error);
  EXPECT_THROW(controllerProvenance("a\tb", "1"), Error);
  EXPECT_THROW(controllerProvenance("reach", std::string(65, 'v')), Error);
}

}  // namespace
}  // namespace calot::recorder
