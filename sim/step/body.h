// SPDX-License-Identifier: GPL-3.0-or-later
// Mechanics and skin of a body that can be touched, as the step sees them: an organ, vessels, fat. Internal to
// this folder.
//
// A body is solved as one system; a structure has a name and a skin. Vessels that grow out of one another are
// one body and several structures; everything else is one of each.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/contact/surface_patches.h"
#include "sim/scene/state.h"
#include "sim/solid/solid.h"

namespace calot {

/// A spring and a damper between a place of a body and one of another, linearised over a step, implicit on the side of
/// the body that it is given to.
struct TieLoad {
  MaterialPoint place;
  double stiffness = 0.0;        ///< N/m
  double damping = 0.0;          ///< N s/m
  Vec3 target = Vec3::Zero();    ///< where the other end is now (m)
  Vec3 velocity = Vec3::Zero();  ///< at which it moves in this step, as far as that is known (m/s)
};

class Body {
 public:
  Body() = default;
  Body(const Body&) = delete;
  Body& operator=(const Body&) = delete;
  virtual ~Body() = default;

  [[nodiscard]] virtual std::size_t nodes() const = 0;
  [[nodiscard]] virtual std::span<const Vec3> position(const State& state) const = 0;
  [[nodiscard]] virtual std::span<const Vec3> velocity(const State& state) const = 0;
  [[nodiscard]] virtual std::uint32_t& quietSteps(State& state) const = 0;

  /// Velocities that the step ends with, as far as they are known. @pre its free motion was solved
  [[nodiscard]] virtual std::span<const Vec3> freeVelocity() const = 0;
  /// Works out what block() needs for these nodes. @pre its free motion was solved
  virtual void precomputeCompliance(std::span<const int> nodes) = 0;
  /// Works out ahead, besides, what the first step would have to.
  virtual void precompute() {}
  /// The compliance on which contact is decided: velocity of node a for an impulse on node b is about
  /// rotation(a) block(a, b) rotation(b)^T.
  [[nodiscard]] virtual Mat3 rotation(const State& state, int node) const = 0;
  [[nodiscard]] virtual Mat3 block(int a, int b) const = 0;
  /// block() of some nodes and others, row-major, at 9 (i b.size() + j). @param out as many numbers or more
  virtual void blocks(std::span<const int> a, std::span<const int> b, std::span<double> out) const;
  /// Goes where the step leads. @return false when some node had to be stopped
  virtual bool advance(State& state) = 0;
  /// The largest speed that the last advance() held back, for no tissue moves as fast (m/s); 0: none.
  [[nodiscard]] virtual double heldBack() const = 0;
  /// Stops it, to sleep.
  virtual void stop(State& state) const = 0;
};

inline void Body::blocks(std::span<const int> a, std::span<const int> b, std::span<double> out) const {
  for (std::size_t i = 0; i < a.size(); ++i) {
    for (std::size_t j = 0; j < b.size(); ++j) {
      const Mat3 own = block(a[i], b[j]);
      for (std::size_t k = 0; k < 9; ++k) {
        out[9 * (i * b.size() + j) + k] = own(static_cast<int>(k / 3), static_cast<int>(k % 3));
      }
    }
  }
}

class Skin {
 public:
  Skin() = default;
  Skin(const Skin&) = delete;
  Skin& operator=(const Skin&) = delete;
  virtual ~Skin() = default;

  /// Adopts the state's topology. @return true if it differs from the last call's
  virtual bool follow(const State& state) = 0;
  /// @pre follow(), as for all that comes
  [[nodiscard]] virtual const ContactSurface& surface() const = 0;
  /// Positions of its vertices (m).
  virtual void place(const State& state, std::vector<Vec3>& out) const = 0;
  /// True if this vertex exists now.
  [[nodiscard]] virtual bool exists(int /*node*/) const { return true; }
  /// A place on the skin in terms of the body's nodes.
  [[nodiscard]] virtual SolidSolver::Impulse influence(const std::array<int, 3>& corner, const Vec3& weight) const = 0;
};

/// Adds a share of a node to a place that may have it already. @pre it has room
inline void addShare(SolidSolver::Impulse& place, int node, double share) {
  if (share == 0.0) return;
  std::size_t k = 0;
  while (k < place.count && place.node[k] != node) ++k;
  if (k == place.count) place.node[place.count++] = node;
  place.weight[k] += share;
}

}  // namespace calot
