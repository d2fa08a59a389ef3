// SPDX-License-Identifier: GPL-3.0-or-later
// Edges of interactive pictures: shadows without steps, outlines without dashes, silhouettes without stairs.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "gui/render/edge_smoother.h"
#include "gui/render/renderer.h"
#include "tests/gui/render/support/shapes.h"

namespace calot::gui::edges_test {
namespace {

constexpr int width = 1024, height = 768;
constexpr int firstRow = 200, endRow = 568;
constexpr double plateDistance = 0.1;  // m

/// A plate across the picture and a slanted band in front of it.
SceneView bandBefore(double distance) {
  SceneView view;
  view.verticalFieldOfView = 0.9;
  view.surface.push_back(
      test::sheetOver("liver", 8, [](double u, double v) { return Vec3(0.2 * u, 0.2 * v, plateDistance); }));
  view.surface.push_back(test::sheetOver("artery", 8, [&](double u, double v) {
    return Vec3(distance / plateDistance * (0.012 * u + 0.03 * v + 0.004), distance / plateDistance * 0.2 * v,
                distance);
  }));
  return view;
}

Image drawn(const SceneView& view, Quality quality) {
  static Renderer renderer;
  return renderer.render(view, width, height, RenderSettings{quality, false, false});
}

double red(const Image& image, int x, int y) { return image.pixel(x, y)[0]; }

/// Column at which a row passes from the lit plate into the band's shadow, between pixels.
double shadowEdge(const Image& image, int y) {
  double lit = 0.0;
  for (int x = 200; x < 260; ++x) lit += red(image, x, y) / 60.0;
  const double wanted = 0.6 * lit;
  int x = 260;
  while (x < width - 1 && red(image, x, y) > wanted) ++x;
  const double before = red(image, x - 1, y), here = red(image, x, y);
  return x - (wanted - here) / std::max(before - here, 1e-9);
}

/// Root mean square of an edge's distance from the straight line that it is (pixels).
double roughness(const Image& image) {
  double n = 0.0, sy = 0.0, sx = 0.0, syy = 0.0, sxy = 0.0;
  for (int y = firstRow; y < endRow; ++y) {
    const double x = shadowEdge(image, y);
    n += 1.0, sy += y, sx += x, syy += static_cast<double>(y) * y, sxy += x * y;
  }
  const double slope = (n * sxy - sx * sy) / (n * syy - sy * sy), offset = (sx - slope * sy) / n;
  double sum = 0.0;
  for (int y = firstRow; y < endRow; ++y) sum += std::pow(shadowEdge(image, y) - offset - slope * y, 2);
  return std::sqrt(sum / n);
}

TEST(Edges, AShadowOfASmoothEdgeHasNoSteps) {
  EXPECT_LT(roughness(drawn(bandBefore(0.06), Quality::interactive)), 0.35) << "pixels";
}

/// Outlines of bodies, and their shadows on others, are those of film quality.
TEST(Edges, OutlinesAreThoseOfFilm) {
  SceneView view;
  view.verticalFieldOfView = 0.9;
  view.surface.push_back(test::sphere(Vec3(0.0, 0.0, 0.12), 0.05, 64, "liver"));
  view.surface.push_back(test::sphere(Vec3(-0.02, 0.01, 0.075), 0.010, 48, "gallbladder"));
  view.surface.push_back(test::sphere(Vec3(0.012, -0.012, 0.071), 0.006, 48, "artery"));
  const Image interactive = drawn(view, Quality::interactive), film = drawn(view, Quality::film);
  int far = 0, covered = 0;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::uint8_t *const a = film.pixel(x, y), *const b = interactive.pixel(x, y);
      if (a[3] < 255 || b[3] < 255) continue;
      ++covered;
      far += std::max({std::abs(a[0] - b[0]), std::abs(a[1] - b[1]), std::abs(a[2] - b[2])}) > 40 ? 1 : 0;
    }
  EXPECT_LT(1e4 * far / covered, 1.5) << "of 10000 pixels";
}

/// White below a slanted line, black above, one sample a pixel or its exact cover.
Image halves(double slope, bool exact, std::uint8_t alphaAbove = 255) {
  constexpr int side = 96;
  Image image{side, side, {}};
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x) {
      constexpr int samples = 16;
      int cover = 0;
      for (int k = 0; k < samples * samples; ++k) {
        const double px = exact ? x + (k % samples + 0.5) / samples : x + 0.5;
        const double py = exact ? y + (static_cast<double>(k / samples) + 0.5) / samples : y + 0.5;
        cover += py - 30.3 > slope * px ? 1 : 0;
      }
      const auto level = static_cast<std::uint8_t>(std::lround(255.0 * cover / (samples * samples)));
      image.rgba.insert(image.rgba.end(), {level, level, level, level > 0 ? std::uint8_t{255} : alphaAbove});
    }
  return image;
}

double differenceOf(const Image& a, const Image& b) {
  double sum = 0.0;
  for (std::size_t i = 0; i < a.rgba.size(); ++i) sum += std::abs(a.rgba[i] - b.rgba[i]);
  return sum;
}

Image transposed(const Image& image) {
  Image out = image;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      std::copy_n(image.pixel(x, y), 4, out.rgba.begin() + 4 * (static_cast<std::ptrdiff_t>(x) * image.height + y));
  return out;
}

TEST(EdgeSmoother, ComesNearTheCoverOfPixels) {
  EdgeSmoother smoother;
  for (const double slope : {0.05, 0.1, 0.23, 0.37, 0.62}) {
    const Image exact = halves(slope, true), sharp = halves(slope, false);
    Image smooth = sharp, aside = transposed(sharp);
    smoother.smooth(smooth);
    smoother.smooth(aside);
    EXPECT_LT(differenceOf(smooth, exact), 0.6 * differenceOf(sharp, exact)) << slope;
    EXPECT_LT(differenceOf(aside, transposed(exact)), 0.6 * differenceOf(sharp, exact)) << slope << ", transposed";
  }
}

TEST(EdgeSmoother, LeavesStraightEdgesAndWhatWasNotDrawn) {
  EdgeSmoother smoother;
  for (const Image& sharp : {halves(0.0, false), halves(0.2, false, 0)}) {
    Image smooth = sharp;
    smoother.smooth(smooth);
    EXPECT_EQ(smooth.rgba, sharp.rgba);
  }
  for (const auto& [w, h] : {std::pair(1, 1), {2, 40}, {40, 2}, {3, 3}}) {
    Image small{w, h, std::vector<std::uint8_t>(4 * static_cast<std::size_t>(w * h), 90)};
    small.rgba[0] = 255;
    smoother.smooth(small);
    EXPECT_EQ(small.rgba[0], 255) << "pixels at the border stay";
  }
}

}  // namespace
}  // namespace calot::gui::edges_test
