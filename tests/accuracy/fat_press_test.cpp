// SPDX-License-Identifier: GPL-3.0-or-later
// A hook's electrode and a probe pressed into a pad of fat, through the whole step: the force is that of the converged
// solution whatever the cubes and wherever the fat's surface cuts them.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <vector>

#include "sim/step/stepper.h"
#include "tests/sim/scene/support/scenes.h"

namespace calot {
namespace {

constexpr double padTop = 0.012;

class Press {
 public:
  Press(InstrumentKind instrument, double cell, std::uint32_t cells, double x, double y, double raised)
      : instrument_(instrument), x_(x), y_(y), top_(padTop + raised) {
    scene_ = test::blockScene(150, 6);
    OrganDescription& base = scene_.organs[0];
    base.surface = test::boxSurface(Vec3(-0.025, -0.025, -0.01), Vec3(0.025, 0.025, 0.0), {6, 6, 2});
    base.anchors = {{Vec3(0.0, 0.0, -100.0 - 0.003), 100.0, "", 0.0}};
    base.material.youngModulus = 1e7;
    FatDescription pad;
    pad.name = "pad";
    pad.appearance = "fat";
    pad.surface = test::boxSurface(Vec3(-0.018, -0.018, 1e-6), Vec3(0.018, 0.018, top_), {6, 6, 3});
    pad.cellSize = cell;
    pad.cellsPerCube = cells;
    pad.material = {1600.0, 0.4, 920.0, 2.0, 0.01};
    pad.friction = 0.0;
    pad.attachments = {{"block", 1.5 * cell, 1e11, 1e8}};
    scene_.fat = {pad};
    scene_.gravity.setZero();
    scene_.hands[0].instrument = instrument;
    scene_.hands[0].port = Vec3(x, y, 0.13);
    scene_.hands[0].home = Vec3(x, y, 0.04);
    scene_.hands[0].couplingStiffness = 1e4;
    scene_.hands[0].maxForce = 1e3;
    scene_.hands[1].home = Vec3(0.04, 0.0, 0.06);
    model_ = test::buildModel(scene_);
    state_ = initialState(*model_, 1);
    stepper_ = std::make_unique<Stepper>(*model_, executor_);
  }

  double settle(double depth) {
    const StepResult* result = nullptr;
    double waited = 0.0;
    for (double now = depth_; waited < 1.0;) {
      now = std::min(depth, now + 0.1 * model_->stepSeconds());
      std::vector<TickSamples> samples = test::ticksAt(scene_, Vec3(x_, y_, top_ - now), scene_.hands[1].home);
      for (TickSamples& tick : samples) tick.hand[0].instrument = instrument_;
      result = &stepper_->step(state_, samples);
      if (now < depth) continue;
      waited += model_->stepSeconds();
      if (result->fat[0].maxSpeed < 2e-5) break;
    }
    depth_ = depth;
    tip = top_ - result->hand[0].tipSimulated[2];
    return result->hand[0].contactForce[2];
  }

  double tip = 0.0;

 private:
  InstrumentKind instrument_;
  double x_, y_, top_;
  double depth_ = -0.001;
  SceneDescription scene_;
  std::unique_ptr<const Model> model_;
  SerialExecutor executor_;
  State state_;
  std::unique_ptr<Stepper> stepper_;
};

TEST(FatPress, Experiment) {
  const double ref[2][4] = {{0.00199, 0.00484, 0.01093, 0.01726}, {0.00147, 0.00428, 0.01223, 0.02196}};
  const char* only = std::getenv("CUBES");
  for (const std::uint32_t cells : {4U, 2U}) {
    if (only && std::atoi(only) != int(cells)) continue;
    for (const InstrumentKind kind : {InstrumentKind::hook, InstrumentKind::probe}) {
      for (const double raised : {0.0003, 0.001, 0.0017, 0.0024}) {
        for (const auto& [x, y] : {std::array<double, 2>{0.0003, 0.0002}, {0.0014, 0.0016}}) {
          Press press(kind, 0.00075, cells, x, y, raised);
          std::printf("%s %4.2f mm cubes, top %+4.2f, at (%3.1f, %3.1f):", kind == InstrumentKind::hook ? "hook " : "probe",
                      0.75 * cells, 1e3 * raised, 1e3 * x, 1e3 * y);
          int k = 0;
          for (const double depth : {0.0005, 0.001, 0.002, 0.003}) {
            const double force = press.settle(depth);
            std::printf("  %.5f N %+4.0f%%", force, 100 * (force / ref[kind == InstrumentKind::probe][k++] - 1));
          }
          std::printf("\n");
        }
      }
    }
  }
}

}  // namespace
}  // namespace calot
