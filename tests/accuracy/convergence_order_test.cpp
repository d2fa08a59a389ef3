// SPDX-License-Identifier: GPL-3.0-or-later
// How fast the error falls with the mesh and with the step, against solutions in closed form.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <complex>
#include <cstdio>
#include <Eigen/Dense>
#include <numbers>
#include <vector>

#include "tests/accuracy/support/cube_box.h"
#include "tests/accuracy/support/kuhn_box.h"
#include "tests/accuracy/support/reference_element.h"
#include "tests/accuracy/support/settle.h"
#include "tests/bench/growth_exponent.h"

namespace calot::convergence_order_test {
namespace {

// ---- Mesh: a manufactured solution --------------------------------------------------------------------------------

constexpr double edge = 0.1;  // of the block (m)
constexpr double young = 5e3;

/// u = a sin(k x) sin(k y) sin(k z), k = pi / edge, which is nothing on the whole boundary, and the body force that
/// holds it in linear elasticity: b = -(mu laplace u + (lambda + mu) grad div u) (N/m^3).
struct Manufactured {
  LameConstants lame;
  Vec3 a = 1e-5 * edge * Vec3(1.0, -0.5, 0.7);  // rotations enter at the square of the strain
  static constexpr double k = std::numbers::pi / edge;

  [[nodiscard]] Vec3 displacement(const Vec3& p) const {
    return std::sin(k * p[0]) * std::sin(k * p[1]) * std::sin(k * p[2]) * a;
  }
  [[nodiscard]] Vec3 force(const Vec3& p) const {
    std::array<double, 3> s{};
    std::array<double, 3> c{};
    for (std::size_t i = 0; i < 3; ++i) {
      s[i] = std::sin(k * p[static_cast<int>(i)]);
      c[i] = std::cos(k * p[static_cast<int>(i)]);
    }
    const double sss = s[0] * s[1] * s[2];
    Vec3 b;
    for (std::size_t i = 0; i < 3; ++i) {
      double gradient = -a[static_cast<int>(i)] * sss;
      for (std::size_t j = 0; j < 3; ++j) {
        if (j != i) gradient += a[static_cast<int>(j)] * c[i] * c[j] * s[3 - i - j];
      }
      const double laplace = -3.0 * a[static_cast<int>(i)] * sss;
      b[static_cast<int>(i)] = -k * k * (lame.mu * laplace + (lame.lambda + lame.mu) * gradient);
    }
    return b;
  }
};

/// Root mean square of the error over the nodes, relative to that of the displacement.
double errorOf(const SolidModel& model, const Manufactured& field) {
  std::vector<Vec3> external;
  for (std::size_t n = 0; n < model.nodes(); ++n) {
    external.emplace_back(model.mass()[n] / model.material().density * field.force(model.rest()[n]));
  }
  SolidState state = restState(model);
  EXPECT_LT(test::settle(model, state, {Vec3::Zero(), external, {}, 1.0, 3000, 1e-13}), 1e-13);
  double wrong = 0.0;
  double moved = 0.0;
  for (std::size_t n = 0; n < model.nodes(); ++n) {
    const Vec3 exact = field.displacement(model.rest()[n]);
    wrong += (state.position[n] - model.rest()[n] - exact).squaredNorm();
    moved += exact.squaredNorm();
  }
  return std::sqrt(wrong / moved);
}

template <class Box>
std::vector<bool> boundary(const Box& box) {
  std::vector<bool> on(box.node.size(), true);
  for (int k = 1; k < box.nz; ++k) {
    for (int j = 1; j < box.ny; ++j) {
      for (int i = 1; i < box.nx; ++i) on[static_cast<std::size_t>(box.index(i, j, k))] = false;
    }
  }
  return on;
}

double tetrahedraError(int cells, const LameConstants& lame) {
  const test::KuhnBox box = test::kuhnBox(cells, cells, cells, Vec3::Zero(), Vec3::Constant(edge));
  return errorOf({box.node, box.tetrahedron, boundary(box), {lame, 1000.0, 0.0, 0.0}}, {lame});
}

double cubesError(int cells, const LameConstants& lame) {
  const test::CubeBox box = test::cubeBox(cells, cells, cells, Vec3::Zero(), edge / cells);
  return errorOf({box.node, box.cube, box.edge, boundary(box), {lame, 1000.0, 0.0, 0.0}}, {lame});
}

/// Second order in the cell, as linear tetrahedra and trilinear cubes have it. Near incompressibility tetrahedra lock:
/// with nu = 0.49 these cells are not yet small enough to see their order, and cubes, whose dilatation is averaged, do
/// not notice.
TEST(ConvergenceOrder, Mesh) {
  for (const double poisson : {0.3, 0.45, 0.49}) {
    const LameConstants lame = lameConstants(young, poisson);
    std::vector<double> size;
    std::array<std::vector<double>, 2> error;
    for (const int cells : {4, 8, 16}) {
      size.push_back(edge / cells);
      error[0].push_back(tetrahedraError(cells, lame));
      error[1].push_back(cubesError(cells, lame));
    }
    for (const std::size_t which : {0U, 1U}) {
      const double order = bench::growthExponent(size, error[which]);
      std::printf("nu %.2f, %s: errors %.4f %.4f %.4f, order %.2f\n", poisson, which == 0 ? "tetrahedra" : "cubes",
                  error[which][0], error[which][1], error[which][2], order);
      const bool locks = which == 0 && poisson > 0.48;
      EXPECT_GT(order, locks ? 1.2 : 1.7) << poisson;
      EXPECT_LT(order, 2.3) << poisson;
      EXPECT_LT(error[which].back(), locks ? 0.04 : 0.025) << poisson;
    }
  }
}

// ---- Step: one mode of a held block -------------------------------------------------------------------------------

/// The slowest mode of a held block: its angular frequency and shape, from dense matrices of this file's own.
struct Mode {
  double frequency = 0.0;   ///< rad/s
  std::vector<Vec3> shape;  ///< per node, the largest component 1
};

Mode slowestMode(const test::KuhnBox& box, const std::vector<bool>& fixed, const LameConstants& lame, double density) {
  const auto size = static_cast<Eigen::Index>(3 * box.node.size());
  Eigen::MatrixXd stiffness = Eigen::MatrixXd::Zero(size, size);
  Eigen::VectorXd mass = Eigen::VectorXd::Zero(size);
  for (const Index4& t : box.tetrahedron) {
    const test::ReferenceElement element(test::edgesOf(box.node, t));
    for (int i = 0; i < 4; ++i) {
      mass.segment<3>(3 * t[i]).array() += 0.25 * density * element.volume;
      for (int j = 0; j < 4; ++j) {
        stiffness.block<3, 3>(3 * t[i], 3 * t[j]) += element.stiffness(i, j, Mat3::Identity(), lame.lambda, lame.mu);
      }
    }
  }
  std::vector<Eigen::Index> free;
  for (Eigen::Index d = 0; d < size; ++d) {
    if (!fixed[static_cast<std::size_t>(d / 3)]) free.push_back(d);
  }
  const Eigen::MatrixXd k = stiffness(free, free);
  const Eigen::VectorXd root = mass(free).cwiseSqrt();
  const Eigen::MatrixXd scaled = root.cwiseInverse().asDiagonal() * k * root.cwiseInverse().asDiagonal();
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(scaled);
  const Eigen::VectorXd shape = eigen.eigenvectors().col(0).cwiseQuotient(root);
  Mode mode{std::sqrt(eigen.eigenvalues()[0]), std::vector<Vec3>(box.node.size(), Vec3::Zero())};
  for (std::size_t f = 0; f < free.size(); ++f) {
    mode.shape[static_cast<std::size_t>(free[f] / 3)][static_cast<int>(free[f] % 3)] =
        shape[static_cast<Eigen::Index>(f)] / shape.cwiseAbs().maxCoeff();
  }
  return mode;
}

/// A small swing in one mode is one damped oscillator, y'' = -w^2 y - (alpha + beta w^2) y'. Step by step it is that of
/// the scheme written for one number, and after a time it errs against the oscillator in proportion to the step.
TEST(ConvergenceOrder, Step) {
  const test::KuhnBox box = test::kuhnBox(4, 2, 2, Vec3::Zero(), Vec3(0.06, 0.03, 0.03));
  const std::vector<bool> fixed = box.firstFace();
  const SolidModel::Material material{lameConstants(young, 0.45), 1060.0, 0.5, 0.002};
  const SolidModel model(box.node, box.tetrahedron, fixed, material);
  const Mode mode = slowestMode(box, fixed, material.lame, material.density);
  const double square = mode.frequency * mode.frequency;
  const double alpha = material.massDamping;
  const double beta = material.stiffnessDamping;
  const double swung = 1e-6;  // m
  double along = 0.0;
  for (const Vec3& s : mode.shape) along += s.squaredNorm();
  constexpr double time = 0.16;
  const std::complex<double> root = -0.5 * (alpha + beta * square) +
                                    std::sqrt(std::complex<double>(0.25 * std::pow(alpha + beta * square, 2) - square));
  // y(0) = 1, y'(0) = 0: y = Re[(1 + i Re(r) / Im(r)) e^(r t)].
  const double exact = (std::complex<double>(1.0, root.real() / root.imag()) * std::exp(root * time)).real();
  ASSERT_GT(mode.frequency * time, std::numbers::pi) << "half a swing at least";
  std::vector<double> steps;
  std::vector<double> errors;
  for (const int count : {16, 32, 64, 128}) {
    const double h = time / count;
    SolidState state = restState(model);
    for (std::size_t n = 0; n < model.nodes(); ++n) state.position[n] += swung * mode.shape[n];
    SerialExecutor executor;
    SolidSolver solver;
    SolidSolver::Settings settings;
    settings.step = h;
    settings.tolerance = 1e-6;
    double y = 1.0;
    double v = 0.0;
    for (int i = 0; i < count; ++i) {
      ASSERT_TRUE(solver.solveUnconstrained(model, state, Vec3::Zero(), {}, settings, executor).converged);
      ASSERT_TRUE(solver.advance(model, state, {}, h));
      v += h * (-square * (y + (h + beta) * v) - alpha * v) / (1.0 + alpha * h + (h * h + beta * h) * square);
      y += h * v;
    }
    double found = 0.0;
    for (std::size_t n = 0; n < model.nodes(); ++n) {
      found += (state.position[n] - model.rest()[n]).dot(mode.shape[n]) / (swung * along);
    }
    EXPECT_NEAR(found, y, 3e-4) << "step " << h;
    steps.push_back(h);
    errors.push_back(std::abs(found - exact));
    std::printf("%.3g ms: amplitude %.5f, of one number %.5f, exact %.5f\n", 1e3 * h, found, y, exact);
  }
  const double order = bench::growthExponent(steps, errors);
  std::printf("mode of %.1f rad/s: order in the step %.2f\n", mode.frequency, order);
  EXPECT_NEAR(order, 1.0, 0.15);
}

}  // namespace
}  // namespace calot::convergence_order_test
