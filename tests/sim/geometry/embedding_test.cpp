// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/geometry/isosurface_stuffing.h"

#include <gtest/gtest.h>

#include <vector>

#include "sim/math/random.h"
#include "tests/sim/scene/support/scenes.h"

namespace calot::embedding_test {
namespace {

constexpr double radius = 0.03;

struct Carried {
  StuffedMesh stuffed;
  std::vector<Vec3> point;
  std::size_t inside = 0;  // the first ones

  Carried() {
    const SurfaceDescription sphere = test::sphereSurface(Vec3(0.01, -0.02, 0.03), radius, 8);
    stuffed = stuffToCount({sphere.vertex, sphere.triangle}, 800);
    Random random(71);
    while (point.size() < 500) {
      const Vec3 p(random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0), random.uniform(-1.0, 1.0));
      if (p.norm() < 0.8) point.push_back(Vec3(0.01, -0.02, 0.03) + radius * p);
    }
    inside = point.size();
    point.insert(point.end(), sphere.vertex.begin(), sphere.vertex.end());  // about the boundary, in and out
    // Nodes of the mesh themselves: several tetrahedra own them.
    point.insert(point.end(), stuffed.mesh.vertex.begin(), stuffed.mesh.vertex.end());
  }
};

TEST(Embedding, ReproducesTheRestPoints) {
  const Carried c;
  ASSERT_TRUE(c.stuffed.ok()) << c.stuffed.error;
  const Embedding embedding(c.point, c.stuffed.mesh);
  ASSERT_EQ(embedding.anchors().size(), c.point.size());
  std::vector<Vec3> mapped;
  embedding.map(c.stuffed.mesh.vertex, mapped);
  for (std::size_t i = 0; i < c.point.size(); ++i) {
    EXPECT_LT((mapped[i] - c.point[i]).norm(), 1e-12) << i;
    const Embedding::Anchor& anchor = embedding.anchors()[i];
    double sum = 0.0;
    for (const double w : anchor.weight) sum += w;
    EXPECT_NEAR(sum, 1.0, 1e-12);
    for (const int n : anchor.node) {
      ASSERT_GE(n, 0);
      ASSERT_LT(static_cast<std::size_t>(n), c.stuffed.mesh.vertex.size());
    }
    if (i < c.inside) {
      for (const double w : anchor.weight) EXPECT_GE(w, -1e-9) << "an inner point lies in its tetrahedron";
    }
    // Outside, the nearest tetrahedron carries the point: its weights stay of the order of one.
    for (const double w : anchor.weight) EXPECT_LT(std::abs(w), 4.0);
  }
}

TEST(Embedding, AffineMotionIsMappedExactly) {
  const Carried c;
  ASSERT_TRUE(c.stuffed.ok());
  const Embedding embedding(c.point, c.stuffed.mesh);
  SCOPED_TRACE("seed 72");
  Random random(72);
  std::vector<Vec3> mapped;
  for (int trial = 0; trial < 20; ++trial) {
    Mat3 a;
    for (int i = 0; i < 9; ++i) a(i / 3, i % 3) = random.normal();
    const Vec3 b(random.normal(), random.normal(), random.normal());
    std::vector<Vec3> nodes;
    for (const Vec3& p : c.stuffed.mesh.vertex) nodes.emplace_back(a * p + b);
    embedding.map(nodes, mapped);
    for (std::size_t i = 0; i < c.point.size(); ++i) ASSERT_LT((mapped[i] - (a * c.point[i] + b)).norm(), 1e-11) << i;
  }
}

}  // namespace
}  // namespace calot::embedding_test
