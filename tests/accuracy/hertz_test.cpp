// SPDX-License-Identifier: GPL-3.0-or-later
// Hertz: a rigid sphere pressed by d into an elastic half-space feels
//   F = 4/3 E / (1 - nu^2) sqrt(R) d^(3/2)        (Johnson 1985, "Contact mechanics", 4.22)
// The half-space is a block whose mesh is finest under the sphere, held at its far sides.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <vector>

#include "sim/contact/capsule_contact.h"
#include "sim/contact/contact_solver.h"
#include "sim/solid/solid.h"
#include "tests/accuracy/support/kuhn_box.h"

namespace calot::hertz_test {
namespace {

constexpr double young = 10e3;  // Pa
constexpr double poisson = 0.3;
constexpr double radius = 0.010;   // m
constexpr double halfSize = 0.08;  // m; the block's depth too: twenty times the radius of contact

/// Outward faces that belong to one tetrahedron only.
std::vector<Index3> boundary(const std::vector<Index4>& tetrahedra) {
  std::map<std::array<int, 3>, Index3> open;
  for (const Index4& t : tetrahedra) {
    for (const std::array<int, 3>& f :
         {std::array{1, 2, 3}, std::array{0, 3, 2}, std::array{0, 1, 3}, std::array{0, 2, 1}}) {
      const Index3 face(t[f[0]], t[f[1]], t[f[2]]);
      std::array<int, 3> key{face[0], face[1], face[2]};
      std::sort(key.begin(), key.end());
      if (open.erase(key) == 0) open.emplace(key, face);
    }
  }
  std::vector<Index3> out;
  for (const auto& [key, face] : open) out.push_back(face);
  return out;
}

struct Indentation {
  double force = 0.0;  ///< N
  std::size_t contacts = 0;
  double deepest = 0.0;  ///< of a contact after the last step (m)
};

/// Presses the sphere `depth` deep and waits until all is still. @param cells along each side; @param fineness size of
/// the cells under the sphere (m)
Indentation press(int cells, double fineness, double depth) {
  test::KuhnBox box = test::kuhnBox(2 * cells, 2 * cells, cells, Vec3(-1.0, -1.0, -1.0), Vec3(1.0, 1.0, 0.0));
  // s in [0, 1] -> distance: cells of `fineness` at first, then larger and larger.
  const double linear = fineness * cells;
  const auto graded = [&](double s) { return linear * s + (halfSize - linear) * s * s * s; };
  for (Vec3& p : box.node) {
    for (int a = 0; a < 3; ++a) p[a] = p[a] < 0.0 ? -graded(-p[a]) : graded(p[a]);
  }
  std::vector<bool> fixed;
  for (const Vec3& p : box.node) {
    fixed.push_back(p[2] < -halfSize + 1e-9 || std::max(std::abs(p[0]), std::abs(p[1])) > halfSize - 1e-9);
  }
  const SolidModel model(box.node, box.tetrahedron, fixed, {lameConstants(young, poisson), 1000.0, 0.0, 2.0});
  const ContactSurface surface(box.node, boundary(box.tetrahedron));
  std::vector<std::uint32_t> all(surface.patches().size());
  for (std::uint32_t p = 0; p < all.size(); ++p) all[p] = p;
  SolidState state = restState(model);
  SolidSolver solver;
  SerialExecutor executor;
  // Steps long enough that inertia is nothing: what is reached is the balance. Damping of twice the step lets the
  // places of contact settle.
  SolidSolver::Settings settings{1.0, 1e-4, 3000, 3};
  ContactSolver contactSolver;
  Indentation out;
  for (int step = 0; step < 18; ++step) {
    const double down = depth * std::min(1.0, (step + 1) / 4.0);
    const Vec3 centre(1e-5, 2e-5, radius - down);
    solver.solveUnconstrained(model, state, Vec3::Zero(), {}, settings, executor);
    std::vector<SurfaceContact> found;
    capsuleContacts(surface, state.position, all, centre, centre, radius, 0.3 * fineness, 0, found);
    const std::size_t n = found.size();
    std::vector<std::vector<Vec3>> response;
    std::vector<double> free;
    for (std::size_t first = 0; first < n; first += laneCount) {
      std::vector<SolidSolver::Impulse> impulses;
      for (std::size_t k = first; k < std::min(n, first + laneCount); ++k) {
        SolidSolver::Impulse impulse;
        for (std::size_t c = 0; c < 3; ++c) {
          impulse.node[c] = found[k].node[c];
          impulse.weight[c] = found[k].weight[static_cast<int>(c)];
        }
        impulse.count = 3;
        impulse.impulse = found[k].normal;
        impulses.push_back(impulse);
      }
      std::vector<std::vector<Vec3>> batch;
      solver.responses(model, impulses, settings, batch);
      for (std::vector<Vec3>& one : batch) response.push_back(std::move(one));
    }
    const auto along = [&](const SurfaceContact& c, const std::vector<Vec3>& field) {
      double sum = 0.0;
      for (std::size_t k = 0; k < 3; ++k) {
        sum += c.weight[static_cast<int>(k)] * c.normal.dot(field[static_cast<std::size_t>(c.node[k])]);
      }
      return sum;
    };
    std::vector<double> w(n * n);
    for (std::size_t i = 0; i < n; ++i) {
      free.push_back(found[i].gap - settings.step * along(found[i], solver.freeVelocity()));
      for (std::size_t j = 0; j < n; ++j) {
        w[i * n + j] =
            0.5 * settings.step * settings.step * (along(found[i], response[j]) + along(found[j], response[i]));
      }
    }
    for (std::size_t i = 0; i < n; ++i) w[i * n + i] *= 1.0 + 1e-6;
    const std::vector<BlockKind> kind(n, BlockKind::unilateral);
    const std::vector<double> none(n, 0.0);
    std::vector<double> lambda(n, 0.0);
    std::vector<double> gap(n, 0.0);
    const ContactReport report = contactSolver.solve({kind, none, w, free}, lambda, gap, 1e-9, 1000);
    EXPECT_TRUE(report.converged) << report.residual;
    std::vector<Vec3> correction(model.nodes(), Vec3::Zero());
    out = {};
    for (std::size_t i = 0; i < n; ++i) {
      out.force += lambda[i] * found[i].normal[2];
      out.contacts += lambda[i] > 1e-6 ? 1 : 0;
      for (std::size_t v = 0; v < model.nodes(); ++v) correction[v] -= settings.step * lambda[i] * response[i][v];
    }
    solver.advance(model, state, correction, settings.step);
  }
  for (const Vec3& p : state.position) {
    out.deepest = std::max(out.deepest, radius - (p - Vec3(1e-5, 2e-5, radius - depth)).norm());
  }
  return out;
}

double hertz(double depth) {
  return 4.0 / 3.0 * young / (1.0 - poisson * poisson) * std::sqrt(radius) * depth * std::sqrt(depth);
}

TEST(Hertz, ForceOverDepthFinerAndFiner) {
  constexpr double depth = 0.0015;  // contact radius sqrt(R d) = 3.9 mm
  std::vector<double> off;
  for (const auto& [cells, fineness] : {std::pair{5, 0.003}, std::pair{7, 0.002}, std::pair{8, 0.0015}}) {
    const Indentation result = press(cells, fineness, depth);
    off.push_back(result.force / hertz(depth) - 1.0);
    std::printf("Hertz, cells of %.2f mm: %.4f N of %.4f N (%+.1f %%), %zu contacts, vertices %.3f mm deep\n",
                1e3 * fineness, result.force, hertz(depth), 100.0 * off.back(), result.contacts, 1e3 * result.deepest);
    EXPECT_GT(result.contacts, 2U);
  }
  // Displacement elements are too stiff, and the circle of contact is a few cells wide.
  EXPECT_LT(std::abs(off[2]), 0.40);
  EXPECT_LT(std::abs(off[1]), std::abs(off[0]));
  EXPECT_LT(std::abs(off[2]), std::abs(off[1]));
}

TEST(Hertz, ForceGrowsWithThePowerOfThreeHalves) {
  const double shallow = press(7, 0.0015, 0.001).force;
  const double deep = press(7, 0.0015, 0.002).force;
  const double exponent = std::log2(deep / shallow);
  std::printf("Hertz: exponent %.3f\n", exponent);
  EXPECT_NEAR(exponent, 1.5, 0.12);
}

}  // namespace
}  // namespace calot::hertz_test
