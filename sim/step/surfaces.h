// SPDX-License-Identifier: GPL-3.0-or-later
// Current skins of all structures, with bounds for the broad phase. Internal to this folder.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "sim/contact/broad_phase.h"
#include "sim/math/executor.h"
#include "sim/step/bodies.h"

namespace calot {

/// Edge of the broad phase's cells (m): about the size of an instrument's working end. Larger: more candidates for the
/// exact test; smaller: more cells to visit. Measured; changes no result.
inline constexpr double broadPhaseCell = 0.02;

/// Surface points and patch bounds of every structure at the State that refresh() saw last. A structure whose body
/// moved or changed its topology has to be marked; refresh() then updates that one alone.
class Surfaces {
 public:
  /// @param make makes one broad phase a structure; none: SortedGrid
  Surfaces(const Model& model, Bodies& bodies, MakeBroadPhase make, Executor& executor);

  /// To be called when the State was replaced.
  void invalidate();
  void refresh(const State& state);
  /// The structure's surface is not that of the last refresh() any more.
  void markStale(std::size_t structure) { current_[structure] = 0; }
  void markBodyStale(std::size_t body);
  [[nodiscard]] bool isCurrent(std::size_t structure) const { return current_[structure] != 0; }

  [[nodiscard]] std::size_t size() const { return skin_.size(); }
  [[nodiscard]] const Skin& skin(std::size_t structure) const { return *skin_[structure]; }
  [[nodiscard]] const ContactSurface& mesh(std::size_t structure) const { return skin_[structure]->surface(); }
  /// Vertices of its mesh (m, W). @pre isCurrent()
  [[nodiscard]] const std::vector<Vec3>& points(std::size_t structure) const { return points_[structure]; }
  /// Bounds of its patches (m, W). @pre isCurrent()
  [[nodiscard]] const std::vector<Box>& bounds(std::size_t structure) const { return bounds_[structure]; }
  [[nodiscard]] const BroadPhase& broadPhase(std::size_t structure) const { return *broad_[structure]; }

  /// Memory of a search, of whoever searches.
  struct Search {
    std::vector<BroadPhase::Pair> pair;
    std::vector<std::uint32_t> near;
  };
  /// Patches with everything that a structure has no farther than `far` from a segment (a conservative superset),
  /// ascending. Valid until the next search with the same memory. @pre isCurrent()
  std::span<const std::uint32_t> patchesNear(std::size_t structure, const Vec3& p0, const Vec3& p1, double far,
                                             Search& search) const;

 private:
  void refresh(const State& state, std::size_t structure);

  const Model& model_;
  Executor& executor_;
  std::vector<std::unique_ptr<Skin>> skin_;
  std::vector<std::unique_ptr<BroadPhase>> broad_;
  std::vector<std::vector<Vec3>> points_;
  std::vector<std::vector<Box>> bounds_;
  std::vector<std::uint8_t> current_;
  std::vector<std::uint8_t> refittable_;  ///< does the broad phase hold earlier bounds of the same patches?
  std::vector<std::vector<Box>> earlierBounds_;
  std::vector<std::vector<std::uint32_t>> changed_;
  std::vector<std::size_t> stale_;
};

}  // namespace calot
