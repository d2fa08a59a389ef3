// SPDX-License-Identifier: GPL-3.0-or-later
// What the whole operation adds to pictures: looks of ducts, arteries and fat, clips, char, faces of cuts.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <string>

#include "gui/render/renderer.h"
#include "recorder/base/errors.h"
#include "tests/gui/render/support/shapes.h"
#include "tests/support/fault.h"

namespace calot::gui::operation_test {
namespace {

constexpr int width = 240, height = 180;
constexpr RenderSettings bare{Quality::film, false, false};  // alpha tells what is covered

Renderer& renderer() {
  static Renderer shared;
  return shared;
}

/// Tilted, so that the light is not mirrored into the lens.
double tilted(double x) { return 0.08 + 0.8 * x; }

/// A square 80 mm away, larger than the picture, `n` squares a side.
SceneView plate(const std::string& appearance, int n = 24) {
  SceneView view;
  view.verticalFieldOfView = 0.6;
  view.surface.push_back(
      test::sheetOver(appearance, n, [](double u, double v) { return Vec3(0.16 * u, 0.12 * v, tilted(0.16 * u)); }));
  return view;
}

using Colour = std::array<double, 3>;

Colour mean(const Image& image, int x0, int y0, int x1, int y1) {
  Colour sum{};
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x)
      for (std::size_t c = 0; c < 3; ++c) sum[c] += image.pixel(x, y)[c];
  for (double& s : sum) s /= static_cast<double>((x1 - x0) * (y1 - y0));
  return sum;
}
Colour look(const SceneView& view) { return mean(renderer().render(view, width, height, bare), 40, 30, 200, 150); }
double brightness(const Colour& c) { return 0.3 * c[0] + 0.6 * c[1] + 0.1 * c[2]; }

SceneView charred(const std::string& appearance, float value) {
  SceneView view = plate(appearance);
  view.surface[0].charred.assign(view.surface[0].position.size(), value);
  return view;
}

TEST(Operation, LooksHaveTheColoursOfTheirTissue) {
  const Colour duct = look(plate("duct")), artery = look(plate("artery")), fat = look(plate("fat"));
  EXPECT_GT(duct[1], 0.85 * duct[0]) << "yellow-green";
  EXPECT_LT(duct[2], 0.85 * duct[1]);
  EXPECT_GT(artery[0], 2.0 * artery[1]) << "red";
  EXPECT_GT(artery[0], 2.0 * artery[2]);
  EXPECT_GT(fat[1], 0.6 * fat[0]) << "yellow";
  EXPECT_LT(fat[1], 0.95 * fat[0]);
  EXPECT_LT(fat[2], 0.6 * fat[0]);
  EXPECT_GT(brightness(fat), brightness(look(plate("liver"))));
}

TEST(Operation, CharDarkensEveryTissue) {
  for (const char* tissue : {"liver", "gallbladder", "duct", "artery", "fat", "anything"}) {
    const double clean = brightness(look(plate(tissue)));
    const double brown = brightness(look(charred(tissue, 0.6F))), black = brightness(look(charred(tissue, 1.3F)));
    EXPECT_LT(black, 0.75 * brown) << tissue;
    EXPECT_LT(black, 0.55 * clean) << tissue;
    EXPECT_NEAR(brightness(look(charred(tissue, 0.0F))), clean, 0.1) << tissue << ": none at all changes nothing";
  }
}

/// Two triangles, charred along one side: the limit would be a straight line but for the noise.
TEST(Operation, CharHasAnIrregularEdge) {
  SceneView view = plate("fat", 1);
  view.surface[0].charred = {1.6F, 0.0F, 1.6F, 0.0F};  // left dark, right not
  const Image image = renderer().render(view, width, height, bare);
  double sum = 0.0, squares = 0.0;
  for (int y = 0; y < height; ++y) {
    int dark = 0;
    for (int x = 0; x < width; ++x) dark += image.pixel(x, y)[1] < 60 ? 1 : 0;
    sum += dark;
    squares += static_cast<double>(dark) * dark;
  }
  const double average = sum / height;
  EXPECT_GT(average, 0.1 * width);
  EXPECT_LT(average, 0.9 * width);
  EXPECT_GT(std::sqrt(squares / height - average * average), 3.0) << "pixels";
}

/// Seen along the vessel: two legs, open between them and at their tips, closed at the crotch.
TEST(Operation, ClipsAreWhereTheyShouldBe) {
  SceneView view;
  view.verticalFieldOfView = 0.4;
  ClipView clip;
  clip.pose.position = Vec3(0.002, -0.001, 0.05);
  clip.width = 0.0012;
  clip.legs = 0.0085;
  clip.halfGap = 0.0015;
  view.clip = {clip};
  const Image image = renderer().render(view, width, height, bare);
  const double f = 0.5 * height / std::tan(0.2);
  const auto covered = [&](double x, double y) {  // in the clip's frame
    const Vec3 p = clip.pose.position + Vec3(x, y, 0.0);
    return image.pixel(static_cast<int>(0.5 * width + f * p.x() / p.z()),
                       static_cast<int>(0.5 * height + f * p.y() / p.z()))[3] > 127;
  };
  const double leg = 0.75 * clip.halfGap + 0.25 * clip.width;
  for (const double y : {0.0, 0.002, 0.004}) {
    EXPECT_TRUE(covered(leg, y)) << y;
    EXPECT_TRUE(covered(-leg, y)) << y;
    EXPECT_FALSE(covered(0.0, y)) << y;
    EXPECT_FALSE(covered(2.2 * leg, y)) << y;
  }
  EXPECT_TRUE(covered(0.0, -0.5 * clip.legs)) << "crotch";
  EXPECT_FALSE(covered(leg, 0.6 * clip.legs)) << "beyond the tips";
  const std::uint8_t* const metal = image.pixel(static_cast<int>(0.5 * width + f * (0.002 + leg) / 0.05),
                                                static_cast<int>(0.5 * height - f * 0.001 / 0.05));
  EXPECT_LT(std::abs(metal[0] - metal[2]), 40) << "grey";
}

TEST(Operation, TheFaceOfACutIsRedWallAroundADarkLumen) {
  SceneView view;
  view.verticalFieldOfView = 0.1;
  SurfaceView face;
  face.organ = face.appearance = "duct";
  constexpr int sides = 32;
  face.position.emplace_back(0.0, 0.0, 0.08);
  face.face.push_back(1.99F);  // where it is 2, a drop hangs before it
  for (int k = 0; k < sides; ++k) {
    const double angle = 2.0 * 3.14159265358979 * k / sides;
    face.position.emplace_back(0.003 * std::cos(angle), 0.003 * std::sin(angle), tilted(0.003 * std::cos(angle)));
    face.face.push_back(1.0F);
    face.triangle.emplace_back(0, 1 + (k + 1) % sides, 1 + k);
  }
  face.rest = face.position;
  view.surface = {face};
  const Image image = renderer().render(view, width, height, bare);
  const Colour lumen = mean(image, width / 2 - 4, height / 2 - 4, width / 2 + 4, height / 2 + 4);
  const int rim = static_cast<int>(0.0026 / 0.08 * 0.5 * height / std::tan(0.05));
  const Colour wall = mean(image, width / 2 - 3, height / 2 + rim - 3, width / 2 + 3, height / 2 + rim + 3);
  EXPECT_LT(brightness(lumen), 0.6 * brightness(wall));
  EXPECT_GT(wall[0], 1.2 * wall[1]);
}

TEST(Operation, SameViewGivesSameBytes) {
  SceneView view = charred("fat", 0.7F);
  ClipView clip;
  clip.pose.position = Vec3(0.0, 0.0, 0.06);
  clip.width = 0.0012;
  clip.legs = 0.0085;
  clip.halfGap = 0.001;
  view.clip = {clip};
  for (const Quality quality : {Quality::interactive, Quality::film}) {
    const Image first = renderer().render(view, width, height, quality);
    (void)renderer().render(plate("artery"), width, height, quality);
    EXPECT_EQ(first.rgba, renderer().render(view, width, height, quality).rgba);
    Renderer other;
    EXPECT_EQ(first.rgba, other.render(view, width, height, quality).rgba);
  }
}

TEST(Operation, RefusesWhatCannotBeDrawn) {
  const auto refusal = [](const std::function<void(SceneView&)>& change) {
    SceneView view = charred("duct", 0.2F);
    view.surface[0].face.assign(view.surface[0].position.size(), 0.0F);
    ClipView clip;
    clip.width = 0.0012;
    clip.legs = 0.0085;
    view.clip = {clip};
    change(view);
    return caught([&] { (void)renderer().render(view, 32, 32, Quality::interactive); });
  };
  EXPECT_FALSE(refusal([](SceneView&) {}));
  expectFault(ErrorKind::damaged, "", {"'duct'"}, refusal([](SceneView& v) { v.surface[0].charred.pop_back(); }));
  expectFault(ErrorKind::damaged, "", {"vertex 3"}, refusal([](SceneView& v) { v.surface[0].charred[3] = -1.0F; }));
  expectFault(ErrorKind::damaged, "", {"vertex 5"}, refusal([](SceneView& v) { v.surface[0].face[5] = 2.5F; }));
  expectFault(ErrorKind::damaged, "", {"clip 0"}, refusal([](SceneView& v) { v.clip[0].width = 0.0; }));
  expectFault(ErrorKind::damaged, "", {"clip 0"},
              refusal([](SceneView& v) { v.clip[0].halfGap = std::numeric_limits<double>::quiet_NaN(); }));
}

}  // namespace
}  // namespace calot::gui::operation_test
