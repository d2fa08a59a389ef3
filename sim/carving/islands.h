// SPDX-License-Identifier: GPL-3.0-or-later
// Islands: parts that carving has separated from all anchors.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "sim/carving/carved_field.h"

namespace calot {

/// Inside nodes are connected along lattice edges (six neighbours), as in the polygons (cube_table.h). A component
/// without an inside anchor node is an island. Components are stored per brick and joined in a graph of bricks. A
/// stroke relabels only bricks that lost nodes; if none of these split, lost a link to a neighbour or lost its last
/// anchor, nothing can have come loose and the graph is not searched. The result equals that of a full flood fill.
///
/// Derived from the field alone; never saved. Allocates only in its constructor.
class Islands {
 public:
  /// @param anchors nodes at which the tissue is attached, in any order, each within the lattice
  Islands(const BrickLattice& lattice, std::span<const std::uint32_t> anchors);

  /// Labels everything: at the start and after a restore.
  void rebuild(const CarvedField& field);

  /// Removes every island, within a stroke (before CarvedField::commit()). A field without a remaining anchor is
  /// removed entirely. @return number of nodes removed; times cell^3 is their volume
  std::int64_t remove(CarvedField& field);

 private:
  void label(const CarvedField& field, std::uint32_t brick);
  void link(const CarvedField& field, std::uint32_t brick, int axis);
  bool relabel(const CarvedField& field, std::uint32_t brick);
  void joinComponents(const CarvedField& field);
  void markAnchored(const CarvedField& field);
  std::int64_t removeLoose(CarvedField& field);
  std::size_t component(std::uint32_t brick, std::uint32_t local) const;
  std::uint32_t root(std::size_t component);
  /// The brick before or after along an axis. @return false: there is none
  bool neighbour(std::uint32_t brick, int axis, int step, std::uint32_t& out) const;

  BrickLattice lattice_;
  std::vector<std::pair<std::uint32_t, BrickBits>> anchor_;
  std::vector<std::int32_t> anchorOf_;   ///< of a brick, into anchor_; -1: none
  std::vector<std::uint8_t> hasAnchor_;  ///< per brick: does it have an inside anchor?
  std::vector<std::uint16_t> count_;     ///< components of each brick
  std::vector<std::uint8_t> link_;       ///< bit a: the brick is connected to the next along axis a
  std::vector<std::uint8_t> label_;      ///< of each node, if its brick has several components
  std::vector<std::uint32_t> base_;      ///< number of a brick's first component
  std::vector<std::uint32_t> parent_;
  std::vector<std::uint8_t> anchored_;
  std::vector<std::uint32_t> work_;
  bool searched_ = false;  ///< since rebuild()
};

}  // namespace calot
