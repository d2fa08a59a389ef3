// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "gui/render/renderer.h"
#include "gui/render/scene_resources.h"
#include "gui/render/translucent.h"
#include "recorder/base/errors.h"

namespace calot::gui::connective_test {
namespace {

constexpr int width = 320, height = 240;
constexpr RenderSettings bare{Quality::film, false, false};  // alpha tells what is covered

Renderer& renderer() {
  static Renderer shared;
  return shared;
}

// Upright strands 3 mm apart, 10 mm long, 10 cm before the camera; each joined to its neighbour on the right.
SceneView bed(std::size_t strands) {
  ConnectiveView tissue;
  tissue.name = "bed";
  for (std::size_t s = 0; s < strands; ++s) {
    const double x = 0.003 * (static_cast<double>(s) - 0.5 * static_cast<double>(strands - 1));
    tissue.strand.push_back({Vec3(x, -0.005, 0.1), Vec3(x, 0.005, 0.1)});
    tissue.condition.push_back(StrandCondition::attached);
    tissue.alpha.push_back(1.0F);
    if (s > 0) tissue.sheet.push_back({static_cast<std::uint32_t>(s - 1), static_cast<std::uint32_t>(s)});
  }
  SceneView view;
  view.verticalFieldOfView = 0.3;
  view.connective.push_back(tissue);
  return view;
}

double pixelsPerMetre() { return 0.5 * height / std::tan(0.15) / 0.1; }  // at the bed

/// Sum of coverage over a rectangle of the bed (m, middle of the picture is the origin).
double coverage(const Image& image, double left, double right, double top, double bottom) {
  const auto column = [](double x) { return static_cast<int>(std::lround(0.5 * width + pixelsPerMetre() * x)); };
  const auto row = [](double y) { return static_cast<int>(std::lround(0.5 * height + pixelsPerMetre() * y)); };
  double sum = 0.0;
  for (int y = std::max(0, row(top)); y < std::min(height, row(bottom)); ++y)
    for (int x = std::max(0, column(left)); x < std::min(width, column(right)); ++x)
      sum += image.pixel(x, y)[3] / 255.0;
  return sum;
}
double coverage(const Image& image) { return coverage(image, -1.0, 1.0, -1.0, 1.0); }

/// Mean brightness of what is covered, weighted by coverage (0 to 255).
double brightness(const Image& image) {
  double light = 0.0, weight = 0.0;
  for (std::size_t i = 0; i < image.rgba.size(); i += 4) {
    light += image.rgba[i + 3] * (image.rgba[i] + image.rgba[i + 1] + image.rgba[i + 2]) / 3.0;
    weight += image.rgba[i + 3];
  }
  return weight > 0.0 ? light / weight : 0.0;
}

TEST(ConnectiveSheets, StandBetweenAttachedStrandsOnly) {
  SceneView view = bed(6);  // at -7.5, -4.5, ... 7.5 mm
  const Image whole = renderer().render(view, width, height, bare);
  const double left = coverage(whole, -0.0072, -0.0048, -0.004, 0.004);
  EXPECT_GT(left, 0.1 * 0.0024 * 0.008 * pixelsPerMetre() * pixelsPerMetre()) << "a sheet covers, if thinly";
  EXPECT_EQ(coverage(whole, -1.0, -0.0095, -1.0, 1.0), 0.0) << "nothing beside the bed";
  EXPECT_EQ(coverage(whole, -1.0, 1.0, -1.0, -0.0055), 0.0) << "nothing above it";

  view.connective[0].condition[5] = StrandCondition::burned;
  const Image cut = renderer().render(view, width, height, bare);
  EXPECT_GT(coverage(whole, 0.0055, 0.0072, -0.003, 0.003), 5.0);
  EXPECT_EQ(coverage(cut, 0.0058, 0.0085, -0.003, 0.003), 0.0) << "the sheet went with one of its strands";
  EXPECT_DOUBLE_EQ(coverage(cut, -0.0072, -0.0048, -0.004, 0.004), left) << "the others stay as they are";
}

TEST(ConnectiveSheets, NothingIsDrawnWithoutSheets) {
  SceneView view = bed(6);
  view.connective[0].sheet.clear();
  const Image strands = renderer().render(view, width, height, bare);
  EXPECT_EQ(coverage(strands), 0.0);
  SceneView none;
  none.verticalFieldOfView = view.verticalFieldOfView;
  for (const Quality quality : {Quality::interactive, Quality::film})
    EXPECT_EQ(renderer().render(view, width, height, quality).rgba,
              renderer().render(none, width, height, quality).rgba);
  view.connective[0] = ConnectiveView{};
  EXPECT_EQ(renderer().render(view, width, height, bare).rgba, strands.rgba);
}

TEST(ConnectiveSheets, FadeAndDarkenWithAlpha) {
  SceneView view = bed(6);
  for (const Quality quality : {Quality::interactive, Quality::film}) {
    double covered = std::numeric_limits<double>::infinity(), bright = covered;
    for (const float alpha : {1.0F, 0.7F, 0.3F}) {
      view.connective[0].alpha.assign(6, alpha);
      RenderSettings settings = bare;
      settings.quality = quality;
      const Image image = renderer().render(view, width, height, settings);
      EXPECT_GT(coverage(image), 0.0);
      EXPECT_LT(coverage(image), 0.75 * covered) << alpha;
      EXPECT_LT(brightness(image), 0.9 * bright) << alpha;
      covered = coverage(image);
      bright = brightness(image);
    }
  }
  view.connective[0].alpha.assign(6, 0.0F);
  EXPECT_EQ(coverage(renderer().render(view, width, height, bare)), 0.0);
}

TEST(ConnectiveSheets, IntactTissueIsPaleAndYellowish) {
  const Image image = renderer().render(bed(6), width, height, bare);
  double red = 0.0, green = 0.0, blue = 0.0;
  for (std::size_t i = 0; i < image.rgba.size(); i += 4)
    if (image.rgba[i + 3] > 60) red += image.rgba[i], green += image.rgba[i + 1], blue += image.rgba[i + 2];
  EXPECT_GE(red, green);
  EXPECT_GT(green, blue);
  EXPECT_GT(blue, 0.5 * red) << "whitish, not orange";
}

TEST(ConnectiveSheets, TornStrandsLeaveTuftsAtBothEndsAndBurnedOnesDarkStumps) {
  SceneView view = bed(9);
  view.connective[0].condition.assign(9, StrandCondition::torn);
  const Image torn = renderer().render(view, width, height, bare);
  const double upper = coverage(torn, -0.02, 0.02, -0.009, -0.001);
  const double lower = coverage(torn, -0.02, 0.02, 0.001, 0.009);
  EXPECT_GT(upper, 50.0);
  EXPECT_GT(lower, 50.0);
  EXPECT_EQ(coverage(torn, -1.0, 1.0, -0.0001, 0.0001), 0.0) << "nothing between them";

  view.connective[0].condition.assign(9, StrandCondition::burned);
  view.connective[0].alpha.assign(9, 0.19F);
  const Image burned = renderer().render(view, width, height, bare);
  EXPECT_GT(coverage(burned), 20.0);
  const auto inside = [](const Image& image) { return coverage(image, -0.02, 0.02, -0.0035, 0.0035); };
  EXPECT_GT(inside(torn), 5.0);
  EXPECT_EQ(inside(burned), 0.0) << "a stump is short";
  EXPECT_LT(brightness(burned), 0.4 * brightness(torn));
}

TEST(ConnectiveSheets, TranslucentTissueLetsTheOrganBehindThrough) {
  const auto plate = [](double z) {
    SurfaceView surface;
    surface.organ = surface.appearance = "liver";
    surface.position = {Vec3(-0.1, -0.1, z), Vec3(-0.1, 0.1, z), Vec3(0.1, 0.1, z), Vec3(0.1, -0.1, z)};
    surface.rest = surface.position;
    surface.triangle = {Index3(0, 1, 2), Index3(0, 2, 3)};
    return surface;
  };
  SceneView view = bed(6);
  view.surface.push_back(plate(0.105));
  SceneView without = view;
  without.connective.clear();
  const Image over = renderer().render(view, width, height, bare);
  const Image under = renderer().render(without, width, height, bare);
  EXPECT_DOUBLE_EQ(coverage(over), 1.0 * width * height) << "blending keeps what is solid solid";
  EXPECT_GT(brightness(over), brightness(under) + 1.0);
  view.surface[0] = without.surface[0] = plate(0.095);
  EXPECT_EQ(renderer().render(view, width, height, bare).rgba, renderer().render(without, width, height, bare).rgba)
      << "an organ in front hides it";
}

TEST(ConnectiveSheets, SameViewGivesSameBytes) {
  SceneView view = bed(7);
  view.connective.push_back(view.connective[0]);
  for (auto& strand : view.connective[1].strand)
    for (Vec3& p : strand) p.z() += 0.004;
  view.connective[0].condition[2] = StrandCondition::torn;
  view.connective[0].condition[5] = StrandCondition::burned;
  view.connective[0].alpha[4] = 0.5F;
  for (const Quality quality : {Quality::interactive, Quality::film}) {
    const Image first = renderer().render(view, width, height, quality);
    (void)renderer().render(bed(2), 64, 64, quality);
    EXPECT_EQ(first.rgba, renderer().render(view, width, height, quality).rgba);
    Renderer other;
    EXPECT_EQ(first.rgba, other.render(view, width, height, quality).rgba);
  }
}

TEST(ConnectiveSheets, LeaveNoTraceInTheNextPicture) {
  SceneView none = bed(4);
  none.connective.clear();
  Renderer fresh;
  const Image before = fresh.render(none, width, height);
  (void)fresh.render(bed(4), width, height);
  EXPECT_EQ(before.rgba, fresh.render(none, width, height).rgba);
}

TEST(ConnectiveSheets, RefusesWhatCannotBeDrawn) {
  std::string message;
  const auto refused = [&](auto change) {
    SceneView broken = bed(4);
    change(broken.connective[0]);
    try {
      (void)renderer().render(broken, 64, 64);
    } catch (const Error& error) {
      message = error.what();
      return error.kind() == ErrorKind::damaged && message.find('\n') == std::string::npos;
    }
    return false;
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(refused([](ConnectiveView& c) { c.sheet[1][1] = 4; }));
  EXPECT_NE(message.find("'bed', sheet 1"), std::string::npos) << message;
  EXPECT_TRUE(refused([](ConnectiveView& c) { c.sheet[0][0] = std::numeric_limits<std::uint32_t>::max(); }));
  EXPECT_TRUE(refused([&](ConnectiveView& c) { c.strand[2][1].y() = nan; }));
  EXPECT_NE(message.find("'bed', strand 2"), std::string::npos) << message;
  EXPECT_TRUE(refused([](ConnectiveView& c) { c.strand[3][0].x() = 1e9; }));
  EXPECT_TRUE(refused([](ConnectiveView& c) { c.strand[0][0].z() = std::numeric_limits<double>::infinity(); }));
  EXPECT_TRUE(refused([&](ConnectiveView& c) { c.alpha[0] = static_cast<float>(nan); }));
  EXPECT_TRUE(refused([](ConnectiveView& c) { c.alpha[0] = -0.1F; }));
  EXPECT_TRUE(refused([](ConnectiveView& c) { c.alpha[0] = 1.5F; }));
  EXPECT_TRUE(refused([](ConnectiveView& c) { c.condition[0] = static_cast<StrandCondition>(3); }));
  EXPECT_TRUE(refused([](ConnectiveView& c) { c.alpha.pop_back(); }));
  EXPECT_TRUE(refused([](ConnectiveView& c) { c.condition.pop_back(); }));
  EXPECT_TRUE(refused([](ConnectiveView& c) { c.strand.pop_back(); }));
  EXPECT_FALSE(refused([](ConnectiveView&) {}));
}

TEST(ConnectiveSheets, TissueWithoutExtentIsDrawnAsFiniteNumbers) {
  SceneView view = bed(3);
  for (auto& strand : view.connective[0].strand) strand = {Vec3(0, 0, 0.05), Vec3(0, 0, 0.05)};
  view.connective[0].condition[2] = StrandCondition::torn;
  view.connective[0].sheet.push_back({1, 1});
  for (const SheetVertex& v : makeSheetList(view).vertex) {
    for (int a = 0; a < 3; ++a) ASSERT_TRUE(std::isfinite(v.position[a] + v.normal[a] + v.along[a]));
    for (const float x : v.look) ASSERT_TRUE(std::isfinite(x));
    ASSERT_TRUE(std::isfinite(v.erosion));
  }
  EXPECT_EQ(renderer().render(view, 64, 64, bare).rgba.size(), 4U * 64 * 64);
}

TEST(SheetList, FarPiecesComeFirstAndEveryVertexIsUsed) {
  SceneView view = bed(5);
  for (std::size_t s = 0; s < 5; ++s)
    for (Vec3& p : view.connective[0].strand[s]) p.z() += 0.002 * static_cast<double>((3 * s) % 5);
  view.connective[0].condition[4] = StrandCondition::torn;
  const SheetList list = makeSheetList(view);
  ASSERT_EQ(list.index.size() % 3, 0U);
  EXPECT_EQ(std::set<std::uint32_t>(list.index.begin(), list.index.end()).size(), list.vertex.size());
  // Pieces as they come: connected runs of indices. Their middles must not come nearer and then go away again.
  constexpr std::size_t sheetIndices = 6 * 4;  // four quads
  constexpr std::size_t sheets = 3;
  std::vector<double> depth;
  std::size_t at = 0;
  while (at < list.index.size()) {
    const bool isSheet = depth.size() < sheets + 2 && list.index[at + 2] == list.index[at] + 2;
    const std::size_t count = isSheet ? sheetIndices : std::size_t{6 * 4};
    ASSERT_LE(at + count, list.index.size());
    const std::set<std::uint32_t> used(list.index.begin() + static_cast<std::ptrdiff_t>(at),
                                       list.index.begin() + static_cast<std::ptrdiff_t>(at + count));
    double z = 0.0;
    for (const std::uint32_t v : used) z += static_cast<double>(list.vertex[v].position[2]);
    depth.push_back(z / static_cast<double>(used.size()));
    at += count;
  }
  ASSERT_EQ(depth.size(), sheets + 2) << "three sheets, two tufts";
  for (std::size_t i = 1; i < depth.size(); ++i) EXPECT_LE(depth[i], depth[i - 1] + 0.0012) << i;  // sag and droop
  EXPECT_GT(depth.front(), depth.back() + 0.001);
}

TEST(FibreTexture, RepeatsWithoutASeamAndHasFibresAndGaps) {
  const std::vector<std::uint8_t> texture = makeFibreTexture();
  ASSERT_EQ(texture.size(), std::size_t{4} * fibreColumns * fibreRows);
  const auto film = [&](int column, int row) {
    return static_cast<double>(
        texture[4 * (static_cast<std::size_t>(row) * fibreColumns + static_cast<std::size_t>(column)) + 1]);
  };
  double inside = 0.0, seam = 0.0, fibre = 0.0;
  for (int row = 0; row < fibreRows; ++row) {
    for (int column = 1; column < fibreColumns; ++column)
      inside = std::max(inside, std::abs(film(column, row) - film(column - 1, row)));
    seam = std::max(seam, std::abs(film(0, row) - film(fibreColumns - 1, row)));
  }
  for (int column = 0; column < fibreColumns; ++column)
    seam = std::max(seam, std::abs(film(column, 0) - film(column, fibreRows - 1)));
  EXPECT_LE(seam, inside);
  for (std::size_t i = 0; i < texture.size(); i += 4) fibre += texture[i] > 90 ? 1.0 : 0.0;
  const double share = 4.0 * fibre / static_cast<double>(texture.size());
  EXPECT_GT(share, 0.1);
  EXPECT_LT(share, 0.7);
  EXPECT_EQ(texture, makeFibreTexture());
}

}  // namespace
}  // namespace calot::gui::connective_test
