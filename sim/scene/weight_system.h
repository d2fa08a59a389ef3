// SPDX-License-Identifier: GPL-3.0-or-later
// Equilibrium of a scene's weight in the reference configuration. Internal to this folder.
//
// A scene is drawn as it is in the body, under gravity g: there every force is to be in equilibrium. The law of all
// tissue is linear about that reference configuration, so the inverse problem is linear too: with K the stiffness of
// organs, fat, vessels, ties and strands in the reference configuration, all of them as one system, and M their masses,
//   K x = M g,
// and what each element, tie and strand carries is its own part of K x, kept as a load of its own. To first order the
// configuration that is free of stress lies at -x from the reference configuration (the first step of Sellier's fixed
// point; the rest moves the configuration that is free of stress and leaves the equilibrium as it is).
//
// Tissue that grows on a sagging organ bears its own weight and not the organ's. So in K the bearing part is stiffer
// than what it bears, by `bearing` a rank: fat, then vessels and organs that nothing anchors, then anchored organs; a
// joint counts as the softer of what it joins. Any such K balances the weight; without ranks, fat between liver and
// gallbladder would hold up the liver, with strains above one.
//
// Strands count with their stiffness in all directions, not only along them: what holds a bed carries shear too.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "sim/math/linear.h"
#include "sim/math/symmetric_blocks.h"
#include "sim/solid/solid.h"

namespace calot {

class Model;

/// x, by bodies (Model::bodies()).
struct WeightMotion {
  std::vector<std::vector<Vec3>> displacement;  ///< per node (m)
  std::vector<std::vector<Vec3>> rotation;      ///< per node of vessels (rad)
  std::vector<double> stiffening;               ///< of each body in K; a joint has the lesser of its two bodies'
  /// Per body: is it, with all that ties and strands join to it, held? If not, x is zero, and it falls.
  std::vector<bool> held;
};

/// Solves for x, each group of bodies that ties and strands join as a system of its own.
WeightMotion motionUnderWeight(const Model& model);

// The stiffness of solids and of springs in the reference configuration, in double.

/// Adds a solid's stiffness K (N/m) at rest.
/// @param fill remaining share of each cube; empty: all full
/// @param factor of all of it
/// @param row per node: its row of the matrix; -1: fixed
void addStiffness(const SolidModel& model, std::span<const double> fill, double factor, std::span<const int> row,
                  SymmetricBlocks& matrix);

/// A material point and the rows of its solid's nodes.
struct PlacedPoint {
  const MaterialPoint& point;
  std::span<const int> row;
};

/// Adds a spring between two points that has the same stiffness in all directions (N/m).
void addSpring(const PlacedPoint& a, const PlacedPoint& b, double stiffness, SymmetricBlocks& matrix);

}  // namespace calot
