// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/view/scene_picture_widget.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <QApplication>
#include <QSignalSpy>
#include <QTest>
#include <thread>

#include "gui/render/renderer.h"

namespace calot::gui {
namespace {

class SceneWidget : public ::testing::Test {
 protected:
  static void SetUpTestSuite() {
    qputenv("QT_QPA_PLATFORM", "offscreen");
    static int count = 1;
    static char name[] = "test";
    static char* arguments[] = {name, nullptr};
    if (QApplication::instance() == nullptr) application_ = new QApplication(count, arguments);
  }
  static inline QApplication* application_ = nullptr;
};

std::shared_ptr<const SceneView> plate(std::uint64_t step, double side) {
  SceneView view;
  view.step = step;
  view.time = 0.01 * static_cast<double>(step);
  view.verticalFieldOfView = 0.9;
  SurfaceView surface;
  surface.organ = "plate";
  surface.appearance = "liver";
  surface.position = {Vec3(-side, -side, 0.1), Vec3(-side, side, 0.1), Vec3(side, side, 0.1), Vec3(side, -side, 0.1)};
  surface.rest = surface.position;
  surface.triangle = {Index3(0, 1, 2), Index3(0, 2, 3)};
  view.surface.push_back(surface);
  return std::make_shared<const SceneView>(view);
}

TEST_F(SceneWidget, ShowsTheNewestViewFromAnotherThreadAsTheRendererDrawsIt) {
  ScenePictureWidget widget;
  widget.resize(160, 120);
  widget.show();
  const QSignalSpy spy(&widget, &ScenePictureWidget::pictureShown);
  std::thread([&] {
    for (std::uint64_t step = 1; step <= 50; ++step) widget.showView(plate(step, 0.03));
  }).join();
  ASSERT_TRUE(QTest::qWaitFor([&] { return !spy.isEmpty() && spy.last()[0].toULongLong() == 50; }, 20000));
  EXPECT_LT(widget.shown(), 50U) << "views between the first and the last are left out";
  EXPECT_DOUBLE_EQ(spy.last()[1].toDouble(), 0.5);
  ASSERT_EQ(widget.picture().size(), QSize(160, 120));

  // It stands still: the same moment comes once more, in the quality of films.
  const auto ofLast = [&] {
    return std::count_if(spy.begin(), spy.end(), [](const auto& s) { return s[0].toULongLong() == 50; });
  };
  ASSERT_TRUE(QTest::qWaitFor([&] { return ofLast() == 2; }, 20000));
  Renderer renderer;
  const Image expected = renderer.render(*plate(50, 0.03), 160, 120, Quality::film);
  for (const QPoint at : {QPoint(80, 60), QPoint(60, 40), QPoint(2, 2), QPoint(120, 60)}) {
    const std::uint8_t* pixel = expected.pixel(at.x(), at.y());
    EXPECT_EQ(widget.picture().pixelColor(at), QColor(pixel[0], pixel[1], pixel[2])) << at.x() << ' ' << at.y();
  }
}

TEST_F(SceneWidget, IsDrawnAnewAtTheSizeThatItGets) {
  ScenePictureWidget widget;
  widget.resize(120, 90);
  widget.show();
  widget.showView(plate(1, 0.03));
  ASSERT_TRUE(QTest::qWaitFor([&] { return widget.picture().size() == QSize(120, 90); }, 20000));
  widget.resize(200, 100);
  EXPECT_TRUE(QTest::qWaitFor([&] { return widget.picture().size() == QSize(200, 100); }, 20000));
}

TEST_F(SceneWidget, ATextReplacesThePictureUntilTheNextView) {
  ScenePictureWidget widget;
  widget.resize(120, 90);
  widget.show();
  widget.showView(plate(1, 0.03));
  ASSERT_TRUE(QTest::qWaitFor([&] { return widget.shown() > 0; }, 20000));
  widget.showText("The recording is not here");
  EXPECT_TRUE(widget.picture().isNull());
  widget.showView(plate(2, 0.03));
  EXPECT_TRUE(QTest::qWaitFor([&] { return !widget.picture().isNull(); }, 20000));
}

TEST_F(SceneWidget, AViewThatCannotBeDrawnIsToldOnTheWidget) {
  ScenePictureWidget widget;
  widget.resize(120, 90);
  widget.show();
  SceneView bad = *plate(1, 0.03);
  bad.surface[0].position[0] = Vec3(std::numeric_limits<double>::quiet_NaN(), 0, 0);
  widget.showView(plate(0, 0.03));
  ASSERT_TRUE(QTest::qWaitFor([&] { return widget.shown() > 0; }, 20000));
  widget.showView(std::make_shared<const SceneView>(bad));
  EXPECT_TRUE(QTest::qWaitFor([&] { return widget.picture().isNull(); }, 20000));
}

}  // namespace
}  // namespace calot::gui
