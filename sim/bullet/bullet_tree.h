// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "sim/contact/broad_phase.h"

namespace calot {

/// Bullet's dynamic bounding-volume tree (btDbvt, single precision) as a broad phase.
///
/// Leaves and queries are rounded outward to float before Bullet sees them, so what it finds is a superset; that is
/// then held against the boxes in double and sorted. No number of Bullet's leaves this class. Boxes with a coordinate
/// beyond 1e9 m, where float arithmetic on bounds could overflow, are kept out of the tree and asked one by one.
class BulletTree final : public BroadPhase {
 public:
  BulletTree();
  ~BulletTree() override;
  /// For StepperServices.
  static std::unique_ptr<BroadPhase> make() { return std::make_unique<BulletTree>(); }
  BulletTree(const BulletTree&) = delete;
  BulletTree& operator=(const BulletTree&) = delete;

  void update(std::span<const Box> leaves) override;
  void refit(std::span<const Box> leaves, std::span<const std::uint32_t> changed) override;
  void pairs(std::span<const Box> queries, std::vector<Pair>& out) const override;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

}  // namespace calot
