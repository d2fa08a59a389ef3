// SPDX-License-Identifier: GPL-3.0-or-later
// Vessels that are grown to an organ, solved together with it. Internal to this folder.
//
// A tie of stiffness k and damping c between a place of the organ (velocity V) and a node of a vessel (velocity v)
// pulls the vessel, implicit on both sides, with
//   F = k g + d (V - v),    g the gap now, h the step, d = h k + c.
// With C the vessels' exact compliance at all tied nodes and v0 their velocity without ties, v = v0 + h C F, so
//   F = D (g k / d + V - v0),    D = (1 / d + h C)^-1:
// vessels move first, the organ then feels them as springs and dampers D that respond to one another (JointAttachment),
// and F is what the vessels are pushed with afterwards. That is the solution of the one linear system of organ and
// vessels: a force is the same on both sides, and implicit Euler's damping holds for the whole, however stiff the ties.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include "sim/math/linear.h"
#include "sim/scene/model.h"
#include "sim/step/body.h"
#include "sim/step/vessel_body.h"

namespace calot {

class TieCoupling {
 public:
  /// @param ties of Model::ties(), all between this organ and vessels, none of fat
  TieCoupling(const Model& model, std::size_t organ, std::vector<std::size_t> ties, double step);

  [[nodiscard]] std::size_t organ() const { return organ_; }
  [[nodiscard]] bool joins(std::size_t body) const;

  /// Gathers the vessels' contact-free velocities, and pulls them as if the organ went on as it did.
  /// @pre solveUnconstrained() of all vessels that it joins
  void begin(const State& state, std::span<const std::unique_ptr<Body>> body, std::span<VesselBody* const> vessels);
  /// Impulse on the organ. @pre begin()
  [[nodiscard]] const JointAttachment& joint() const { return joint_; }
  /// Pulls the vessels, with these velocities of the organ's nodes. @pre begin()
  void pull(std::span<const Vec3> organVelocity, std::span<VesselBody* const> vessels);
  [[nodiscard]] std::size_t size() const { return tie_.size(); }
  /// Node of the vessel's body at which a tie holds. @return -1: it holds another body
  [[nodiscard]] int nodeOf(std::size_t tie, std::size_t vessel) const {
    return vesselOf(tie) == vessel ? nodeOf(tie) : -1;
  }
  /// Product of the matrix of organ, vessels and further couplings with the present search direction: the impulses of
  /// the organ's ties on a vessel, and their reaction on the organ. @param vessel its body's number @param response the
  /// vessel's response to other impulses, without the ties, at the node of each tie @param push per tie @pre begin()
  void react(const SolidSystem& organ, ConjugateGradient& gradient, std::size_t vessel, std::span<const Vec3> response,
             std::vector<Vec3>& push);

  /// Impulses on the organ's nodes by which it feels what vessels were pushed since; holds these, with these velocities
  /// of the organ's nodes. Then the organ has to be pushed, and pull() called.
  void passOn(std::span<const Vec3> organVelocity, std::span<VesselBody* const> vessels, std::vector<Vec3>& impulse);

  /// Compliance used by the contact solver: (1 / d + h (C of vessels + C of the organ))^-1, on the organ's compliance
  /// of contact.
  /// @pre begin()
  void stiffen(const State& state, std::span<const std::unique_ptr<Body>> body);
  /// Relative velocities of all ties (organ minus vessel) for a unit impulse at a place of a body, weighted and rotated
  /// as Body::block() is to be. @pre stiffen()
  void responses(const Body& body, std::size_t which, const SolidSolver::Impulse& place, std::span<const Mat3> rotation,
                 std::vector<Mat3>& out) const;
  /// Impulses of the ties on the organ that responses() cause.
  void tieImpulses(std::span<const Mat3> responses, std::vector<Mat3>& out) const;
  /// Reduction, by the ties, of the velocity at one place for an impulse at another.
  /// @param responses at the one place @param tieImpulses for the other
  [[nodiscard]] Mat3 schurComplement(std::span<const Mat3> responses, std::span<const Mat3> tieImpulses) const;

  /// Forces on the vessels (N), by ties. @pre pull()
  [[nodiscard]] const std::vector<Vec3>& force() const { return force_; }

 private:
  [[nodiscard]] const Tie& tie(std::size_t i) const { return model_.ties()[tie_[i]]; }
  [[nodiscard]] std::size_t vesselOf(std::size_t i) const { return tie(i).body[1]; }
  [[nodiscard]] int nodeOf(std::size_t i) const { return tie(i).place[1].node[0]; }
  [[nodiscard]] Vec3 applied(std::size_t i, std::span<const Vec3> velocity) const;
  [[nodiscard]] const Vec3& velocityOf(std::size_t i, std::span<VesselBody* const> vessels) const;
  void gatherImpulses(std::span<VesselBody* const> vessels);
  void rigidity(std::span<const std::unique_ptr<Body>> body, std::vector<double>& out) const;

  const Model& model_;
  std::size_t organ_, organNodes_;
  std::vector<std::size_t> tie_;
  double step_;
  std::vector<int> organNode_;  ///< distinct nodes of the organ at the ties, ascending
  std::vector<double> inverse_, tight_;
  std::vector<Mat3> rotation_;  ///< of organNode_
  JointAttachment joint_;
  std::vector<Vec3> ahead_;       ///< g k / d (m/s)
  std::vector<Vec3> vesselSeen_;  ///< velocities that the organ knows of
  std::vector<Vec3> force_, change_, more_;
  std::vector<Vec3> impulse_;
};

}  // namespace calot
