// SPDX-License-Identifier: GPL-3.0-or-later
// A body as the inside (value < 0) of a potential field on a lattice: the original, the changes and a working copy.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sim/carving/brick_bits.h"
#include "sim/geometry/brick_lattice.h"

namespace calot {

/// The uncarved field: signed distance in the reference configuration (m), clamped to +-band, outside on the lattice's
/// border. Part of Model.
struct FieldModel {
  BrickLattice lattice;
  double band = 0.0;          ///< m
  std::vector<double> value;  ///< m, by BrickLattice::node()

  /// Error that makes it unusable: wrong sizes, values that are not finite or beyond the band, inside on
  /// the border. Empty: none.
  [[nodiscard]] std::string fault() const;
};

/// Changes by carving, which are part of State: whole bricks in the order of their first change (ascending within one
/// stroke), so that a stroke moves no memory.
struct CarvedBricks {
  using Values = std::array<double, BrickLattice::brickNodes>;

  std::vector<std::uint32_t> brick;
  std::vector<Values> value;  ///< m

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("brick", self.brick);
    visit("value", self.value);
  }
};

/// The dense field with the inside as bits. Derived from FieldModel and CarvedBricks; never saved. All changes are made
/// in a stroke: begin(), writes, commit(). Allocates only in its constructor; commit() may grow CarvedBricks unless
/// reserve() reserved its capacity.
class CarvedField {
 public:
  /// @pre model.fault() is empty; the model outlives the field
  explicit CarvedField(const FieldModel& model);

  /// The field after a restore. @return false (and the uncarved field) if the bricks are invalid: out of range,
  /// repeated, sizes that differ, values not finite or beyond the band, inside on the border or in the padding.
  [[nodiscard]] bool restore(const CarvedBricks& bricks);

  [[nodiscard]] const FieldModel& model() const { return *model_; }
  [[nodiscard]] const BrickLattice& lattice() const { return model_->lattice; }
  [[nodiscard]] double band() const { return model_->band; }
  [[nodiscard]] const std::vector<double>& values() const { return value_; }
  [[nodiscard]] double value(std::uint32_t node) const { return value_[node]; }
  [[nodiscard]] bool inside(std::uint32_t node) const {
    return testBit(inside_[node / BrickLattice::brickNodes], node % BrickLattice::brickNodes);
  }
  /// Inside nodes of a brick.
  [[nodiscard]] const BrickBits& bits(std::uint32_t brick) const { return inside_[brick]; }

  /// Starts a stroke: clears the list of changes.
  void begin();
  /// Raises nodes of one row of a brick (starting at `first`) to `candidate` where that is higher, at most to the band.
  void raiseRow(std::uint32_t first, std::span<const double> candidate);
  /// Moves inside nodes of a brick outside: sets them to the band.
  void remove(std::uint32_t brick, const BrickBits& nodes);
  /// A stroke with a known result: the field becomes that of `bricks`, as after restore(), and changed() lists the
  /// changes. No commit() follows.
  /// @pre no brick is repeated
  /// @return false, without changes, if `bricks` is less carved anywhere or does not extend the bricks that led to the
  /// current field: then use restore()
  [[nodiscard]] bool raiseTo(const CarvedBricks& bricks);
  /// Ends a stroke: orders changed() and copies the changed bricks to State.
  void commit(CarvedBricks& bricks);
  /// Reserves the maximum capacity in State, so that no stroke allocates.
  void reserve(CarvedBricks& bricks) const;

  /// Bricks of this stroke with a changed value, ascending after commit().
  [[nodiscard]] std::span<const std::uint32_t> changed() const { return changed_; }
  /// Nodes of a brick whose value this stroke changed. @pre the brick is among changed()
  [[nodiscard]] const BrickBits& raised(std::uint32_t brick) const { return raised_[brick]; }
  /// Nodes of a brick that this stroke moved outside. @pre as above
  [[nodiscard]] BrickBits removed(std::uint32_t brick) const;

 private:
  void touch(std::uint32_t brick);
  void readBits(std::size_t brick);

  const FieldModel* model_;
  std::vector<double> value_;
  std::vector<BrickBits> inside_;
  std::vector<BrickBits> before_;
  std::vector<BrickBits> raised_;
  std::vector<std::uint8_t> touched_;
  std::vector<std::uint32_t> changed_;
  std::vector<std::int32_t> index_;  ///< per brick: its index in CarvedBricks; -1: none
};

}  // namespace calot
