// SPDX-License-Identifier: GPL-3.0-or-later
// Conjugate gradients with a lattice beside the sweeps. With A = L + D + L^T and K = D + L, an iteration is
//   z = K^-T D y + c,  p = z + beta p,  q = A p,  s = K^-1 q,  alpha = r.z / p.q,
//   x += alpha p,  r -= alpha q,  y -= alpha s,
// where y = K^-1 r is updated along with r, and c is the lattice's correction for r. The blocks are read twice: the
// backward sweep applies K^-T and forms half of A p; the forward sweep forms the other half and applies K^-1.
#include <algorithm>
#include <array>

#include "sim/solid/coarse_lattice.h"
#include "sim/solid/conjugate_gradient.h"
#include "sim/solid/row_lanes.h"
#include "sim/solid/row_sweeps.h"
#include "sim/solid/sweeps.h"

namespace calot {

/// q = b, s = K^-1 b.
void ConjugateGradient::beginPairs(const Part& part, bool goesOn) {
  const std::size_t size = part.matrix.vectorSize();
  for (std::vector<float>* v : {&q_, &c_}) v->assign(size, 0.0F);
  if (goesOn) {
    startFrom(left_);  // y goes with it
  } else {
    y_.assign(size, 0.0F);
  }
  for (std::vector<float>* v : {&uw_, &pq_}) v->assign(part.matrix.rows() * rows::pairStride, 0.0F);
  for (std::size_t row = 0; row < part.matrix.rows(); ++row) {
    for (std::size_t i = 0; i < 3; ++i) {
      uw_[row * rows::pairStride + rowStride + i] = part.b[laneOffset(row) + i * laneCount];
    }
  }
  static_cast<void>(forwardPairs(part));  // there is no p yet
}

void ConjugateGradient::backwardPairs(const Part& part, float beta) {
  std::fill(uw_.begin(), uw_.end(), 0.0F);
  sweeps::backwardPairs(slicesOf(part.matrix, part.values), z_.data(), c_.data(), beta, p_.data(), uw_.data(),
                        pq_.data());
  for (const ExtraBlock& e : extra_) {
    const float* p = pq_.data() + e.column * rows::pairStride;
    for (std::size_t i = 0; i < 3; ++i) {
      uw_[e.row * rows::pairStride + rowStride + i] +=
          (e.value[3 * i] * p[0] + e.value[3 * i + 1] * p[1]) + e.value[3 * i + 2] * p[2];
    }
  }
}

double ConjugateGradient::forwardPairs(const Part& part) {
  std::array<double, laneCount> dot{};
  sweeps::forwardPairs(slicesOf(part.matrix, part.values), p_.data(), uw_.data(), pq_.data(), q_.data(), s_.data(),
                       dot.data());
  return sumOf(dot);
}

double ConjugateGradient::updatePairs(const Part& part, float alpha) {
  std::array<double, laneCount> dot{};
  sweeps::updatePairs(slicesOf(part.matrix, part.values), alpha, p_.data(), q_.data(), s_.data(), part.x.data(),
                      r_.data(), y_.data(), z_.data(), dot.data());
  part.lattice->apply(r_.data(), c_.data());
  return sumOf(dot) + sweeps::dot(r_.data(), c_.data(), part.matrix.vectorSize());
}

}  // namespace calot
