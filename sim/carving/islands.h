// SPDX-License-Identifier: GPL-3.0-or-later
// Islands: what carving has cut loose from everything that holds it.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "sim/carving/brick_bits.h"
#include "sim/carving/carved_field.h"

namespace calot {

/// Inside nodes hang together along lattice edges (six neighbours), as they do in the polygons (cube_table.h). What
/// does not hang together with an inside anchor node is an island. Components are kept brick by brick, and a graph of
/// bricks is searched: a stroke labels the bricks anew in which nodes left, and no others; where none of these bricks
/// fell into parts, lost a link to a neighbour or its last anchor, nothing can have come loose and no search is made.
/// Equal to a full flood.
///
/// Follows from the field alone; never saved. Allocates in its constructor only.
class Islands {
 public:
  /// @param anchors nodes where the tissue is held, in any order; each within the lattice
  Islands(const BrickLattice& lattice, std::span<const std::uint32_t> anchors);

  /// Labels everything: at the start and after a restore.
  void rebuild(const CarvedField& field);

  /// Puts every island outside, within a stroke (before CarvedField::commit()). A field without an anchor left is
  /// removed whole. @return nodes removed; times cell^3 is their volume
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
  std::vector<std::int32_t> anchorOf_;  ///< of a brick, into anchor_; -1: none
  std::vector<std::uint8_t> held_;      ///< does a brick have an inside anchor?
  std::vector<std::uint16_t> count_;    ///< components of each brick
  std::vector<std::uint8_t> link_;      ///< bit a: whole bricks hang together with the next along axis a
  std::vector<std::uint8_t> label_;     ///< of each node, where its brick has several components
  std::vector<std::uint32_t> base_;     ///< number of a brick's first component
  std::vector<std::uint32_t> parent_;
  std::vector<std::uint8_t> anchored_;
  std::vector<std::uint32_t> work_;
  bool searched_ = false;  ///< since rebuild()
};

}  // namespace calot
