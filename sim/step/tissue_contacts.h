// SPDX-License-Identifier: GPL-3.0-or-later
// Contact points among organs, and of an organ with itself. Internal to this folder.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "sim/contact/near_triangles.h"
#include "sim/contact/surface_surface.h"
#include "sim/step/contact_block.h"
#include "sim/step/surfaces.h"

namespace calot {

/// Overlap that tissue is left (m): contacts stay closed in spite of rounding. Larger shows; smaller chatters.
/// Assumed.
inline constexpr double allowedOverlap = 2e-5;
/// By which overlapping tissue parts in one step (m). Larger throws it apart; smaller lets overlaps last. Assumed.
inline constexpr double maxRecovery = 0.0005;

/// True if the tissue at a vertex of an organ's skin is inverted. Outward is then inward there, and contact would
/// hold it so.
bool isInverted(const Model& model, const State& state, std::size_t organ, int vertex);

/// Keeps, among the blocks from `first` on, the `limit` smallest gaps, in their order. Where tissue is crumpled,
/// hundreds of its points are inside of it: more rows than its nodes can respond to. @param gap of those blocks, as
/// found (m)
void keepDeepest(std::size_t first, std::size_t limit, std::span<const double> gap, std::vector<ContactBlock>& blocks);

/// Vertices of one organ against triangles of another; wet tissue on wet tissue slides without friction, so blocks are
/// unilateral.
class TissueContacts {
 public:
  explicit TissueContacts(const Model& model);

  void invalidate();
  /// Computes ahead the tables of the reference configurations. Changes no result.
  void precompute();
  /// Adds blocks of organs that are awake, at most `maxTissueContacts`. @return deepest overlap beyond that at rest (m)
  /// @pre surfaces are current
  double run(Surfaces& surfaces, const State& state, const std::vector<bool>& awake, std::vector<ContactBlock>& blocks);

 private:
  const SurfacePair& restOf(std::size_t pair);
  const SurfaceDisplacement& displacementOf(const Surfaces& surfaces, std::size_t organ);
  double addPair(Surfaces& surfaces, const State& state, std::size_t number, std::vector<ContactBlock>& blocks);

  const Model& model_;
  std::vector<std::unique_ptr<const SurfacePair>> selfRest_;  ///< per organ; empty until it folds
  std::vector<NearTriangles> nearTriangles_;                  ///< per tissue pair
  std::vector<SurfaceDisplacement> displacement_;             ///< per organ
  std::vector<std::uint32_t> patches_;
  std::vector<Box> queries_;
  std::vector<BroadPhase::Pair> pairs_;
  std::vector<VertexContact> found_;
  std::vector<double> gap_;  ///< of the blocks among organs, as found (m)
};

}  // namespace calot
