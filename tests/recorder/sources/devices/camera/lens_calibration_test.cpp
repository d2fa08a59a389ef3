// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/sources/devices/camera/lens_calibration.h"

#include <gtest/gtest.h>

#include <cmath>

#include "recorder/sources/devices/calibration.h"
#include "recorder/sources/devices/camera/camera_calibration.h"
#include "recorder/sources/devices/camera/handle_tracker.h"
#include "tests/recorder/sources/devices/camera/support/marker_scene.h"
#include "tests/support/fault.h"

namespace calot::recorder {
namespace {

using namespace cameratest;

/// The board before a camera as its n-th view has it.
Pose boardPose(int n) {
  const Vec3 position(0.09 * std::sin(2.4 * n), 0.05 * std::sin(1.7 * n + 1.0), 0.48 + 0.1 * std::sin(1.1 * n));
  return posed(position, Vec3(0.45 * std::sin(1.9 * n), 0.5 * std::cos(2.9 * n), 0.3 * std::sin(0.8 * n)),
               Quat::Identity());
}

/// What a camera would find of the board, with noise.
BoardView viewBy(const RigCamera& camera, const Pose& board, double noise, Random& random) {
  BoardView out;
  for (const TagPlace& tag : boardTags()) {
    SeenTag seen;
    seen.id = tag.id;
    bool inside = true;
    for (int k = 0; k < 4; ++k) {
      const Vec3 x = board.position + board.orientation * tag.corner(k);
      Eigen::Vector2d pixel = projected(camera.lens, camera.fromDevice.position + camera.fromDevice.orientation * x);
      inside =
          inside && pixel.x() > 0 && pixel.y() > 0 && pixel.x() < camera.lens.width && pixel.y() < camera.lens.height;
      seen.corner[static_cast<std::size_t>(k)] = pixel + noise * Eigen::Vector2d(random.normal(), random.normal());
    }
    if (inside) out.tags.push_back(seen);
  }
  return out;
}

std::vector<BoardView> viewsBy(const RigCamera& camera, int count, double noise, std::uint64_t seed) {
  Random random(seed);
  std::vector<BoardView> out;
  for (int n = 0; n < count; ++n) out.push_back(viewBy(camera, boardPose(n), noise, random));
  return out;
}

TEST(LensCalibration, FindsTheLens) {
  const RigCamera camera = rigOfCameras(1).cameras[0];
  const LensFit fit = fitLens(viewsBy(camera, 12, 0.15, 3), 1280, 720, 1.0, "board");
  EXPECT_NEAR(fit.lens.focal.x(), camera.lens.focal.x(), 2.5);
  EXPECT_NEAR(fit.lens.focal.y(), camera.lens.focal.y(), 2.5);
  EXPECT_NEAR(fit.lens.centre.x(), camera.lens.centre.x(), 4.0);
  EXPECT_NEAR(fit.lens.centre.y(), camera.lens.centre.y(), 4.0);
  EXPECT_NEAR(fit.lens.residual, 0.15 * std::sqrt(2.0), 0.03);
  EXPECT_LT(fit.lens.focalUncertainty, 0.005);
  EXPECT_GT(fit.lens.coverage, 0.4);
  // What counts is where points are seen.
  for (const double x : {-0.4, 0.0, 0.4}) {
    for (const double y : {-0.2, 0.2})
      EXPECT_LT((projected(fit.lens, Vec3(x, y, 1.0)) - projected(camera.lens, Vec3(x, y, 1.0))).norm(), 3.5);
  }
}

TEST(LensCalibration, FindsTheSecondCamera) {
  const CameraRig rig = rigOfCameras(2);
  const std::vector<BoardView> a = viewsBy(rig.cameras[0], 10, 0.15, 5), b = viewsBy(rig.cameras[1], 10, 0.15, 6);
  const LensFit first = fitLens(a, 1280, 720, 1.0, "a"), second = fitLens(b, 1280, 720, 1.0, "b");
  const PairFit pair = fitPair(a, first, b, second, 1.0, "a, b");
  EXPECT_LT((pair.second.position - rig.cameras[1].fromDevice.position).norm(), 0.003);
  EXPECT_LT(pair.second.orientation.angularDistance(rig.cameras[1].fromDevice.orientation), 0.006);
  EXPECT_LT(pair.residual, 0.4);
}

TEST(LensCalibration, SaysWhatIsWrong) {
  const RigCamera camera = rigOfCameras(1).cameras[0];
  const auto fault = [](const std::vector<BoardView>& views) {
    return caught([&] { fitLens(views, 1280, 720, 1.0, "board.mkv"); });
  };
  expectFault(ErrorKind::damaged, "board.mkv", {"2"}, fault(viewsBy(camera, 2, 0.1, 1)));
  Random random(4);
  std::vector<BoardView> alike;
  for (int n = 0; n < 8; ++n)
    alike.push_back(viewBy(camera, {Vec3(0.01 * n, -0.008 * n, 0.5), Quat::Identity()}, 0.0, random));
  expectFault(ErrorKind::damaged, "board.mkv", {}, fault(alike));
  // Views that are hardly tilted give a lens, and its uncertainty says what it is worth.
  std::vector<BoardView> flat;
  for (int n = 0; n < 8; ++n) {
    const Pose full = boardPose(n);
    flat.push_back(viewBy(
        camera, posed(full.position, 0.04 * Vec3(std::sin(n), std::cos(2.0 * n), 0.0), Quat::Identity()), 0.3, random));
  }
  Calibration calibration;
  calibration.camera = CameraRig{};
  try {
    const LensFit fit = fitLens(flat, 1280, 720, 1.0, "flat");
    RigCamera bad;
    bad.lens = fit.lens;
    calibration.camera->cameras.push_back(bad);
    const std::vector<std::string> faults = rigShortcomings(*calibration.camera);
    EXPECT_TRUE(
        std::any_of(faults.begin(), faults.end(), [](const std::string& f) { return holdsToken(f, "focal length"); }));
  } catch (const Error& e) {
    EXPECT_EQ(e.kind(), ErrorKind::damaged);
  }
}

TEST(TrocarFit, FindsThePointThatShaftsPass) {
  const Vec3 point(0.1, 0.15, 0.5);
  std::vector<DeviceSample> samples;
  Random random(9);
  for (int i = 0; i < 60; ++i) {
    DeviceSample s;
    s.orientation = rotationBy(Vec3(0.35 * std::sin(0.4 * i), 0.35 * std::cos(0.3 * i), 0.7 * i));
    s.position = point - (0.12 + 0.03 * std::sin(0.2 * i)) * (s.orientation * Vec3::UnitZ()) +
                 0.0005 * Vec3(random.normal(), random.normal(), random.normal());
    samples.push_back(s);
  }
  const std::optional<Trocar> fit = fitTrocar(samples);
  ASSERT_TRUE(fit);
  EXPECT_LT((fit->point - point).norm(), 0.001);
  EXPECT_NEAR(fit->residual, 0.0005 * std::sqrt(2.0), 0.0002);
  for (DeviceSample& s : samples) s.orientation = Quat::Identity();
  EXPECT_FALSE(fitTrocar(samples));
}

TEST(CameraPhases, AreReadAndRefused) {
  const std::vector<DeviceScript::Phase> p = parsePhases("rest=0:5,stroke right=5.5:7");
  ASSERT_EQ(p.size(), 2U);
  EXPECT_EQ(p[1].name, "stroke right");
  EXPECT_EQ(p[1].from, 5'500'000'000);
  EXPECT_EQ(p[1].to, 7'000'000'000);
  for (const char* bad :
       {"", "rest", "rest=", "rest=1:1", "rest=5:1", "sleep=0:1", "rest=0:1x", "rest=-1:2", "rest=0:1,,"})
    EXPECT_THROW(parsePhases(bad), Error) << bad;
  EXPECT_EQ(guidedPhases(43.0).size(), 5U);
  EXPECT_EQ(guidedPhases(60.0).size(), 6U);
}

TEST(CameraRigFile, ComesBackAsItWas) {
  Calibration c;
  c.device = "camera";
  c.identity = "camera:film";
  c.date = "2026-01-01T12:00:00Z";
  c.camera = rigOfCameras(2, 0.02);
  c.camera->printScale = 0.99;
  c.camera->trocar[1] = Trocar{Vec3(0.1, 0.2, 0.5), 0.001};
  const std::string text = calibrationText(c, true);
  const Calibration back = parseCalibration(std::as_bytes(std::span(text)), "c.json");
  EXPECT_EQ(calibrationText(back, true), text);
  ASSERT_TRUE(back.camera);
  EXPECT_EQ(back.camera->cameras.size(), 2U);
  EXPECT_EQ(back.camera->cameras[1].lens.readout, 0.02);
  std::string bad = text;
  bad.replace(bad.find("\"printScale\":0.99"), 17, "\"printScale\":0.00");
  EXPECT_THROW(parseCalibration(std::as_bytes(std::span(bad)), "c.json"), Error);
}

}  // namespace
}  // namespace calot::recorder
