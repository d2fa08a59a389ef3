// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/film/overlay.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>
#include "tests/support/fault.h"

namespace calot::gui::overlay_test {
namespace {

constexpr int width = 320, height = 180;

Image grey() { return {width, height, std::vector<std::uint8_t>(4UL * width * height, 100)}; }

/// Number of pixels that are not grey any more within a rectangle.
int changed(const Image& image, int x0, int y0, int x1, int y1) {
  int count = 0;
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x) count += image.pixel(x, y)[0] != 100 || image.pixel(x, y)[2] != 100 ? 1 : 0;
  return count;
}

TEST(Lettering, WritesWhereItIsAsked) {
  const Lettering letters(16);
  const int wide = letters.widthOf("clipping");
  EXPECT_GT(wide, 4 * 8);
  EXPECT_EQ(letters.widthOf(""), 0);
  EXPECT_GT(letters.widthOf("clipping clipping"), 2 * wide);
  struct Case {
    Anchor anchor;
    int x, first, last;
  };
  for (const Case& c : {Case{Anchor::left, 100, 100, 100 + wide}, Case{Anchor::right, 200, 200 - wide, 200},
                        Case{Anchor::middle, 160, 160 - wide / 2, 160 + wide / 2 + 1}}) {
    Image image = grey();
    letters.write(image, "clipping", c.x, 50, c.anchor, {255, 255, 255});
    const int inside = changed(image, c.first - 2, 49, c.last + 2, 51 + letters.lineHeight());
    EXPECT_GT(inside, 150);
    EXPECT_EQ(inside, changed(image, 0, 0, width, height));
  }
}

TEST(Lettering, IsCutOffAtTheEdgesAndFadesAway) {
  const Lettering letters(16);
  Image image = grey();
  for (const auto& [x, y] : {std::pair(-20, -8), {width - 10, height - 5}, {-1000, 20}, {20, 5000}})
    letters.write(image, "synthetic", x, y, Anchor::left, {255, 255, 255});
  EXPECT_GT(changed(image, 0, 0, width, height), 0);
  Image untouched = grey();
  letters.write(untouched, "synthetic", 20, 20, Anchor::left, {255, 255, 255}, 0.0);
  EXPECT_EQ(changed(untouched, 0, 0, width, height), 0);
}

/// Two bytes make one character; a broken sequence is shown as something and ends nowhere else.
TEST(Lettering, ReadsUtf8) {
  const Lettering letters(16);
  EXPECT_LT(letters.widthOf("\xC3\xA4"), letters.widthOf("ae"));  // a with two dots
  for (const std::string broken : {"\xC3", "\x80", "a\xE2\x82", "\xFF\xFF"}) {
    Image image = grey();
    letters.write(image, broken, 20, 20, Anchor::left, {255, 255, 255});
    EXPECT_GT(letters.widthOf(broken), 0);
  }
}

TEST(Overlays, AreNamed) {
  const Overlays some = parseOverlays("time,tools");
  EXPECT_TRUE(some.time && some.tools);
  EXPECT_FALSE(some.phase || some.checkpoints || some.events);
  EXPECT_FALSE(parseOverlays("time").needTrack());
  EXPECT_TRUE(parseOverlays("events").needTrack());
  for (const char* wrong : {"", "clock", "time,", ",time", "time phase", "Time"}) {
    expectFault(ErrorKind::invalid, "", {"time, phase"}, [&] { (void)parseOverlays(wrong); });
  }
}

/// A point of the path falls where the renderer's pinhole puts it.
TEST(Overlays, PathsLieWhereTheCameraSeesThem) {
  SceneView view;
  view.verticalFieldOfView = 0.9;
  view.camera.position = Vec3(0.1, -0.2, 0.05);
  view.camera.orientation = Quat(Eigen::AngleAxisd(0.4, Vec3(0.2, 1.0, -0.3).normalized()));
  const Vec3 p_C(0.012, -0.006, 0.1);
  Moment moment;
  moment.path[0] = {{view.camera.position + view.camera.orientation * p_C, 0.0}};
  moment.path[1] = {{view.camera.position - view.camera.orientation * p_C, 0.0}};  // behind the lens
  Overlays overlays;
  overlays.tools = true;
  Image image = grey();
  OverlayPainter(height).paint(image, overlays, moment, view);
  const double f = 0.5 * height / std::tan(0.45);
  const int x = static_cast<int>(0.5 * width + f * 0.12), y = static_cast<int>(0.5 * height - f * 0.06);
  EXPECT_GT(changed(image, x - 2, y - 2, x + 3, y + 3), 1);
  EXPECT_EQ(changed(image, x - 2, y - 2, x + 3, y + 3), changed(image, 0, 0, width, height));
}

TEST(Overlays, StandInTheirCorners) {
  Moment moment;
  moment.time = 83.456;
  moment.phase = "clipping";
  moment.checkpoints = {"path-length left  152 mm"};
  moment.events = {{"clip on cystic-duct", false, 82.456}, {"long ago", false, moment.time - Moment::eventSeconds}};
  struct Case {
    const char* overlay;
    bool right, below;
  };
  for (const Case& c :
       {Case{"time", false, false}, {"phase", false, false}, {"checkpoints", true, false}, {"events", false, true}}) {
    Image image = grey();
    OverlayPainter(height).paint(image, parseOverlays(c.overlay), moment, SceneView{});
    const int x = c.right ? width / 2 : 0, y = c.below ? height / 2 : 0;
    const int there = changed(image, x, y, x + width / 2, y + height / 2);
    EXPECT_GT(there, 20) << c.overlay;
    EXPECT_EQ(there, changed(image, 0, 0, width, height)) << c.overlay;
  }
}

/// In half a picture, words must not lie over one another.
TEST(Overlays, MakeRoomForCaptions) {
  const OverlayPainter painter(height);
  const auto painted = [&](const char* overlay, const Moment& moment, const Captions& captions) {
    Image image = grey();
    painter.paint(image, parseOverlays(overlay), moment, SceneView{}, captions);
    return image;
  };
  Moment moment;
  moment.checkpoints = {"path-length right  1390 mm"};
  moment.events = {{"clip on cystic-duct", false, -1.0}};
  const int line = Lettering(height / 36).lineHeight(), margin = height / 45;

  const Image titled =
      painted("time", moment, {"a participant with a name that goes on and on and on, and on again", ""});
  EXPECT_GT(changed(titled, width / 2 - 40, 0, width / 2 + 40, margin + line), 40);
  EXPECT_EQ(changed(titled, 0, 0, width, height), changed(titled, 0, 0, width, margin + line + 1));
  const Image timeAlone = painted("time", moment, {});
  const int timeEnds = margin + Lettering(height / 36).widthOf("0:00.0") + 1;
  EXPECT_EQ(changed(titled, 0, 0, timeEnds, height), changed(timeAlone, 0, 0, timeEnds, height));
  EXPECT_GT(changed(painted("checkpoints", moment, {}), width / 2, 0, width, margin + line - 2), 0);
  const Image below = painted("checkpoints", moment, {"s1", ""});
  EXPECT_EQ(changed(below, width / 2 + 20, 0, width, margin + line - 1), 0);
  EXPECT_GT(changed(below, width / 2 + 20, margin + line, width, height), 20);

  const Image apart = painted("events", moment, {"", "synthetic: performer unskilled, and more of it"});
  EXPECT_LT(changed(apart, 0, height - margin - line, width / 4, height), 10);  // no more than an outline
  EXPECT_GT(changed(apart, 0, height - margin - 2 * line, width / 4, height - margin - line), 20);
}

}  // namespace
}  // namespace calot::gui::overlay_test
