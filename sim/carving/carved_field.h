// SPDX-License-Identifier: GPL-3.0-or-later
// A body as the inside (value < 0) of a potential field on a lattice: as it was, what has changed, and a working copy.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sim/carving/brick_bits.h"
#include "sim/geometry/brick_lattice.h"

namespace calot {

/// The uncarved field: a signed distance in rest space (m), clamped to +-band, outside on the lattice's border. Const:
/// part of a Model.
struct FieldModel {
  BrickLattice lattice;
  double band = 0.0;          ///< m
  std::vector<double> value;  ///< m, by BrickLattice::node()

  /// Why it cannot be carved: sizes, values that are not finite or beyond the band, inside on the border. Empty: it
  /// can.
  [[nodiscard]] std::string fault() const;
};

/// What carving has changed: the part of State. Whole bricks, in the order of their first change (ascending within one
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

/// The dense field with the inside as bits. Follows from FieldModel and CarvedBricks; never saved. All changes go
/// through a stroke: begin(), writes, commit(). Allocates in its constructor and nowhere else, but commit() may let
/// CarvedBricks grow up to the capacity that prepare() gives it at once.
class CarvedField {
 public:
  /// @pre model.fault() is empty; the model outlives the field
  explicit CarvedField(const FieldModel& model);

  /// The field after a restore. @return false (and the uncarved field) where the bricks are not the model's: out of
  /// range, twice, sizes that differ, values not finite or beyond the band, inside on the border or in the padding.
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

  /// Starts a stroke: forgets the changes of the last one.
  void begin();
  /// Raises nodes of one row of a brick (x from `first` on) to `candidate` where that is higher, at most to the band.
  void raiseRow(std::uint32_t first, std::span<const double> candidate);
  /// Makes inside nodes of a brick outside, as far as the band goes.
  void remove(std::uint32_t brick, const BrickBits& nodes);
  /// A stroke of which the outcome is known: the field becomes that of `bricks`, as restore() makes it, and changed()
  /// tells where. No commit() follows.
  /// @pre no brick is there twice
  /// @return false, and nothing is changed, where something is less carved in `bricks` than here, or they do not go on
  ///         from those that led here: then only restore() leads there
  [[nodiscard]] bool raiseTo(const CarvedBricks& bricks);
  /// Ends a stroke: orders changed() and copies the changed bricks to State.
  void commit(CarvedBricks& bricks);
  /// Gives State its largest capacity, so that no stroke has to.
  void prepare(CarvedBricks& bricks) const;

  /// Bricks of this stroke with a changed value, ascending after commit().
  [[nodiscard]] std::span<const std::uint32_t> changed() const { return changed_; }
  /// Nodes of a brick whose value this stroke changed. @pre the brick is among changed()
  [[nodiscard]] const BrickBits& raised(std::uint32_t brick) const { return raised_[brick]; }
  /// Nodes of a brick that this stroke put outside. @pre as above
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
  std::vector<std::int32_t> place_;  ///< of a brick in CarvedBricks; -1: not there
};

}  // namespace calot
