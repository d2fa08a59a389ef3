// SPDX-License-Identifier: GPL-3.0-or-later
// What couples the linear systems of solids beside their own matrices.
#pragma once

namespace calot {

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
