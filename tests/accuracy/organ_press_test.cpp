// SPDX-License-Identifier: GPL-3.0-or-later
// A probe with a round end of 2.5 mm pressed into the liver and the gallbladder on coarse meshes and fine ones.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

#include "sim/step/stepper.h"
#include "tests/sim/scene/support/scenes.h"

namespace calot {
namespace {

SurfaceDescription organSurface(const std::string& name) {
  std::ifstream in(std::string(CALOT_SOURCE_DIR) + "/assets/organs/" + name + ".obj");
  SurfaceDescription surface;
  for (std::string line; std::getline(in, line);) {
    double x = 0.0, y = 0.0, z = 0.0;
    int a = 0, b = 0, c = 0;
    if (std::sscanf(line.c_str(), "v %lf %lf %lf", &x, &y, &z) == 3) surface.vertex.emplace_back(x, y, z);
    if (std::sscanf(line.c_str(), "f %d %d %d", &a, &b, &c) == 3) surface.triangle.emplace_back(a - 1, b - 1, c - 1);
  }
  return surface;
}

struct OrganCase {
  const char* name;
  double young;
  Vec3 place;   ///< on the skin
  Vec3 normal;  ///< outward, there
  std::vector<AnchorDescription> anchors;
};

/// Forces at 1 to 6 mm (N).
std::vector<double> press(const OrganCase& organ, std::uint32_t tetrahedra) {
  SceneDescription scene = test::blockScene(300, 8);
  scene.workspace = {Vec3::Constant(-0.5), Vec3::Constant(0.5)};
  OrganDescription& body = scene.organs[0];
  body.surface = organSurface(organ.name);
  body.tetrahedra = tetrahedra;
  body.material.youngModulus = organ.young;
  body.friction = 0.0;
  body.anchors = organ.anchors;
  scene.hands[0].instrument = InstrumentKind::probe;
  scene.hands[0].port = organ.place + 0.12 * organ.normal;
  scene.hands[0].home = organ.place + 0.03 * organ.normal;
  scene.hands[0].couplingStiffness = 1e4;
  scene.hands[0].maxForce = 1e3;
  scene.hands[1].port = organ.place + 0.25 * organ.normal;
  scene.hands[1].home = organ.place + 0.2 * organ.normal;
  const std::unique_ptr<const Model> model = test::buildModel(scene);
  SerialExecutor executor;
  State state = initialState(*model, 1);
  Stepper stepper(*model, executor);
  std::vector<double> force;
  double depth = -0.002;
  for (int mm = 1; mm <= 6; ++mm) {
    const StepResult* result = nullptr;
    for (int i = 0; i < 600; ++i) {
      depth = std::min(1e-3 * mm, depth + 0.0003);
      std::vector<TickSamples> samples = test::ticksAt(scene, organ.place - depth * organ.normal, scene.hands[1].home);
      for (TickSamples& tick : samples) tick.hand[0].instrument = InstrumentKind::probe;
      result = &stepper.step(state, samples);
      if (depth == 1e-3 * mm && result->organ[0].maxSpeed < 1e-5) break;
    }
    force.push_back(result->hand[0].contactForce.dot(organ.normal));
  }
  return force;
}

/// The first mesh is the finest.
void comparePresses(const OrganCase& organ, const std::vector<std::uint32_t>& meshes) {
  std::vector<std::vector<double>> all;
  for (const std::uint32_t tetrahedra : meshes) {
    all.push_back(press(organ, tetrahedra));
    std::printf("%s, %5u tetrahedra:", organ.name, tetrahedra);
    for (std::size_t k = 0; k < all[0].size(); ++k) {
      const double off = all.back()[k] / all[0][k] - 1.0;
      std::printf("  %.4f N %+5.1f %%", all.back()[k], 100.0 * off);
      EXPECT_LT(std::abs(off), 0.10) << tetrahedra << " at " << k + 1 << " mm";
    }
    std::printf("\n");
  }
}

TEST(OrganPress, Liver) {
  comparePresses({"liver",
                  5200.0,
                  Vec3(0.023271, 0.060906, 0.000385),
                  Vec3(0.01262754, 0.99911784, 0.04005117).normalized(),
                  {{Vec3(0.05, -0.05, 0.07), 0.045, "", 0.0}, {Vec3(-0.09, 0.005, 0.055), 0.02, "", 0.0}}},
                 {20000, 6000, 1500, 300});
}

/// From below, held where it lies against the liver. Its cells are as small as the tip at 20,000 tetrahedra.
TEST(OrganPress, Gallbladder) {
  comparePresses({"gallbladder",
                  10000.0,
                  Vec3(0.002776, 0.02019, -0.026772),
                  Vec3(-0.24331956, -0.13936659, -0.95988153).normalized(),
                  {{Vec3(0.0, 0.0, 100.0 - 0.008), 100.0, "", 0.0}}},
                 {20000, 6000, 1500, 300});
}

}  // namespace
}  // namespace calot
