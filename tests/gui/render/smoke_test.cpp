// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/render/translucent.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "gui/render/renderer.h"
#include "tests/support/fault.h"

namespace calot::gui::smoke_test {
namespace {

constexpr int width = 200, height = 150;

Event burn(std::uint64_t step, double joule) {
  Event event;
  event.step = step;
  event.kind = EventKind::smoke;
  event.position = Vec3(0.001, 0.002, 0.08);
  event.value = joule;
  return event;
}

TEST(Smoke, LastsAsLongAsItSays) {
  SmokeTrail trail;
  Event clip;
  clip.kind = EventKind::clipSet;
  trail.add(1.0, std::vector<Event>{burn(99, 15.0), clip, burn(99, 1.0)});
  trail.add(2.0, std::vector<Event>{burn(199, 0.3)});
  const std::vector<Puff> puffs = trail.at(2.0);
  ASSERT_EQ(puffs.size(), 3U) << "other events make no smoke";
  EXPECT_DOUBLE_EQ(puffs[0].age, 1.0);
  EXPECT_DOUBLE_EQ(puffs[0].strength, 1.0);
  EXPECT_DOUBLE_EQ(puffs[1].strength, 0.5) << "as the root of the energy";
  EXPECT_NE(puffs[0].number, puffs[1].number);
  EXPECT_EQ(trail.at(1.0 + smokeSeconds).size(), 1U);
  EXPECT_TRUE(trail.at(2.0 + smokeSeconds).empty());
}

/// Puffs rise, spread, and thin out.
TEST(Smoke, DriftsAndThinsOut) {
  const CameraSample camera;  // at the origin, along z
  const Vec3 down = -Vec3::UnitZ();
  Puff puff{Vec3(0.0, 0.0, 0.1), 0.1, 1.0, 7};
  double lastRadius = 0.0, lastDepth = 0.0, lastOpacity = 1.0;
  for (const double age : {0.1, 0.5, 1.0, 1.5, 2.0, 2.4}) {
    puff.age = age;
    const SmokeList list = makeSmokeList(camera, down, std::vector<Puff>{puff});
    ASSERT_EQ(list.vertex.size(), 4U);
    const double radius = 0.5 * static_cast<double>(list.vertex[1].position[0] - list.vertex[0].position[0]);
    const auto depth = static_cast<double>(list.vertex[0].position[2]);
    EXPECT_GT(radius, lastRadius);
    EXPECT_GT(depth, lastDepth) << "up in W is ahead for this camera";
    EXPECT_LT(static_cast<double>(list.vertex[0].opacity), lastOpacity);
    lastRadius = radius;
    lastDepth = depth;
    lastOpacity = static_cast<double>(list.vertex[0].opacity);
  }
  puff.age = smokeSeconds;
  EXPECT_TRUE(makeSmokeList(camera, down, std::vector<Puff>{puff}).vertex.empty());
}

TEST(Smoke, RisesAgainstGravity) {
  const CameraSample camera;
  const Vec3 down = Vec3(0.0, -0.94, -0.34).normalized();
  const auto middle = [&](double age) {
    Vec3 sum = Vec3::Zero();
    const SmokeList list = makeSmokeList(camera, down, std::vector<Puff>{{Vec3(0.0, 0.0, 0.1), age, 1.0, 7}});
    for (const SmokeVertex& v : list.vertex)
      sum += Vec3(static_cast<double>(v.position[0]), static_cast<double>(v.position[1]),
                  static_cast<double>(v.position[2]));
    return Vec3(0.25 * sum);
  };
  EXPECT_NEAR((middle(2.0) - middle(0.1)).dot(-down), 0.030 * (std::exp(-0.1 / 0.8) - std::exp(-2.0 / 0.8)), 1e-4);
}

TEST(Smoke, VeilsWhatLiesBehindAndNothingElse) {
  SceneView view;
  view.down = -Vec3::UnitZ();  // it rises away from the camera
  view.verticalFieldOfView = 0.6;
  SurfaceView plate;
  plate.organ = plate.appearance = "liver";
  for (const double x : {-0.1, 0.1})
    for (const double y : {-0.1, 0.1}) plate.position.emplace_back(x, y, 0.12 + 0.3 * x);
  plate.triangle = {{0, 1, 2}, {1, 3, 2}};
  plate.rest = plate.position;
  view.surface = {plate};
  const std::vector<Puff> before{{Vec3(0.0, 0.0, 0.06), 0.3, 1.0, 3}}, behind{{Vec3(0.0, 0.0, 0.2), 0.3, 1.0, 3}};
  Renderer renderer;
  for (const Quality quality : {Quality::interactive, Quality::film}) {
    RenderSettings settings;
    settings.quality = quality;
    const Image clear = renderer.render(view, width, height, settings);
    const Image veiled = renderer.render(view, width, height, settings, before);
    EXPECT_EQ(renderer.render(view, width, height, settings, behind).rgba, clear.rgba);
    EXPECT_EQ(renderer.render(view, width, height, settings).rgba, clear.rgba) << "leaves no trace";
    EXPECT_EQ(renderer.render(view, width, height, settings, before).rgba, veiled.rgba);
    const std::uint8_t* const a = clear.pixel(width / 2, height / 2);
    const std::uint8_t* const b = veiled.pixel(width / 2, height / 2);
    EXPECT_GT(b[2], a[2] + 8) << "whitish over red";
    int changed = 0;
    for (int i = 0; i < width * height; ++i) {
      const int x = i % width, y = i / width;
      if (clear.pixel(x, y)[2] == veiled.pixel(x, y)[2]) continue;
      ++changed;
      EXPECT_LT(std::hypot(x - width / 2, y - height / 2), 0.4 * height);
    }
    EXPECT_GT(changed, 200);
  }
}

TEST(Smoke, RefusesWhatIsNoPuff) {
  Renderer renderer;
  SceneView view;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Puff& puff :
       {Puff{Vec3(nan, 0.0, 0.0), 0.1, 0.5, 1}, Puff{Vec3::Zero(), nan, 0.5, 1}, Puff{Vec3::Zero(), 0.1, 1.5, 1}}) {
    expectFault(ErrorKind::damaged, "", {"puff 0"},
                [&] { (void)renderer.render(view, 32, 32, {}, std::vector<Puff>{puff}); });
  }
}

}  // namespace
}  // namespace calot::gui::smoke_test
