// SPDX-License-Identifier: GPL-3.0-or-later
// Conjugate gradients preconditioned by a symmetric Gauss-Seidel sweep (Saad 2003, section 10.2) on BlockMatrix, at the
// cost of one matrix-vector product per iteration (Eisenstat 1981). With A = L + D + L^T + E, ordered by colour, the
// iteration runs on (D + L)^-1 A (D + L)^-T, applied to p by two sweeps over L:
//   t = (D + L)^-T p,   s = (D + L)^-1 (p - D t + E t),   result t + s.
// The backward sweep scatters to earlier rows, so that only L is stored. The start is always zero: State needs no
// warm start, and a binding iteration cap cannot make the error grow. Matrix and vectors are float; sums are
// double, in an order fixed by the matrix. Single-threaded: a sweep of a thousand rows takes less time than
// distributing its colours to threads, and the parts of a joined system as tasks gain nothing.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/math/vectors.h"
#include "sim/solid/block_matrix.h"

namespace calot {

class CoarseLattice;
class SystemCoupling;

namespace sweeps {
struct Slices;
}

struct SolveReport {
  std::uint32_t iterations = 0;
  /// |r| / |b| by the recursion, in the norm of the preconditioner's inverse, maximum over the right-hand sides; close
  /// to the relative error in the energy norm. If |b|^2 is below SolveGoal::from(), relative to the root of that.
  double residual = 0.0;
  bool converged = true;
};

/// Stopping criterion: |r| <= max(tolerance |b|, absolute), in the norm of SolveReport.
struct SolveGoal {
  double tolerance = 1e-4;
  std::uint32_t cap = 200;  ///< of iterations
  double absolute = 0.0;    ///< absolute tolerance (kg^1/2 m/s, for b in N s)
  bool goesOn = false;      ///< is what the last solve left open part of b? @pre the matrix is the same

  /// Square of the smallest |b| that the relative tolerance applies to.
  [[nodiscard]] double from() const { return absolute > 0.0 ? (absolute / tolerance) * (absolute / tolerance) : 0.0; }
};

class ConjugateGradient {
 public:
  /// Inverts the diagonal blocks.
  /// @param extra E, a few more blocks of the matrix; copied for the solves
  /// @pre the diagonal blocks are positive definite.
  void precompute(const BlockMatrix& matrix, std::span<const float> values, std::span<const ExtraBlock> extra = {});

  /// Solves A x = b to the given tolerance. Layout of b and x: BlockMatrix vectors.
  /// @pre precompute() was called with these values.
  SolveReport solve(const BlockMatrix& matrix, std::span<const float> values, std::span<const float> b,
                    std::span<float> x, const SolveGoal& goal);

  /// The same with a coarse lattice beside the sweeps. An iteration costs half a product more, but large solids need
  /// only a fraction of the iterations. The residual's norm is that of the combined preconditioner.
  SolveReport solve(const BlockMatrix& matrix, std::span<const float> values, CoarseLattice& lattice,
                    std::span<const float> b, std::span<float> x, const SolveGoal& goal);

  /// A part of a system of several parts: a matrix with its own sweeps, and a lattice if it has one.
  struct Part {
    ConjugateGradient& gradient;  ///< precompute() was called with this matrix
    const BlockMatrix& matrix;
    std::span<const float> values;
    CoarseLattice* lattice;  ///< or null
    std::span<const float> b;
    std::span<float> x;
  };
  /// A coupling between two parts, or within one: then both are the same.
  struct Coupled {
    std::size_t first, second;  ///< of the parts
    SystemCoupling& by;
  };

  /// Solves the system of all parts and their couplings as one: parts are preconditioned each by its own sweeps (and
  /// lattice), couplings are part of the product alone. Without couplings and of one part, this is solve().
  /// @pre the whole is positive definite
  static SolveReport solveJoined(std::span<const Part> parts, std::span<const Coupled> couplings,
                                 const SolveGoal& goal);

  /// Search direction of the present iteration at a row; the last number is zero.
  [[nodiscard]] FourFloats directionAt(std::size_t row) const {
    if (pairs_) {
      const float* p = pq_.data() + row * rows::pairStride;
      return FourFloats{p[0], p[1], p[2], 0.0F};
    }
    const float* t = t_.data() + laneOffset(row);
    return FourFloats{t[0], t[laneCount], t[2 * laneCount], 0.0F};
  }
  /// Adds to the product there what a coupling contributes. @param value its last number is zero
  void addToProduct(std::size_t row, const FourFloats& value) {
    rows::addTo(pairs_ ? uw_.data() + row * rows::pairStride + rowStride : u_.data() + row * rowStride, value);
  }

  /// Eight right-hand sides at once: component i of row r of vector k stands at 24 r + 8 i + k. Zero ones stay zero at
  /// no extra cost. The solution of one does not depend on the others.
  SolveReport solveMany(const BlockMatrix& matrix, std::span<const float> values, std::span<const float> b,
                        std::span<float> x, double tolerance, std::uint32_t cap);

 private:
  /// One iteration in pieces. The sums of forward() and update() over all parts are p.Ap and r.z of the whole.
  void begin(const Part& part, bool goesOn);
  void backward(const Part& part, float beta);
  [[nodiscard]] double forward(const Part& part);
  [[nodiscard]] double update(const Part& part, float alpha);
  // The same with a lattice: coarse_lattice.cpp.
  void beginPairs(const Part& part, bool goesOn);
  void backwardPairs(const Part& part, float beta);
  [[nodiscard]] double forwardPairs(const Part& part);
  [[nodiscard]] double updatePairs(const Part& part, float alpha);

  [[nodiscard]] static double sumOf(const std::array<double, laneCount>& lanes);
  /// Zeroes the work vectors.
  void clear(std::size_t size);
  void startFrom(const std::vector<float>& left);
  [[nodiscard]] sweeps::Slices slicesOf(const BlockMatrix& matrix, std::span<const float> values) const;
  void addExtraMany();

  std::vector<float> inverse_;  ///< 3x3 inverse diagonal blocks: per slice 9 x 8 lanes
  std::vector<ExtraBlock> extra_;
  std::vector<float> r_, z_, p_, t_, s_, left_;
  std::vector<float> u_, sRows_;            ///< by rows: u, and for a single right-hand side a copy of s
  std::vector<float> q_, y_, c_, uw_, pq_;  ///< with a lattice: coarse_lattice.cpp
  bool pairs_ = false;                      ///< does the present solve have a lattice?
};

// Coupling of the linear systems of several solids.

class ConjugateGradient;

class SystemCoupling {
 public:
  SystemCoupling() = default;
  SystemCoupling(const SystemCoupling&) = delete;
  SystemCoupling& operator=(const SystemCoupling&) = delete;
  virtual ~SystemCoupling() = default;

  /// Adds its part of the product with the present search directions, both ways; of one system, twice the same.
  virtual void addTo(ConjugateGradient& first, ConjugateGradient& second) = 0;
};

}  // namespace calot
