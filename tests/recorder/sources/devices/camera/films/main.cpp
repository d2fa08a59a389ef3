// SPDX-License-Identifier: GPL-3.0-or-later
// camera_films FOLDER: films of a board and of two handles, by two cameras, for tests of the command line and to try
// the commands without a camera. Pictures of 640 x 360, 25 a second.
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>

#include "recorder/sources/devices/camera/handle_tracker.h"
#include "recorder/sources/pointing.h"
#include "tests/recorder/sources/devices/camera/support/film_of_scene.h"
#include "tests/recorder/sources/devices/camera/support/marker_scene.h"

namespace calot::recorder::cameratest {
namespace {

constexpr int fps = 25;

/// The board stands still for a tenth of a second in each of its places.
Pose boardAt(double time) {
  const int n = static_cast<int>(time / 0.12);
  const Vec3 position(0.1 * std::sin(2.4 * n), 0.055 * std::sin(1.7 * n + 1.0), 0.46 + 0.08 * std::sin(1.1 * n));
  return posed(position, Vec3(0.5 * std::sin(1.9 * n), 0.5 * std::cos(2.9 * n), 0.3 * std::sin(0.8 * n)),
               Quat::Identity());
}

Vec3 homeOf(Hand hand) { return {hand == Hand::left ? -0.09 : 0.05, -0.05, 0.40}; }

Pose upright(const Vec3& position, const Vec3& turn) {
  Mat3 base;
  base << 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -1.0, 0.0;
  return posed(position, Vec3(0.35, 0.25, 0.0), quaternionOf(rotationBy(turn).toRotationMatrix() * base));
}

/// A shaft that passes a point, `length` before it.
Pose swept(const Vec3& point, double length, double time) {
  const Pose tilted =
      upright(Vec3::Zero(), Vec3(0.36 * std::sin(5.0 * time), 0.3 * std::sin(2.3 * time), 0.36 * std::cos(4.1 * time)));
  return {point - length * (tilted.orientation * Vec3::UnitZ()), tilted.orientation};
}

/// rest 0 to 1 s, pivot to 3, strokes to 4, 5, 6, trocar to 8.
Pose stepsAt(Hand hand, double time) {
  const Vec3 home = homeOf(hand);
  if (time < 1.0) return upright(home, Vec3::Zero());
  if (time < 3.0) return swept(home + Vec3(0.0, 0.10, 0.02), 0.12, time);
  if (time < 6.0) {
    const int axis = static_cast<int>(time) - 3;
    return upright(home + 0.1 * minimumJerk((time - std::floor(time) - 0.2) / 0.6) * Vec3::Unit(axis), Vec3::Zero());
  }
  return swept(home + Vec3(0.0, 0.12, 0.03), 0.13 + 0.02 * std::sin(3.0 * time), time);
}

void film(const std::filesystem::path& file, const RigCamera& camera, const std::vector<Body>& bodies, double seconds) {
  Imaging imaging;
  imaging.samples = 2;
  imaging.lensBlur = 0.5;
  Random random(21);
  PlainFilm out(file, camera.lens.width, camera.lens.height, fps);
  for (int i = 0; i < static_cast<int>(seconds * fps + 0.5); ++i)
    out.add(rendered(camera, bodies, static_cast<double>(i) / fps, imaging, random));
}

}  // namespace
}  // namespace calot::recorder::cameratest

int main(int argc, char** argv) {
  using namespace calot;
  using namespace calot::recorder::cameratest;
  if (argc != 2) {
    std::fprintf(stderr, "camera_films FOLDER\n");
    return 2;
  }
  const std::filesystem::path folder = argv[1];
  const recorder::CameraRig rig = shrunk(rigOfCameras(2), 2);
  const std::vector<Body> board{{recorder::boardTags(), boardAt, nullptr}};
  std::vector<Body> steps, hands;
  for (const Hand hand : {Hand::left, Hand::right}) {
    steps.push_back(handleBody(hand, [hand](double t) { return stepsAt(hand, t); }));
    hands.push_back(handleBody(hand, [hand](double t) { return handMotion(hand, t); }));
  }
  for (std::size_t c = 0; c < rig.cameras.size(); ++c) {
    const auto named = [&](const char* what) { return folder / (std::string(what) + (c == 0 ? "1.y4m" : "2.y4m")); };
    film(named("board"), rig.cameras[c], board, 2.4);
    film(named("steps"), rig.cameras[c], steps, 8.0);
    film(named("hands"), rig.cameras[c], hands, 2.0);
  }
  return 0;
}
