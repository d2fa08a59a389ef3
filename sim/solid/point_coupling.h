// SPDX-License-Identifier: GPL-3.0-or-later
// Isotropic dampers between points of two solids, in the matrix of both as one system: the blocks beside the solids'
// own matrices,
//   A_pq = -h sum of c_s w_sp w_sq I   over the dampers s, for node p of the first solid and q of the second.
// Each damper also enters the solids' own matrices, as an Attachment.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/math/vectors.h"
#include "sim/solid/conjugate_gradient.h"
#include "sim/solid/solid.h"

namespace calot {

class PointCoupling final : public SystemCoupling {
 public:
  /// Structure of the blocks. @param first, second the systems of the solids' steps @param points per damper: in the
  /// first solid, in the second
  PointCoupling(const SolidSystem& first, const SolidSystem& second,
                std::span<const std::array<MaterialPoint, 2>> points);

  /// Values of a step. @param damper per damper (N s/m) @param step h (s)
  void assemble(std::span<const double> damper, double step);

  /// Adds the blocks' part of the product with the present search directions, both ways.
  void addTo(ConjugateGradient& first, ConjugateGradient& second) override;

 private:
  /// Rows of one solid that any block has, with direction and product.
  struct Side {
    std::vector<std::size_t> row;  ///< ascending
    std::vector<FourFloats> direction, product;

    void gather(const ConjugateGradient& from);
    void scatter(ConjugateGradient& to) const;
  };
  /// Share of a damper in a block.
  struct Share {
    std::uint32_t block;
    float weight;
  };

  Side side_[2];
  std::vector<std::uint32_t> first_;   ///< per row of the first solid: its first block; and the end
  std::vector<std::uint32_t> column_;  ///< per block: number of the row of the second solid
  std::vector<float> value_;           ///< per block
  std::vector<Share> share_;           ///< by dampers
  std::vector<std::uint32_t> start_;   ///< per damper: its first share; and the end
};

}  // namespace calot
