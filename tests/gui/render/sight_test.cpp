// SPDX-License-Identifier: GPL-3.0-or-later
// What is left out of a picture may not be missed in it.
#include "gui/render/draw_list.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "gui/render/instrument_mesh.h"
#include "recorder/sources/scope/endoscope.h"
#include "sim/instruments/instruments.h"
#include "sim/math/random.h"
#include "tests/gui/render/support/shapes.h"

namespace calot::gui::sight_test {
namespace {

constexpr std::uint64_t seed = 41;

Vec3 pointIn(Random& random) {
  const double x = random.uniform(-0.2, 0.2);
  const double y = random.uniform(-0.2, 0.2);
  const double z = random.uniform(-0.05, 0.25);
  return {x, y, z};
}

/// Where in the picture a point of C is: a share of the way from the middle to what is seen last. @pre z > 0
bool seen(const Sight& sight, const Vec3& p) {
  return p.z() > 0.0 && std::abs(p.x()) <= sight.aside * p.z() && std::abs(p.y()) <= sight.up * p.z();
}

TEST(Sight, TheRoundFieldOfWidePicturesIsTheOneThatCheckpointsCount) {
  const Sight sight = sightOf(1280, 720, 0.9, true);
  EXPECT_NEAR(static_cast<double>(sight.rim), recorder::fieldRadius * 360.0, 1e-3);
  EXPECT_NEAR(sight.aside, recorder::fieldRadius * std::tan(0.45), 0.03) << "with a margin of some pixels";
}

TEST(Sight, WhatIsBeyondOneSideIsNeitherSeenNorCastsAShadowThatIs) {
  RecordProperty("seed", static_cast<int>(seed));
  Random random(seed);
  const Sight sight = sightOf(1280, 720, 0.9, true);
  const Vec3 light(static_cast<double>(lightX), static_cast<double>(lightY), 0.0);
  int beyond = 0;
  for (int n = 0; n < 4000; ++n) {
    const std::array<Vec3, 3> corner{pointIn(random), pointIn(random), pointIn(random)};
    if ((placeIn(sight, corner[0]) & placeIn(sight, corner[1]) & placeIn(sight, corner[2]) & Place::sides) == 0)
      continue;
    ++beyond;
    for (int k = 0; k < 20; ++k) {
      const double u = random.uniform();
      const double v = random.uniform(0.0, 1.0 - u);
      const Vec3 p = corner[0] + u * (corner[1] - corner[0]) + v * (corner[2] - corner[0]);
      EXPECT_FALSE(seen(sight, p));
      if (p.z() <= 0.01) continue;  // beside the light's bundle
      for (const double further : {1.01, 1.5, 3.0, 20.0})
        EXPECT_FALSE(seen(sight, Vec3(light + further * (p - light)))) << "its shadow " << further << " times as far";
    }
  }
  EXPECT_GT(beyond, 400);
}

TEST(Sight, WhatIsWellWithinIsSeen) {
  Random random(seed, 1);
  const Sight sight = sightOf(640, 480, 1.0, false);
  int within = 0;
  for (int n = 0; n < 4000; ++n) {
    const Vec3 p = pointIn(random);
    if (placeIn(sight, p) != 0) continue;
    ++within;
    EXPECT_TRUE(seen(sight, p));
  }
  EXPECT_GT(within, 400);
}

TEST(Sight, TheRoundFieldIsNarrowerThanAWidePicture) {
  const Sight all = sightOf(1280, 720, 0.9, false), field = sightOf(1280, 720, 0.9, true);
  EXPECT_DOUBLE_EQ(all.up, std::tan(0.45));
  EXPECT_DOUBLE_EQ(all.aside, std::tan(0.45) * 1280.0 / 720.0);
  EXPECT_LT(field.aside, 0.7 * all.aside);
  EXPECT_DOUBLE_EQ(field.up, all.up) << "it is cut above and below";
  EXPECT_GT(field.aside, all.up * (field.rim + field.feather) / 360.0);
}

TEST(Sight, ATriangleIsTurnedAwayFromTheLensAndTheLight) {
  const Vec3 a(-0.01, -0.01, 0.1), b(0.01, -0.01, 0.1), c(0.0, 0.01, 0.1);
  EXPECT_TRUE(turnedAway(a, b, c)) << "counter-clockwise from behind";
  EXPECT_FALSE(turnedAway(a, c, b));
  // Seen on edge by the lens: the light, which is to the right of it, still falls on the right side.
  const Vec3 d(0.0, -0.01, 0.1), e(0.0, 0.01, 0.1), f(0.0, 0.0, 0.12);
  EXPECT_FALSE(turnedAway(d, e, f) && turnedAway(d, f, e));
}

/// Instruments and clips are drawn from outside alone.
TEST(Meshes, TurnTheirTrianglesOutwards) {
  const auto volume = [](const Mesh& mesh) { return test::volume(mesh.position, mesh.triangle); };
  for (const InstrumentDefinition* each : instruments()) {
    InstrumentView instrument;
    instrument.kind = each->kind;
    instrument.port = Vec3(0.0, 0.0, -0.1);
    instrument.jaw = 0.5;
    for (const InstrumentPart& part : makeInstrument(instrument)) {
      EXPECT_GT(volume(part.mesh), 0.0) << each->name;
      int outwards = 0;
      const auto at = [&](int v) { return part.mesh.position[static_cast<std::size_t>(v)]; };
      for (const Index3& t : part.mesh.triangle)
        outwards +=
            (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0])).dot(part.mesh.normal[static_cast<std::size_t>(t[0])]) >=
            -1e-15;
      // Teeth are shaded smooth.
      EXPECT_GT(outwards, 0.95 * static_cast<double>(part.mesh.triangle.size()));
    }
  }
  EXPECT_GT(volume(makeClip({Pose{}, 0.0012, 0.0085, 0.001})), 0.0);
}

}  // namespace
}  // namespace calot::gui::sight_test
