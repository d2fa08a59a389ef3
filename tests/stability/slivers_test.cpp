// SPDX-License-Identifier: GPL-3.0-or-later
// Meshes with bad tetrahedra: nearly flat ones, whose stiffness is thousands of times their neighbours'.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <numbers>
#include <vector>

#include "sim/geometry/isosurface_stuffing.h"
#include "sim/math/random.h"
#include "tests/accuracy/support/kuhn_box.h"
#include "tests/accuracy/support/settle.h"
#include "tests/stability/support/solid_checks.h"

namespace calot::slivers_test {
namespace {

constexpr double cell = 0.01;  // m

double volumeOf(const test::KuhnBox& box, const Index4& t) {
  const auto at = [&](int c) -> const Vec3& { return box.node[static_cast<std::size_t>(t[c])]; };
  return (at(1) - at(0)).cross(at(2) - at(0)).dot(at(3) - at(0)) / 6.0;
}

/// A box whose inner nodes went towards faces of their own tetrahedra until these had a thousandth of their height
/// left.
struct SliverBox {
  test::KuhnBox box = test::kuhnBox(6, 4, 4, Vec3::Zero(), cell* Vec3(6.0, 4.0, 4.0));
  int slivers = 0;        ///< with less than a hundredth of the others' volume
  double minAngle = 0.0;  ///< between two faces (degrees)

  explicit SliverBox(std::uint64_t seed) {
    Random random(seed);
    const auto inside = [&](std::size_t n) {
      const Vec3 p = box.node[n] / cell;
      return p[0] > 0.5 && p[0] < 5.5 && p[1] > 0.5 && p[1] < 3.5 && p[2] > 0.5 && p[2] < 3.5;
    };
    for (int made = 0, tried = 0; made < 12 && tried < 1000; ++tried) {
      const Index4 t = box.tetrahedron[random.next() % box.tetrahedron.size()];
      const auto n = static_cast<std::size_t>(t[static_cast<int>(random.next() % 4U)]);
      if (!inside(n)) continue;
      const Vec3 was = box.node[n];
      Vec3 centre = Vec3::Zero();  // of the face that is not the node's
      for (int c = 0; c < 4; ++c) {
        if (static_cast<std::size_t>(t[c]) != n) centre += box.node[static_cast<std::size_t>(t[c])] / 3.0;
      }
      box.node[n] += 0.999 * (centre - was);
      const bool good = std::all_of(box.tetrahedron.begin(), box.tetrahedron.end(), [&](const Index4& other) {
        return volumeOf(box, other) > 1e-5 * cell * cell * cell;
      });
      if (!good) box.node[n] = was;
      if (good) ++made;
    }
    for (const Index4& t : box.tetrahedron) slivers += volumeOf(box, t) < 1e-3 * cell * cell * cell ? 1 : 0;
    minAngle = dihedralRange({box.node, box.tetrahedron}).min * 180.0 / std::numbers::pi;
  }
  [[nodiscard]] SolidModel model(const std::vector<bool>& fixed) const {
    return {box.node, box.tetrahedron, fixed, {lameConstants(5e3, 0.45), 1060.0, 1.0, 0.02}};
  }
};

/// A patch test's answer does not depend on shape: slivers follow the linear field as all others.
TEST(Slivers, PassThePatchTest) {
  SCOPED_TRACE("seed 51");
  const SliverBox mesh(51);
  ASSERT_GE(mesh.slivers, 5);
  std::vector<bool> fixed(mesh.box.node.size(), true);
  for (int k = 1; k < mesh.box.nz; ++k) {
    for (int j = 1; j < mesh.box.ny; ++j) {
      for (int i = 1; i < mesh.box.nx; ++i) fixed[static_cast<std::size_t>(mesh.box.index(i, j, k))] = false;
    }
  }
  const SolidModel model = mesh.model(fixed);
  SolidState state = restState(model);
  Mat3 gradient;
  gradient << 1.0, 0.3, -0.2, 0.3, -0.5, 0.4, -0.2, 0.4, 0.8;
  gradient *= 1e-3;
  for (std::size_t n = 0; n < fixed.size(); ++n) {
    if (fixed[n]) state.position[n] += gradient * mesh.box.node[n];
  }
  test::settle(model, state, {});
  double worst = 0.0;
  double moved = 0.0;
  for (std::size_t n = 0; n < fixed.size(); ++n) {
    const Vec3 exact = gradient * mesh.box.node[n];
    worst = std::max(worst, (state.position[n] - mesh.box.node[n] - exact).norm());
    moved = std::max(moved, exact.norm());
  }
  std::printf("%d slivers, least angle %.3f degrees: off by %.1e of the largest displacement\n", mesh.slivers,
              mesh.minAngle, worst / moved);
  EXPECT_LT(worst, 2e-3 * moved);
}

/// Shaken, thrown and let go, they find back, and no step is silent about its solver.
TEST(Slivers, ShakenAndThrownComeBack) {
  SCOPED_TRACE("seed 52");
  const SliverBox mesh(52);
  ASSERT_GE(mesh.slivers, 5);
  const SolidModel model = mesh.model(mesh.box.firstFace());
  SolidState state = restState(model);
  Random random(53);
  for (int k = 0; k < 6; ++k) {
    const auto n = static_cast<std::size_t>(
        model.freeNodes()[random.next() % static_cast<std::uint32_t>(model.freeNodes().size())]);
    const double x = random.normal();
    const double y = random.normal();
    const double z = random.normal();
    state.position[n] += 2.0 * cell * Vec3(x, y, z).normalized();
  }
  SerialExecutor executor;
  SolidSolver solver;
  const SolidSolver::Settings settings;
  int missed = 0;
  std::uint32_t most = 0;
  for (int i = 0; i < 600; ++i) {
    const Vec3 gravity = i < 100 ? Vec3(i / 10 % 2 == 0 ? 30.0 : -30.0, -9.81, 0.0) : Vec3(Vec3::Zero());
    const SolveReport report = solver.solveUnconstrained(model, state, gravity, {}, settings, executor);
    EXPECT_EQ(report.converged, report.residual <= settings.tolerance) << "step " << i;
    missed += report.converged ? 0 : 1;
    most = std::max(most, report.iterations);
    ASSERT_TRUE(solver.advance(model, state, {}, settings.step)) << "step " << i;
  }
  std::printf("%d slivers: %d of 600 steps missed the tolerance, at most %u iterations; %.4f cells from rest\n",
              mesh.slivers, missed, most, test::maxDisplacement(model, state) / cell);
  ASSERT_TRUE(test::isFinite(state));
  EXPECT_EQ(test::invertedElements(model, state), 0);
  EXPECT_LT(test::maxDisplacement(model, state), 0.01 * cell);
}

}  // namespace
}  // namespace calot::slivers_test
