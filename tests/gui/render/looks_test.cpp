// SPDX-License-Identifier: GPL-3.0-or-later
// Looks that come for the first time: noted, made beforehand without a trace in the picture, and by two contexts at
// once.
#include "gui/render/scene_resources.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <thread>
#include <vector>

#include "gui/render/renderer.h"
#include "tests/gui/render/support/shapes.h"

namespace calot::gui {
namespace {

constexpr int lookWidth = 160, lookHeight = 120;

/// @param charred of every vertex
SceneView charredOrgans(float charred) {
  SceneView view;
  view.verticalFieldOfView = 0.9;
  view.surface.push_back(test::sphere(Vec3(0.0, 0.0, 0.12), 0.05, 32, "liver"));
  view.surface.push_back(test::sphere(Vec3(0.02, 0.01, 0.075), 0.015, 32, "gallbladder"));
  view.surface.push_back(test::sphere(Vec3(-0.02, 0.01, 0.075), 0.01, 32, "artery"));
  for (SurfaceView& surface : view.surface) surface.charred.assign(surface.position.size(), charred);
  return view;
}

RenderSettings interactiveSettings(bool ready) {
  RenderSettings settings;
  settings.quality = Quality::interactive;
  settings.ready = ready;
  return settings;
}

DrawList listOf(std::initializer_list<std::pair<Appearance, bool>> looks) {
  DrawList list;
  for (const auto& [appearance, harmed] : looks) {
    DrawPart& part = list.part.emplace_back();
    part.appearance = appearance;
    part.harmed = harmed;
    part.indexCount = 30;
  }
  return list;
}

TEST(Looks, OneIsNewOnce) {
  LooksDrawn drawn;
  const DrawList whole = listOf({{Appearance::liver, false}, {Appearance::steel, false}});
  const DrawList charred = listOf({{Appearance::liver, false}, {Appearance::liver, true}});
  RenderSettings settings = interactiveSettings(false);
  EXPECT_TRUE(noteLooks(drawn, whole, settings));
  EXPECT_FALSE(noteLooks(drawn, whole, settings));
  EXPECT_TRUE(noteLooks(drawn, charred, settings));
  EXPECT_FALSE(noteLooks(drawn, charred, settings));
  DrawList smoky = whole;
  smoky.smoke.index = {0, 1, 2};
  EXPECT_TRUE(noteLooks(drawn, smoky, settings));
  EXPECT_FALSE(noteLooks(drawn, smoky, settings));
  settings.quality = Quality::film;
  EXPECT_TRUE(noteLooks(drawn, whole, settings)) << "programs of another quality";
}

TEST(Looks, ToComeAreCharClipsAndBloodButNoneThatIsThere) {
  const auto has = [](const std::vector<DrawPart>& parts, Appearance appearance, bool harmed) {
    return std::count_if(parts.begin(), parts.end(),
                         [&](const DrawPart& part) { return part.appearance == appearance && part.harmed == harmed; });
  };
  const auto liver = looksToCome(listOf({{Appearance::cavity, false}, {Appearance::liver, false}}));
  EXPECT_EQ(has(liver, Appearance::liver, true), 1);
  EXPECT_EQ(has(liver, Appearance::liver, false), 0);
  EXPECT_EQ(has(liver, Appearance::cavity, true), 0);
  EXPECT_EQ(has(liver, Appearance::steel, false), 1);
  EXPECT_EQ(has(liver, Appearance::titanium, false), 0) << "no vessel, no clip";
  const auto vessel = looksToCome(listOf({{Appearance::artery, false}, {Appearance::steel, false}}));
  EXPECT_EQ(has(vessel, Appearance::titanium, false), 1);
  EXPECT_EQ(has(vessel, Appearance::blood, false), 1);
  EXPECT_EQ(has(vessel, Appearance::bowel, false), 1) << "an endoscope that moves may see it later";
  EXPECT_EQ(has(vessel, Appearance::steel, false), 0);
  for (const DrawPart& part : vessel) EXPECT_EQ(part.indexCount, 3U);
}

TEST(Looks, MadeBeforehandLeaveNoTraceInThePicture) {
  Renderer plain, ready;
  for (const float charred : {0.0F, 0.5F}) {
    const SceneView view = charredOrgans(charred);
    const Image a = plain.render(view, lookWidth, lookHeight, interactiveSettings(false));
    const Image b = ready.render(view, lookWidth, lookHeight, interactiveSettings(true));
    EXPECT_EQ(a.rgba, b.rgba) << charred;
  }
}

TEST(Looks, NewOnesInTwoContextsAtOnce) {
  const SceneView whole = charredOrgans(0.0F), charred = charredOrgans(0.5F);
  std::vector<Image> image(4);
  for (int round = 0; round < 3; ++round) {
    std::vector<std::thread> threads;
    for (std::size_t t = 0; t < 2; ++t) {
      threads.emplace_back([&, t] {
        Renderer renderer;
        image[2 * t] = renderer.render(whole, lookWidth, lookHeight, interactiveSettings(false));
        image[2 * t + 1] = renderer.render(charred, lookWidth, lookHeight, interactiveSettings(false));
      });
    }
    for (std::thread& thread : threads) thread.join();
    EXPECT_EQ(image[0].rgba, image[2].rgba);
    EXPECT_EQ(image[1].rgba, image[3].rgba);
    EXPECT_NE(image[0].rgba, image[1].rgba);
  }
}

}  // namespace
}  // namespace calot::gui
