// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/render/renderer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>
#include <sstream>
#include <string>

#include "gui/render/image.h"
#include "recorder/base/errors.h"
#include "sim/instruments/instruments.h"
#include "tests/gui/render/support/shapes.h"

namespace calot::gui::renderer_test {
namespace {

constexpr int width = 320, height = 240;

// One renderer for all tests: a context takes a while to come up.
Renderer& renderer() {
  static Renderer shared;
  return shared;
}

SceneView emptyView() {
  SceneView view;
  view.verticalFieldOfView = 0.9;
  return view;
}

double focalLength() { return 0.5 * height / std::tan(0.45); }  // pixels

SurfaceView triangleAt(double z, double side) {
  SurfaceView surface;
  surface.organ = "plate";
  surface.appearance = "liver";
  surface.position = {Vec3(0, 0, z), Vec3(0, side, z), Vec3(side, 0, z)};
  surface.rest = surface.position;
  surface.triangle = {Index3(0, 1, 2)};
  return surface;
}

SurfaceView sphere(const Vec3& centre, double radius, const std::string& appearance) {
  return test::sphere(centre, radius, 64, appearance);
}

SceneView organsAndInstruments() {
  SceneView view = emptyView();
  view.surface.push_back(sphere(Vec3(0.0, 0.0, 0.12), 0.05, "liver"));
  view.surface.push_back(sphere(Vec3(0.02, 0.01, 0.075), 0.015, "gallbladder"));
  for (int h = 0; h < handCount; ++h) {
    InstrumentView& instrument = view.instrument[static_cast<std::size_t>(h)];
    instrument.kind = h == 0 ? InstrumentKind::grasper : InstrumentKind::hook;
    instrument.pose.position = Vec3(h == 0 ? -0.02 : 0.03, -0.01, 0.07);
    instrument.port = Vec3(h == 0 ? -0.1 : 0.1, -0.03, 0.0);
    instrument.pose.orientation = Quat::FromTwoVectors(Vec3::UnitZ(), instrument.pose.position - instrument.port);
    instrument.jaw = 0.6;
  }
  return view;
}

constexpr RenderSettings bare{Quality::film, false, false};  // alpha tells what is covered

double coveredPixels(const Image& image) {
  double sum = 0.0;
  for (std::size_t i = 3; i < image.rgba.size(); i += 4) sum += image.rgba[i] / 255.0;
  return sum;
}

std::optional<ErrorKind> kindOf(const std::function<void()>& call, std::string* message = nullptr) {
  try {
    call();
  } catch (const Error& error) {
    if (message != nullptr) *message = error.what();
    return error.kind();
  }
  return std::nullopt;
}

TEST(Renderer, SameViewGivesSameBytes) {
  const SceneView view = organsAndInstruments();
  for (const Quality quality : {Quality::interactive, Quality::film}) {
    const Image first = renderer().render(view, width, height, quality);
    (void)renderer().render(emptyView(), 64, 64, quality);  // other sizes and scenes between them leave no trace
    EXPECT_EQ(first.rgba, renderer().render(view, width, height, quality).rgba);
    Renderer other;
    EXPECT_EQ(first.rgba, other.render(view, width, height, quality).rgba);
  }
}

/// Interactive quality is the same picture with less finish: light, colour and place agree.
TEST(Renderer, InteractiveQualityLooksLikeFilm) {
  const SceneView view = organsAndInstruments();
  const Image film = renderer().render(view, width, height, Quality::film);
  const Image interactive = renderer().render(view, width, height, Quality::interactive);
  double difference = 0.0, mean = 0.0, other = 0.0;
  int far = 0, inside = 0;
  for (int i = 0; i < width * height; ++i) {
    const std::uint8_t* const a = film.pixel(i % width, i / width);
    const std::uint8_t* const b = interactive.pixel(i % width, i / width);
    const bool field = std::hypot(i % width + 0.5 - 0.5 * width, i / width + 0.5 - 0.5 * height) < 0.54 * height;
    if (!field) continue;
    ++inside;
    int largest = 0;
    for (int c = 0; c < 3; ++c) largest = std::max(largest, std::abs(a[c] - b[c]));
    for (int c = 0; c < 3; ++c) mean += a[c] / 3.0, other += b[c] / 3.0;
    difference += largest;
    far += largest > 60 ? 1 : 0;
  }
  EXPECT_NEAR(other, mean, 0.06 * mean) << "brightness";
  EXPECT_LT(difference / inside, 12.0) << "levels, the worst channel of each pixel";
  EXPECT_LT(far, 0.04 * inside) << "edges and glints alone may differ much";
}

TEST(Renderer, OutsideOfTheRoundFieldIsBlackInBothQualities) {
  for (const Quality quality : {Quality::interactive, Quality::film}) {
    const Image image = renderer().render(organsAndInstruments(), width, height, quality);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const double radius = std::hypot(x + 0.5 - 0.5 * width, y + 0.5 - 0.5 * height);
        const std::uint8_t* const p = image.pixel(x, y);
        ASSERT_EQ(p[3], 255);
        if (radius > 0.56 * height + 4.0) {  // soft by 1.5 pixels, and where the cavity has half the size by 2 more
          ASSERT_EQ(p[0] + p[1] + p[2], 0) << x << ", " << y;
        } else if (radius < 0.5 * height) {
          ASSERT_GT(p[0] + p[1] + p[2], 0) << x << ", " << y;
        }
      }
  }
}

TEST(Renderer, TriangleFacingTheCameraCoversItsProjectedArea) {
  SceneView view = emptyView();
  SurfaceView plate = triangleAt(0.1, 0.03);
  // No edge along a row, a column or a diagonal of samples, where rounding would add up.
  plate.position = {Vec3(-0.011, -0.0073, 0.1), Vec3(0.0041, 0.019, 0.1), Vec3(0.0213, -0.0019, 0.1)};
  plate.rest = plate.position;
  view.surface.push_back(plate);
  const double area = 0.5 * (plate.position[1] - plate.position[0]).cross(plate.position[2] - plate.position[0]).norm();
  const double projected = area * std::pow(focalLength() / 0.1, 2);
  EXPECT_NEAR(coveredPixels(renderer().render(view, width, height, bare)), projected, 0.004 * projected);
}

TEST(Renderer, AxesFollowTheCameraConvention) {
  SceneView view = emptyView();
  view.surface.push_back(triangleAt(0.1, 0.03));  // x right, y down: in the lower right quarter
  const Image image = renderer().render(view, width, height, bare);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      if (image.pixel(x, y)[3] > 0) {
        ASSERT_GE(x, width / 2);
        ASSERT_GE(y, height / 2);
      }
  EXPECT_EQ(image.pixel(width / 2 + 5, height / 2 + 5)[3], 255);
}

TEST(Renderer, AMovedAndTurnedCameraSeesTheSameAsAMovedScene) {
  SceneView view = emptyView();
  view.surface.push_back(triangleAt(0.1, 0.03));
  const double covered = coveredPixels(renderer().render(view, width, height, bare));
  const Quat turn(Eigen::AngleAxisd(1.1, Vec3(0.3, -0.5, 0.8).normalized()));
  const Vec3 shift(0.4, -0.2, 0.7);
  for (Vec3& p : view.surface[0].position) p = turn * p + shift;
  view.camera = {shift, turn};
  EXPECT_NEAR(coveredPixels(renderer().render(view, width, height, bare)), covered, 2.0);
}

TEST(Renderer, SphereHasTheSilhouetteOfThePinholeFormula) {
  const double radius = 0.02, distance = 0.1;
  SceneView view = emptyView();
  view.surface.push_back(sphere(Vec3(0, 0, distance), radius, "liver"));
  // The cone that touches a sphere on the axis has sin(angle) = radius / distance.
  const double angle = std::asin(radius / distance);
  const double pixels = focalLength() * std::tan(angle);
  const double covered = coveredPixels(renderer().render(view, width, height, bare));
  EXPECT_NEAR(std::sqrt(covered / std::numbers::pi), pixels, 0.25);
}

TEST(Renderer, NearerSurfacesHideFartherOnes) {
  SceneView view = emptyView();
  view.surface.push_back(sphere(Vec3(0, 0, 0.06), 0.01, "gallbladder"));
  view.surface.push_back(sphere(Vec3(0, 0, 0.12), 0.02, "liver"));
  const Image image = renderer().render(view, width, height, bare);
  const std::uint8_t* const middle = image.pixel(width / 2 + 12, height / 2 + 12);
  EXPECT_GT(middle[1], middle[0]) << "the green of the gallbladder is in front";
  view.surface[0] = sphere(Vec3(0, 0, 0.2), 0.01, "gallbladder");
  const Image hidden = renderer().render(view, width, height, bare);
  EXPECT_GT(hidden.pixel(width / 2 + 12, height / 2 + 12)[0], hidden.pixel(width / 2 + 12, height / 2 + 12)[1]);
}

TEST(Renderer, OpenJawsCoverMoreThanClosedOnes) {
  SceneView view = emptyView();
  InstrumentView& grasper = view.instrument[0];
  grasper.kind = InstrumentKind::grasper;
  grasper.pose.position = Vec3(0.0, 0.0, 0.08);
  grasper.pose.orientation = Quat::FromTwoVectors(Vec3::UnitZ(), Vec3::UnitX());
  grasper.port = Vec3(-0.15, 0.0, 0.08);
  const auto extent = [&](double jaw) {  // height of what is seen just behind the tip
    grasper.jaw = jaw;
    const Image image = renderer().render(view, width, height, bare);
    int first = height, last = 0;
    for (int y = 0; y < height; ++y)
      for (int x = width / 2 - 14; x < width / 2 + 4; ++x)
        if (image.pixel(x, y)[3] > 127) first = std::min(first, y), last = std::max(last, y);
    return last - first;
  };
  EXPECT_GT(extent(1.0), extent(0.1) + 15);
}

TEST(Renderer, EveryInstrumentIsDrawnAndDifferent) {
  std::vector<std::vector<std::uint8_t>> seen;
  std::vector<InstrumentKind> kinds{InstrumentKind::none};
  for (const InstrumentDefinition* each : instruments()) kinds.push_back(each->kind);
  for (const InstrumentKind kind : kinds) {
    SceneView view = emptyView();
    view.instrument[1].kind = kind;
    view.instrument[1].pose.position = Vec3(0.01, 0.0, 0.06);
    view.instrument[1].port = Vec3(0.1, 0.0, 0.0);
    view.instrument[1].pose.orientation = Quat::FromTwoVectors(Vec3::UnitZ(), Vec3(-0.09, 0.0, 0.06));
    view.instrument[1].jaw = 0.5;
    const Image image = renderer().render(view, width, height, bare);
    EXPECT_EQ(coveredPixels(image) > 100.0, kind != InstrumentKind::none);
    for (const auto& other : seen) EXPECT_NE(other, image.rgba);
    seen.push_back(image.rgba);
  }
}

TEST(Renderer, EmptySceneIsACavityInARoundField) {
  const Image image = renderer().render(emptyView(), width, height);
  EXPECT_EQ(image.pixel(0, 0)[0], 0) << "outside the round field it is black";
  EXPECT_EQ(image.pixel(0, 0)[3], 255);
  const std::uint8_t* const middle = image.pixel(width / 2, height / 2);
  EXPECT_GT(middle[0], middle[1]) << "the cavity is reddish";
  EXPECT_GT(middle[0], 10);
  EXPECT_EQ(coveredPixels(renderer().render(emptyView(), width, height, bare)), 0.0);
}

TEST(Renderer, RefusesWhatIsNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::string message;
  SceneView view = emptyView();
  view.surface.push_back(triangleAt(0.1, 0.03));
  view.surface[0].position[1].y() = nan;
  EXPECT_EQ(kindOf([&] { (void)renderer().render(view, width, height); }, &message), ErrorKind::damaged);
  EXPECT_NE(message.find("'plate', vertex 1"), std::string::npos) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos);

  const auto refused = [&](auto change) {
    SceneView broken = organsAndInstruments();
    change(broken);
    return kindOf([&] { (void)renderer().render(broken, width, height); }) == ErrorKind::damaged;
  };
  EXPECT_TRUE(refused([&](SceneView& v) { v.surface[0].rest[0].x() = std::numeric_limits<double>::infinity(); }));
  EXPECT_TRUE(refused([&](SceneView& v) { v.surface[0].rest.pop_back(); }));
  EXPECT_TRUE(refused([&](SceneView& v) { v.surface[0].triangle[0][2] = 1 << 30; }));
  EXPECT_TRUE(refused([&](SceneView& v) { v.surface[0].triangle[0][0] = -1; }));
  EXPECT_TRUE(refused([&](SceneView& v) { v.surface[1].position[0].z() = 1e9; }));
  EXPECT_TRUE(refused([&](SceneView& v) { v.camera.position.x() = nan; }));
  EXPECT_TRUE(refused([&](SceneView& v) { v.camera.orientation.coeffs().setZero(); }));
  EXPECT_TRUE(refused([&](SceneView& v) { v.verticalFieldOfView = nan; }));
  EXPECT_TRUE(refused([&](SceneView& v) { v.verticalFieldOfView = 3.2; }));
  EXPECT_TRUE(refused([&](SceneView& v) { v.instrument[0].jaw = nan; }));
  EXPECT_TRUE(refused([&](SceneView& v) { v.instrument[1].radius = -1.0; }));
  EXPECT_TRUE(refused([&](SceneView& v) { v.instrument[1].pose.orientation.w() = nan; }));
  EXPECT_FALSE(refused([&](SceneView&) {}));
}

TEST(Renderer, RefusesSizesOutsideItsLimits) {
  const SceneView view = emptyView();
  for (const auto& size : {PictureSize{0, 0}, PictureSize{-5, 100}, PictureSize{8, 100}, PictureSize{100000, 100000},
                           PictureSize{4096, 4096}})
    EXPECT_EQ(kindOf([&] { (void)renderer().render(view, size.width, size.height); }), ErrorKind::invalid)
        << size.width << "x" << size.height;
}

TEST(Renderer, DrawsAgainAfterARefusal) {
  SceneView broken = emptyView();
  broken.verticalFieldOfView = -1.0;
  EXPECT_EQ(kindOf([&] { (void)renderer().render(broken, width, height); }), ErrorKind::damaged);
  EXPECT_EQ(renderer().render(emptyView(), width, height).rgba.size(), 4U * width * height);
}

TEST(PictureSize, ReadsWidthAndHeight) {
  const PictureSize size = parsePictureSize("640x480");
  EXPECT_EQ(size.width, 640);
  EXPECT_EQ(size.height, 480);
  for (const char* wrong : {"", "x", "640", "640x", "x480", "640x480x3", "640X480", " 640x480", "-640x480", "1e3x480",
                            "99999999999999999999x480", "8x8", "5000x100"})
    EXPECT_EQ(kindOf([&] { (void)parsePictureSize(wrong); }), ErrorKind::invalid) << wrong;
}

class PngFile : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = std::filesystem::path(::testing::TempDir()) /
              (std::string("calot_png_") + ::testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  static std::string bytes(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    std::ostringstream all;
    all << in.rdbuf();
    return all.str();
  }
  std::filesystem::path folder_;
};

TEST_F(PngFile, WritesAWholePngOfTheRightSize) {
  writePng(renderer().render(organsAndInstruments(), 200, 120, Quality::interactive), folder_ / "a.png");
  const std::string png = bytes(folder_ / "a.png");
  ASSERT_GT(png.size(), 1000U);
  EXPECT_EQ(png.substr(0, 8), std::string("\x89PNG\r\n\x1a\n"));
  EXPECT_EQ(png.substr(12, 12), std::string("IHDR\0\0\0\xc8\0\0\0\x78", 12));
  EXPECT_EQ(png.substr(png.size() - 8, 4), "IEND");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), std::filesystem::directory_iterator()), 1);
}

TEST_F(PngFile, NothingIsLeftBehindWhenItCannotBeWritten) {
  const Image image{2, 2, std::vector<std::uint8_t>(16, 7)};
  std::filesystem::create_directories(folder_ / "taken" / "inside");
  std::string message;
  EXPECT_EQ(kindOf([&] { writePng(image, folder_ / "taken"); }, &message), ErrorKind::invalid);
  EXPECT_NE(message.find("taken"), std::string::npos);
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), std::filesystem::directory_iterator()), 1);
  EXPECT_EQ(kindOf([&] { writePng(image, folder_ / "missing" / "a.png"); }), ErrorKind::invalid);
  EXPECT_EQ(kindOf([&] { writePng(Image{2, 2, {}}, folder_ / "b.png"); }), ErrorKind::failure);
  EXPECT_FALSE(std::filesystem::exists(folder_ / "b.png"));
}

}  // namespace
}  // namespace calot::gui::renderer_test
