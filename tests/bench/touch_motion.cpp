// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/bench/touch_motion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "recorder/base/errors.h"
#include "recorder/formats/scene_file.h"
#include "recorder/sources/performer.h"
#include "recorder/sources/pointing.h"
#include "recorder/sources/scene_surfaces.h"

namespace calot::bench {

namespace {

constexpr std::size_t comeNear = 40;      // steps from home to above the organ,
constexpr std::size_t comeDown = 20;      // and onto it
constexpr double pullBack = 0.03;         // m
constexpr double stroke = 0.03;           // m
constexpr std::size_t strokeSteps = 100;  // one way

struct Stroke {
  Vec3 from, to;
};

/// The longest stroke of up to 30 mm from the target in the middle of a hand's targets on an organ.
std::optional<Stroke> strokeOn(const std::vector<recorder::TouchTarget>& targets, std::size_t organ) {
  Vec3 middle = Vec3::Zero();
  double count = 0.0;
  for (const recorder::TouchTarget& t : targets) {
    if (t.organ != organ) continue;
    middle += t.point;
    count += 1.0;
  }
  if (count < 2.0) return std::nullopt;
  middle /= count;
  const recorder::TouchTarget* first = nullptr;
  const recorder::TouchTarget* second = nullptr;
  for (const recorder::TouchTarget& t : targets) {
    if (t.organ != organ) continue;
    if (first == nullptr || (t.point - middle).norm() < (first->point - middle).norm()) first = &t;
  }
  const auto length = [&](const recorder::TouchTarget& t) { return (t.point - first->point).norm(); };
  for (const recorder::TouchTarget& t : targets) {
    if (t.organ != organ || length(t) > stroke) continue;
    if (second == nullptr || length(t) > length(*second)) second = &t;
  }
  return Stroke{first->point, second->point};
}

}  // namespace

SceneDescription touchLiver() {
  SceneDescription scene = recorder::loadScene(std::string(CALOT_ASSETS) + "/scenes/touch-liver.json").description;
  scene.solver.sleeping = false;
  return scene;
}

std::unique_ptr<const Model> built(SceneDescription scene) {
  Model::Built result = Model::build(std::move(scene));
  if (!result.model) throw Error(ErrorKind::failure, result.error);
  return std::move(result.model);
}

Motion pressAndSlide(const SceneDescription& scene, std::size_t steps, double press) {
  const recorder::SceneSurfaces surfaces(scene);
  constexpr std::array<std::size_t, handCount> organ{1, 0};
  std::array<Stroke, handCount> way{};
  for (std::size_t h = 0; h < handCount; ++h) {
    const auto found = strokeOn(recorder::touchTargets(scene, surfaces, h, pullBack), organ[h]);
    if (!found) throw Error(ErrorKind::failure, "scene '" + scene.name + "': a hand reaches no stroke on its organ");
    way[h] = *found;
  }
  /// Where the shaft through a point of the chord meets the organ, and the tip `depth` beyond.
  const auto tipAt = [&](std::size_t h, double s, double depth) {
    const Vec3& port = scene.hands[h].port;
    const Vec3 chord = way[h].from + s * (way[h].to - way[h].from);
    const Vec3 axis = recorder::shaftDirection(port, chord);
    const auto hit = surfaces.firstHit(port, chord + 0.03 * axis);
    return Vec3((hit ? hit->point : chord) + depth * axis);
  };
  Motion motion;
  motion.approach = comeNear + comeDown;
  for (std::size_t n = 0; n < motion.approach + steps; ++n) {
    std::vector<TickSamples> ticks(scene.ticksPerStep);
    for (std::size_t i = 0; i < ticks.size(); ++i) {
      const double t = static_cast<double>(n) + static_cast<double>(i + 1) / static_cast<double>(ticks.size());
      ticks[i].camera = scene.camera;
      for (std::size_t h = 0; h < handCount; ++h) {
        const Vec3 above = tipAt(h, 0.0, -pullBack);
        Vec3 tip;
        if (t < comeNear) {
          const double s = recorder::minimumJerk(t / comeNear);
          tip = scene.hands[h].home + s * (above - scene.hands[h].home);
        } else if (t < comeNear + comeDown) {
          const double s = recorder::minimumJerk((t - comeNear) / comeDown);
          tip = above + s * (tipAt(h, 0.0, press) - above);
        } else {
          const double strokes = (t - comeNear - comeDown) / strokeSteps;
          const double part = strokes - std::floor(strokes);
          const bool back = std::fmod(strokes, 2.0) >= 1.0;
          const double s = recorder::minimumJerk(part);
          tip = tipAt(h, back ? 1.0 - s : s, press);
        }
        ticks[i].hand[h].position = tip;
        ticks[i].hand[h].orientation = recorder::pointing(scene.hands[h].port, tip);
        ticks[i].hand[h].jaw = 0.2;
      }
      ticks[i] = roundedToGrid(ticks[i]);
    }
    motion.step.push_back(std::move(ticks));
  }
  return motion;
}

LaidShaft shaftLaidAlongLiver() {
  constexpr double left = -0.09;   // x of the liver's side that the port is at,
  constexpr double right = 0.03;   // and of the tip (m)
  constexpr double at = 0.03;      // z of the shaft (m)
  constexpr double above = 0.003;  // the line from end to end stays so far off the liver (m)
  constexpr int steps = 140;
  constexpr double pace = 0.0005;  // m a step
  constexpr double start = 0.02;   // m above
  LaidShaft laid{touchLiver(), {}};
  SceneDescription& scene = laid.scene;
  scene.workspace = {Vec3::Constant(-0.3), Vec3::Constant(0.3)};
  const recorder::SceneSurfaces surfaces(scene);
  const auto top = [&](double x) {
    const auto hit = surfaces.firstHit(Vec3(x, 0.2, at), Vec3(x, -0.2, at));
    return hit ? hit->point : Vec3(x, -1.0, at);
  };
  const Vec3 from = top(left);
  const Vec3 to = top(right);
  double lift = 0.0;
  for (int i = 0; i <= 40; ++i) {
    const Vec3 chord = from + i / 40.0 * (to - from);
    lift = std::max(lift, top(chord.x()).y() - chord.y());
  }
  const Vec3 up(0.0, lift + above, 0.0);
  scene.hands[laidHand].port = from - 0.06 * (to - from).normalized() + up;
  scene.hands[laidHand].home = to + up + Vec3(0.0, start, 0.0);
  TickSamples tick;
  tick.camera = scene.camera;
  for (std::size_t h = 0; h < handCount; ++h) {
    tick.hand[h].position = scene.hands[h].home;
    tick.hand[h].orientation = recorder::pointing(scene.hands[h].port, scene.hands[h].home);
  }
  tick.hand[laidHand].jaw = 0.5;
  for (int n = 0; n < steps; ++n) {
    const Vec3 tip = to + up + Vec3(0.0, start - pace * n, 0.0);
    tick.hand[laidHand].position = tip;
    tick.hand[laidHand].orientation = recorder::pointing(scene.hands[laidHand].port, tip);
    laid.motion.step.emplace_back(scene.ticksPerStep, roundedToGrid(tick));
  }
  return laid;
}

}  // namespace calot::bench
