// SPDX-License-Identifier: GPL-3.0-or-later
// Scenes of simple closed surfaces, and what is needed to run them; shared by the tests of the core.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cstddef>
#include <map>
#include <memory>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "sim/math/executor.h"
#include "sim/step/stepper.h"

namespace calot::test {

/// Closed outward surface of a box; each side is cut into squares of two triangles, `n` of them along each axis.
inline SurfaceDescription boxSurface(const Vec3& lower, const Vec3& upper, const std::array<int, 3>& n) {
  SurfaceDescription surface;
  std::map<std::array<int, 3>, int> number;
  const auto vertex = [&](const std::array<int, 3>& at) {
    const auto [found, added] = number.emplace(at, static_cast<int>(surface.vertex.size()));
    if (added) {
      Vec3 p;
      for (int a = 0; a < 3; ++a) {
        const auto k = static_cast<std::size_t>(a);
        p[a] = lower[a] + (upper[a] - lower[a]) * at[k] / n[k];
      }
      surface.vertex.push_back(p);
    }
    return found->second;
  };
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::size_t u = (axis + 1) % 3;
    const std::size_t v = (axis + 2) % 3;
    for (const int side : {0, n[axis]}) {
      for (int i = 0; i < n[u]; ++i) {
        for (int j = 0; j < n[v]; ++j) {
          const auto corner = [&](int du, int dv) {
            std::array<int, 3> at{};
            at[axis] = side;
            at[u] = i + du;
            at[v] = j + dv;
            return vertex(at);
          };
          const int a = corner(0, 0);
          const int b = corner(1, 0);
          const int c = corner(1, 1);
          const int d = corner(0, 1);
          if (side != 0) {
            surface.triangle.emplace_back(a, b, c);
            surface.triangle.emplace_back(a, c, d);
          } else {
            surface.triangle.emplace_back(a, c, b);
            surface.triangle.emplace_back(a, d, c);
          }
        }
      }
    }
  }
  return surface;
}

/// Closed outward sphere: a cube's surface, `n` squares along each edge, blown up.
inline SurfaceDescription sphereSurface(const Vec3& centre, double radius, int n) {
  SurfaceDescription surface = boxSurface(Vec3::Constant(-1.0), Vec3::Constant(1.0), {n, n, n});
  for (Vec3& p : surface.vertex) p = centre + radius * p.normalized();
  return surface;
}

inline constexpr double blockTop = 0.015;  ///< m

/// A block of 60 x 60 x 30 mm of liver-like tissue, held at its bottom; its top is z = blockTop. Ports above it, homes
/// in the open. 12 x 12 squares on the top.
inline SceneDescription blockScene(std::uint32_t tetrahedra = 700, int squares = 12) {
  SceneDescription scene;
  scene.name = "block";
  scene.workspace = {Vec3(-0.15, -0.15, -0.15), Vec3(0.15, 0.15, 0.15)};
  OrganDescription block;
  block.name = "block";
  block.appearance = "liver";
  block.surface =
      boxSurface(Vec3(-0.03, -0.03, -blockTop), Vec3(0.03, 0.03, blockTop), {squares, squares, squares / 2});
  block.tetrahedra = tetrahedra;
  block.material.massDamping = 1.0;
  block.material.stiffnessDamping = 0.02;
  block.anchors.push_back({Vec3(0.0, 0.0, -100.0 - 0.7 * blockTop), 100.0, "", 0.0});  // as good as a half-space
  scene.organs = {block};
  scene.hands[0].port = Vec3(-0.012, 0.0, 0.13);
  scene.hands[1].port = Vec3(0.012, 0.0, 0.13);
  scene.hands[0].home = Vec3(-0.012, 0.0, 0.04);
  scene.hands[1].home = Vec3(0.012, 0.0, 0.04);
  scene.camera.position = Vec3(0.0, 0.0, 0.15);
  return scene;
}

/// The same with a flat pad above, "pad", tied to the block's top over its whole lower face, `padGap` away.
inline constexpr double padGap = 0.002;  // m
inline SceneDescription padOnBlockScene() {
  SceneDescription scene = blockScene(400, 8);
  scene.name = "pad on a block";
  OrganDescription pad;
  pad.name = "pad";
  pad.appearance = "gallbladder";
  pad.surface = boxSurface(Vec3(-0.015, -0.015, blockTop + padGap), Vec3(0.015, 0.015, blockTop + 0.014), {6, 6, 3});
  pad.tetrahedra = 150;
  scene.organs.push_back(pad);
  ConnectiveDescription bed;
  bed.name = "bed";
  bed.first = "pad";
  bed.second = "block";
  bed.reach = 0.003;
  bed.strands = 200;
  scene.connective = {bed};
  return scene;
}

/// The block, and a ball far enough beside it not to be reached by who touches the block.
inline SceneDescription blockAndBallScene() {
  SceneDescription scene = blockScene();
  scene.name = "block and ball";
  OrganDescription ball;
  ball.name = "ball";
  ball.appearance = "gallbladder";
  ball.surface = sphereSurface(Vec3(0.08, 0.0, 0.0), 0.015, 6);
  ball.tetrahedra = 200;
  ball.anchors.push_back({Vec3(0.08, 0.0, -0.015), 0.008, "", 0.0});
  scene.organs.push_back(ball);
  return scene;
}

inline std::unique_ptr<const Model> buildModel(const SceneDescription& scene) {
  Model::Built built = Model::build(scene);
  if (!built.model) ADD_FAILURE() << "scene '" << scene.name << "': " << built.error;
  return std::move(built.model);
}

/// One step's ticks with both tips held still.
inline std::vector<TickSamples> ticksAt(const SceneDescription& scene, const Vec3& left, const Vec3& right) {
  TickSamples tick;
  tick.hand[0].position = left;
  tick.hand[1].position = right;
  tick.camera = scene.camera;
  return std::vector<TickSamples>(scene.ticksPerStep, tick);
}

/// A state and a stepper over a model, driven by tips.
class Rig {
 public:
  explicit Rig(const Model& model, Executor* executor = nullptr, MakeBroadPhase make = nullptr)
      : model_(model),
        stepper(model, executor != nullptr ? *executor : serial_, {nullptr, make}),
        state(initialState(model, 1)) {}

  const StepResult& step(const Vec3& left, const Vec3& right) {
    ticks = ticksAt(model_.scene(), left, right);
    return stepper.step(state, ticks);
  }
  /// The right hand stays at home.
  const StepResult& step(const Vec3& left) { return step(left, model_.scene().hands[1].home); }

 private:
  const Model& model_;
  SerialExecutor serial_;

 public:
  Stepper stepper;
  State state;
  std::vector<TickSamples> ticks;
};

/// A run that has everything in it: both hands come down at different times, press, slide, leave; then all sleeps.
struct TipPair {
  Vec3 left;
  Vec3 right;
};
inline TipPair contactRun(int step) {
  const double t = 0.01 * step;
  const auto height = [](double s) {  // down within 0.2 s, held for 0.4 s, up again
    const double down = s < 0.0 ? 0.0 : (s < 0.2 ? s / 0.2 : (s < 0.6 ? 1.0 : (s < 0.8 ? (0.8 - s) / 0.2 : 0.0)));
    return 0.035 - 0.0245 * down;
  };
  return {Vec3(-0.012 + 0.004 * t, 0.003 * t, height(t)), Vec3(0.014, -0.004 * t, height(t - 0.15))};
}

/// Looks at every number, and remembers the first field with one that is not finite.
struct FiniteCheck {
  bool finite = true;
  std::string field;
  template <class T>
  void operator()(const char* name, const T& value) {
    look(value);
    if (!finite && field.empty()) field = name;
  }
  void look(double v) { finite = finite && v - v == 0.0; }
  template <class T>
  requires(std::is_integral_v<T> || std::is_enum_v<T>) void look(T /*value*/) {}
  void look(const Vec3& v) { finite = finite && v.allFinite(); }
  void look(const Quat& q) { finite = finite && q.coeffs().allFinite(); }
  template <class T, std::size_t N>
  void look(const std::array<T, N>& values) {
    for (const T& v : values) look(v);
  }
  template <class T>
  void look(const std::vector<T>& values) {
    for (const T& v : values) look(v);
  }
};

/// True when every number of the state is finite.
inline bool allFinite(const State& state) {
  FiniteCheck check;
  State::components(state, [&](const auto& part) { std::remove_cvref_t<decltype(part)>::fields(part, check); });
  return check.finite;
}

/// True when every number that a step reports is finite.
inline bool allFinite(const StepResult& result) {
  FiniteCheck check;
  for (const HandResult& hand : result.hand) {
    for (const Vec3& v : {hand.tipReal, hand.tipSimulated, hand.contactForce}) check.look(v);
    check.look(hand.orientation);
    check.look(hand.jaw);
    check.look(hand.insertion);
    check.look(hand.structureForce);
  }
  for (const OrganResult& organ : result.organ) {
    for (const double v : {organ.volume, organ.maxDisplacement, organ.maxSpeed, organ.residual}) check.look(v);
  }
  check.look(result.contact.residual);
  check.look(result.contact.maxDepth);
  return check.finite;
}

}  // namespace calot::test
