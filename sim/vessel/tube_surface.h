// SPDX-License-Identifier: GPL-3.0-or-later
// The outer surface of one branch, for contact and rendering: rings of vertices around the centre line, triangles
// between them and a cap at each end. Closed, manifold, outward.
//
// Its topology depends only on which elements are parted. A parting closes both stumps with a ring and a cap each;
// existing vertices and triangles keep their indices:
//   vertices   rings from start to end, `sides` each; the start's middle, the end's middle; then for each parted
//              element, in order: ring, middle, middle, ring at the parting (before, before, after, after)
//   triangles  2 sides between neighbouring rings (at a parting: up to the ring before it); start cap, end cap; then
//              for each parted element: 2 sides from the ring after it onward, cap before, cap after
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "sim/math/linear.h"
#include "sim/vessel/beam_state.h"

namespace calot {

class TubeSurface {
 public:
  struct Settings {
    std::size_t sides = 8;            ///< of a ring; at least 3
    std::size_t ringsPerElement = 1;  ///< 1: rings at the nodes
  };

  /// @param model outlives this. The surface of the whole branch.
  TubeSurface(const BeamModel& model, std::size_t branch, const Settings& settings);

  /// Adapts to the state's partings. @return true if the topology changed; only then it allocates.
  bool update(const BeamState& state);

  [[nodiscard]] std::size_t branch() const { return branch_; }
  [[nodiscard]] std::size_t vertices() const { return vertex_.size(); }
  [[nodiscard]] const std::vector<Index3>& triangles() const { return triangle_; }

  /// Positions of all vertices in W, pinched at clips. @pre update() with this state's partings
  void positions(const BeamState& state, std::vector<Vec3>& out) const;

  /// Nodes that a vertex depends on.
  [[nodiscard]] const BeamInfluence& influence(int vertex) const {
    return influence_[static_cast<std::size_t>(vertex)];
  }
  /// Point of the centre line to which a vertex belongs, for locating clips, cuts and contacts by arc length.
  [[nodiscard]] BeamPoint where(int vertex) const;

 private:
  static constexpr int middle = -1;
  struct Ring {
    BeamPoint where;
    Stump stump = Stump::none;
  };
  struct Vertex {
    int ring = 0;
    int side = middle;
  };

  void build();
  void layRings();
  [[nodiscard]] BeamPoint pointOn(std::size_t element, double share) const;
  int addRing(const Ring& ring);
  int addMiddle(int ring);
  void strip(int from, int to);
  void cap(int centre, int ring, bool atEnd);
  [[nodiscard]] int vertexOf(int ring, std::size_t side) const;

  const BeamModel& model_;
  std::size_t branch_;
  Settings settings_;
  std::vector<double> cosine_, sine_;  ///< of the sides' angles
  std::vector<Parting> parting_;       ///< of the branch's elements, for which this was built
  std::vector<double> partedAt_;       ///< and their parting positions
  std::vector<Ring> ring_;
  std::vector<int> firstVertex_;  ///< per ring
  std::vector<Vertex> vertex_;
  std::vector<BeamInfluence> influence_;
  std::vector<Index3> triangle_;
};

}  // namespace calot
