// SPDX-License-Identifier: GPL-3.0-or-later
// Vessels as the fat around them feels them: eliminated from the linear system of both. Internal to this folder.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "sim/math/vectors.h"
#include "sim/solid/conjugate_gradient.h"
#include "sim/step/solid_body.h"
#include "sim/step/tie_coupling.h"
#include "sim/step/vessel_body.h"
#include "sim/vessel/block_tree.h"

namespace calot {

/// The ties between a body of fat and a tree of vessels. With A_v the vessels' matrix (exactly factorised, with the
/// ties' dampers d = h k + c on its diagonal), N the nodes of the ties and P their places in the fat, what vessels
/// answer to fat is
///   -(h d P)^T N A_v^-1 N^T (h d P)
/// in the fat's matrix: the system of both, solved by elimination (a Schur complement). Each product with it costs one
/// pass over the vessels (TreeResponse). Vessels that are grown to an organ couple it to the fat besides
/// (TieCoupling::react()).
class VesselReaction final : public SystemCoupling {
 public:
  VesselReaction(const Model& model, std::size_t fat, std::size_t tree);

  [[nodiscard]] std::size_t fat() const { return fat_; }
  [[nodiscard]] std::size_t tree() const { return tree_; }
  /// True if there is any such tie.
  [[nodiscard]] bool exists() const { return !tie_.empty(); }
  /// True while any of them holds. @pre linearise() of this step
  [[nodiscard]] bool holds() const { return holds_; }

  /// Takes the ties as they are left. @param awake otherwise nothing of it holds
  void linearise(const State& state, bool awake, const FatMotion& fat, double step);
  /// @param grown how the vessels are grown to an organ, or null @param organ its system of this step
  /// @pre linearise(); the fat's system of this step is assembled, the vessels are solved
  void assemble(FatMotion& fat, VesselBody& vessel, TieCoupling* grown, const SolidSystem* organ);
  /// @param organ to which the vessels are grown; if to none, the fat again
  void addTo(ConjugateGradient& organ, ConjugateGradient& fat) override;

  /// Lets the vessels follow the fat. @pre the fat was solved
  void pull(const FatMotion& fat, VesselBody& vessel);
  /// The fat knows how the vessels move now.
  void see(const VesselBody& vessel);
  /// Adds the impulses on the fat's nodes by which it feels what vessels were pushed since. @pre see()
  void passOn(const FatMotion& fat, const VesselBody& vessel, std::vector<Vec3>& impulse);

 private:
  /// By how much a row of the fat's system takes part in the force on a node: h d w of one tie (kg).
  struct Share {
    std::size_t row;
    std::uint32_t node;
    double weight;
  };

  [[nodiscard]] std::size_t nodeOf(std::size_t i) const;
  [[nodiscard]] const MaterialPoint& placeOf(std::size_t i) const;
  void sumShares(const SolidSystem& fat, const TieCoupling* grown);
  void findReach(const VesselBody& vessel);
  void addGrown(ConjugateGradient& organ);

  const Model& model_;
  std::size_t fat_, tree_;
  std::vector<std::size_t> tie_;  ///< of the model
  bool holds_ = false;
  std::vector<double> weight_;    ///< h d (kg)
  std::vector<Vec3> fatSeen_;     ///< velocity at the tie that the vessels know of (m/s)
  std::vector<Vec3> vesselSeen_;  ///< per node: its velocity that the fat knows of (m/s)
  // h d P, summed over ties: by rows of the fat's system, then nodes.
  std::vector<std::size_t> row_, start_;  ///< rows; where their shares begin, and the end
  std::vector<std::uint32_t> node_;       ///< per share: number in `touched_`
  std::vector<float> shareOf_;            ///< per share (kg)
  std::vector<std::uint32_t> touched_;    ///< nodes with any share, and those grown to an organ, ascending
  std::vector<double> summed_;            ///< weights of which those are the sums
  std::uint64_t version_ = 0;             ///< of the fat's system for which they are
  TieCoupling* grown_ = nullptr;          ///< how they are grown to an organ, or null
  const SolidSystem* organ_ = nullptr;    ///< of that
  TreeResponse response_;
  std::vector<FourFloats> moved_;  ///< pushes, then answers, of `touched_`
  // Per tie of `grown_`: its node's index in `touched_`, or none; then the columns of the response of `touched_`.
  std::vector<std::uint32_t> held_;
  std::vector<FourFloats> reach_;
  std::vector<Vec3> heldResponse_, heldPush_;
  std::vector<Vec3> push_;  ///< of pull(), per node
};

}  // namespace calot
