// SPDX-License-Identifier: GPL-3.0-or-later
// The ways to an OpenGL: a graphics card's, tried with the software device that takes it too, and OSMesa's.
#include "gui/render/graphics.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>
#include <vector>

#include "gui/render/renderer.h"
#include "recorder/base/errors.h"
#include "tests/gui/render/support/shapes.h"
#include "tests/support/fault.h"

namespace calot::gui {
namespace {

SceneView organInSight() {
  SceneView view;
  view.verticalFieldOfView = 0.9;
  view.surface.push_back(test::sphere(Vec3(0.0, 0.0, 0.12), 0.05, 48, "liver"));
  view.surface.push_back(test::sphere(Vec3(0.02, 0.01, 0.075), 0.015, 48, "gallbladder"));
  return view;
}

bool isHere(Graphics graphics) {
  try {
    return createContext(graphics) != nullptr;
  } catch (const Error&) {
    return false;
  }
}

TEST(Graphics, HasAWordForEachChoice) {
  const std::vector<std::string>& words = graphicsWords();
  ASSERT_EQ(words.size(), 4U);
  EXPECT_EQ(graphicsFrom("auto"), Graphics::automatic);
  EXPECT_EQ(graphicsFrom("card"), Graphics::card);
  EXPECT_EQ(graphicsFrom("software"), Graphics::software);
  EXPECT_EQ(graphicsFrom("egl-software"), Graphics::deviceSoftware);
  EXPECT_THROW(static_cast<void>(graphicsFrom("opengl")), Error);
}

TEST(Graphics, TheWayToACardDrawsWhatSoftwareDraws) {
  if (!isHere(Graphics::deviceSoftware)) GTEST_SKIP() << "EGL offers no software device here";
  Renderer software(Graphics::software), device(Graphics::deviceSoftware);
  EXPECT_EQ(software.graphics().substr(0, 8), "OSMesa, ");
  EXPECT_EQ(device.graphics().substr(0, 5), "EGL, ");
  const SceneView view = organInSight();
  for (const Quality quality : {Quality::interactive, Quality::film}) {
    const Image a = software.render(view, 320, 240, quality), b = device.render(view, 320, 240, quality);
    ASSERT_EQ(a.rgba.size(), b.rgba.size());
    std::size_t far = 0;
    for (std::size_t i = 0; i < a.rgba.size(); ++i) far += std::abs(int(a.rgba[i]) - int(b.rgba[i])) > 2 ? 1 : 0;
    EXPECT_LT(far, a.rgba.size() / 1000) << "of " << a.rgba.size();
    EXPECT_EQ(device.render(view, 320, 240, quality).rgba, b.rgba) << "again";
  }
}

TEST(Graphics, WithoutACardAutomaticIsSoftwareAndACardThatIsWantedIsAnError) {
  if (isHere(Graphics::card)) GTEST_SKIP() << "this machine has a graphics card";
  EXPECT_EQ(Renderer(Graphics::automatic).graphics().substr(0, 8), "OSMesa, ");
  expectFault(ErrorKind::failure, "", {"card"}, [] { const Renderer card(Graphics::card); });
}

TEST(Graphics, AutomaticIsTheCardWhereThereIsOne) {
  if (!isHere(Graphics::card)) GTEST_SKIP() << "this machine has no graphics card";
  Renderer renderer(Graphics::automatic);
  EXPECT_EQ(renderer.graphics().substr(0, 5), "EGL, ");
  EXPECT_FALSE(renderer.render(organInSight(), 320, 240, Quality::interactive).rgba.empty());
}

}  // namespace
}  // namespace calot::gui
