// SPDX-License-Identifier: GPL-3.0-or-later
// The camera that turns around the scene, and the picture that it makes.
#include "gui/view/free_view.h"

#include <gtest/gtest.h>
#include <cmath>
#include <QApplication>
#include <QMouseEvent>
#include <QTest>
#include <random>

namespace calot::gui {
namespace {

SceneView cube() {
  SceneView view;
  view.down = -Vec3::UnitZ();
  SurfaceView surface;
  surface.appearance = "liver";
  surface.position = {Vec3(-0.05, -0.05, 0.0), Vec3(0.05, -0.05, 0.0), Vec3(0.05, 0.05, 0.0), Vec3(0.0, 0.0, 0.08)};
  surface.rest = surface.position;
  surface.triangle = {Index3(0, 2, 1), Index3(0, 1, 3), Index3(1, 2, 3), Index3(2, 0, 3)};
  view.surface.push_back(surface);
  view.camera.position = Vec3(0.2, 0.1, 0.15);
  view.verticalFieldOfView = 0.9;
  return view;
}

/// A point in the camera's frame.
Vec3 inCamera(const CameraSample& camera, const Vec3& p) {
  return camera.orientation.conjugate() * (p - camera.position);
}

TEST(OrbitCamera, LooksAtItsPointWithUpUpWhateverIsDone) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> any(-2.0, 2.0);
  OrbitCamera camera(cube());
  for (int i = 0; i < 200; ++i) {
    camera.turn(any(random), any(random));
    camera.zoom(std::exp(any(random)));
    camera.shift(0.1 * any(random), 0.1 * any(random));
    const CameraSample at = camera.sample();
    EXPECT_NEAR(at.orientation.norm(), 1.0, 1e-12);
    const Vec3 centre = inCamera(at, camera.centre());
    EXPECT_NEAR(centre.x(), 0.0, 1e-9);
    EXPECT_NEAR(centre.y(), 0.0, 1e-9);
    EXPECT_NEAR(centre.z(), camera.distance(), 1e-9);
    const Vec3 up = at.orientation.conjugate() * Vec3::UnitZ();
    EXPECT_NEAR(up.x(), 0.0, 1e-9) << "the horizon is level";
    EXPECT_LT(up.y(), 0.0) << "y points down in a picture";
  }
}

TEST(OrbitCamera, BeginsWithTheWholeSceneInThePicture) {
  const SceneView view = cube();
  const CameraSample at = OrbitCamera(view).sample();
  const double half = std::tan(0.5 * OrbitCamera::field);
  for (const Vec3& p : view.surface[0].position) {
    const Vec3 seen = inCamera(at, p);
    EXPECT_LT(std::abs(seen.y()), half * seen.z());
  }
}

TEST(OrbitCamera, ShiftingMovesWhatWasInTheMiddleByThatShareOfThePicture) {
  OrbitCamera camera(cube());
  const Vec3 before = camera.centre();
  camera.shift(0.25, 0.0);
  const Vec3 seen = inCamera(camera.sample(), before);
  EXPECT_NEAR(seen.x() / seen.z() / (2.0 * std::tan(0.5 * OrbitCamera::field)), 0.25, 1e-9);
}

TEST(FreeView, TurnsByMouseAndKeysAndGoesHome) {
  qputenv("QT_QPA_PLATFORM", "offscreen");
  static int count = 1;
  static char name[] = "test";
  static char* arguments[] = {name, nullptr};
  if (QApplication::instance() == nullptr) new QApplication(count, arguments);
  FreeView view;
  view.resize(160, 120);
  view.follow(std::make_shared<const SceneView>(cube()));
  EXPECT_EQ(view.shown(), 0U);
  view.show();
  ASSERT_TRUE(QTest::qWaitFor([&] { return view.shown() > 0; }, 20000)) << "draws what it was given while hidden";
  const Vec3 home = view.camera()->position;
  QTest::mousePress(&view, Qt::LeftButton, {}, {80, 60});
  QTest::mouseMove(&view, {100, 60});
  QMouseEvent drag(QEvent::MouseMove, QPointF(110, 60), view.mapToGlobal(QPointF(110, 60)), Qt::NoButton,
                   Qt::LeftButton, Qt::NoModifier);
  QApplication::sendEvent(&view, &drag);
  EXPECT_GT((view.camera()->position - home).norm(), 0.01);
  QTest::keyClick(&view, Qt::Key_Home);
  EXPECT_LT((view.camera()->position - home).norm(), 1e-12);
  QTest::keyClick(&view, Qt::Key_Plus);
  EXPECT_LT((view.camera()->position).norm(), home.norm());
  view.forget("nothing");
  QTest::keyClick(&view, Qt::Key_Left);
  EXPECT_FALSE(view.camera());
}

}  // namespace
}  // namespace calot::gui
