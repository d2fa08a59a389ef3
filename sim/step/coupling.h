// SPDX-License-Identifier: GPL-3.0-or-later
// Couplings of bodies. Internal to this folder.
//
// Organs and fat that hold together are solved as one linear system: strands and ties add to each one's own matrix on
// the diagonal and couple them beside it (PointCoupling); vessels are eliminated, those in fat (VesselsInFat) and those
// that are grown to an organ (GrownVessels). That is implicit Euler of the whole, with forces that are equal and
// opposite. Ties that are springs on both sides are loads alone (Bodies::springsOf()).
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "sim/connective/connective_tissue.h"
#include "sim/math/linear.h"
#include "sim/math/vectors.h"
#include "sim/scene/model.h"
#include "sim/solid/conjugate_gradient.h"
#include "sim/solid/solid.h"
#include "sim/step/body.h"
#include "sim/vessel/beam_solver.h"

namespace calot {

/// Holds two bodies together that conjugate gradients solve, or one of them and vessels. In every step
/// linearise(), load() of both, assemble(); then, for each solve, passOn() of both if it is one of impulses, the
/// solve with system(), follow(), see().
class Coupling {
 public:
  /// @param first, second organs or bodies of fat, by their numbers among all bodies; of one, twice the same
  Coupling(std::size_t first, std::size_t second) : body_{first, second} {}
  Coupling(const Coupling&) = delete;
  Coupling& operator=(const Coupling&) = delete;
  virtual ~Coupling() = default;

  [[nodiscard]] const std::array<std::size_t, 2>& bodies() const { return body_; }
  /// True while anything of it holds. @pre linearise()
  [[nodiscard]] bool holds() const { return holds_; }

  /// Takes it over the step as State has it. What holds together is awake together. @param awake per body
  /// @pre vessels that are awake are solved
  void linearise(const State& state, const std::vector<bool>& awake) { holds_ = awake[body_[1]] && takeState(state); }
  /// Appends the loads by which a body's own matrix feels it. @pre linearise()
  virtual void load(std::size_t /*body*/, std::vector<Attachment>& /*attachments*/,
                    std::vector<JointAttachment>& /*joints*/) const {}
  /// Works out system(). @pre holds(); the systems of both are those of this step
  virtual void assemble() {}
  /// Its part of the system of both; null: the loads are all of it. @pre assemble()
  [[nodiscard]] virtual SystemCoupling* system() { return nullptr; }
  /// Adds the impulses on a body's nodes by which it feels what its vessels were pushed since (N s).
  virtual void passOn(std::size_t /*body*/, std::vector<Vec3>& /*impulse*/) {}
  /// Lets its vessels follow. @pre both were solved
  virtual void follow() {}
  /// Both know how its vessels move now. @pre follow() of all
  virtual void see() {}

 private:
  /// @return true if anything of it holds
  virtual bool takeState(const State& state) = 0;

  std::array<std::size_t, 2> body_;
  bool holds_ = false;
};

/// The strands of a connective tissue, between two organs.
class StrandCoupling final : public Coupling {
 public:
  /// @param tissue of Model::connective()
  StrandCoupling(const Model& model, std::size_t tissue, double step);

  void load(std::size_t body, std::vector<Attachment>& attachments,
            std::vector<JointAttachment>& joints) const override;
  void assemble() override { coupling_->assemble(loads_.damper, step_); }
  [[nodiscard]] SystemCoupling* system() override { return coupling_.get(); }

 private:
  bool takeState(const State& state) override;

  const ConnectiveModel& model_;
  std::size_t tissue_;
  double step_;
  std::unique_ptr<PointCoupling> coupling_;
  ConnectiveLoads loads_;
};

/// The ties between an organ and a body of fat.
class FatTies final : public Coupling {
 public:
  /// @param ties of Model::ties(), all between these @param body the fat's number among all bodies
  FatTies(const Model& model, std::size_t organ, std::size_t body, std::vector<std::size_t> ties, double step,
          OrganBody& organBody, FatMotion& fat);

  void assemble() override;
  [[nodiscard]] SystemCoupling* system() override { return coupling_.get(); }

 private:
  bool takeState(const State& state) override;

  const Model& model_;
  std::vector<std::size_t> tie_;
  double step_;
  OrganBody& organ_;
  FatMotion& fat_;
  std::vector<std::array<MaterialPoint, 2>> place_;
  std::vector<double> damper_;  ///< h k + c, of what is left of each (N s/m)
  std::unique_ptr<PointCoupling> coupling_;
  std::uint64_t version_ = 0;  ///< of the fat's system for which that is
};

/// Vessels that are grown to an organ, solved together with it.
///
/// A tie of stiffness k and damping c between a place of the organ (velocity V) and a node of a vessel (velocity v)
/// pulls the vessel, implicit on both sides, with
///   F = k g + d (V - v),    g the gap now, h the step, d = h k + c.
/// With C the vessels' exact compliance at all tied nodes and v0 their velocity without ties, v = v0 + h C F, so
///   F = D (g k / d + V - v0),    D = (1 / d + h C)^-1:
/// vessels move first, the organ then feels them as springs and dampers D that respond to one another
/// (JointAttachment), and F is what the vessels are pushed with afterwards. That is the solution of the one linear
/// system of organ and vessels: a force is the same on both sides, and implicit Euler's damping holds for the whole,
/// however stiff the ties.
class GrownVessels final : public Coupling {
 public:
  /// @param ties of Model::ties(), all between this organ and vessels, none of fat @param vessels all trees
  GrownVessels(const Model& model, std::size_t organ, std::vector<std::size_t> ties, double step, OrganBody& organBody,
               std::vector<VesselBody*> vessels);

  [[nodiscard]] std::size_t organ() const { return bodies()[0]; }
  [[nodiscard]] bool joins(std::size_t body) const;

  void load(std::size_t body, std::vector<Attachment>& attachments,
            std::vector<JointAttachment>& joints) const override;
  void passOn(std::size_t body, std::vector<Vec3>& impulse) override;
  void follow() override { pull(organBody_.freeVelocity()); }

  [[nodiscard]] std::size_t size() const { return tie_.size(); }
  /// Node of the vessel's body at which a tie holds. @return -1: it holds another body
  [[nodiscard]] int nodeOf(std::size_t tie, std::size_t vessel) const {
    return vesselOf(tie) == vessel ? nodeOf(tie) : -1;
  }
  /// Product of the matrix of organ, vessels and further couplings with the present search direction: the impulses of
  /// the organ's ties on a vessel, and their reaction on the organ. @param vessel its body's number @param response the
  /// vessel's response to other impulses, without the ties, at the node of each tie @param push per tie
  void react(ConjugateGradient& gradient, std::size_t vessel, std::span<const Vec3> response, std::vector<Vec3>& push);

  /// Compliance used by the contact solver: (1 / d + h (C of vessels + C of the organ))^-1, on the organ's compliance
  /// of contact.
  /// @pre linearise()
  void stiffen(const State& state);
  /// Relative velocities of all ties (organ minus vessel) for a unit impulse at a place of a body, weighted and rotated
  /// as Body::block() is to be. @pre stiffen()
  void responses(const Body& body, std::size_t which, const SolidSolver::Impulse& place, std::span<const Mat3> rotation,
                 std::vector<Mat3>& out) const;
  /// Impulses of the ties on the organ that responses() cause.
  void tieImpulses(std::span<const Mat3> responses, std::vector<Mat3>& out) const;
  /// Reduction, by the ties, of the velocity at one place for an impulse at another.
  /// @param responses at the one place @param tieImpulses for the other
  [[nodiscard]] Mat3 schurComplement(std::span<const Mat3> responses, std::span<const Mat3> tieImpulses) const;

 private:
  [[nodiscard]] const Tie& tie(std::size_t i) const { return model_.ties()[tie_[i]]; }
  [[nodiscard]] std::size_t vesselOf(std::size_t i) const { return tie(i).body[1]; }
  [[nodiscard]] int nodeOf(std::size_t i) const { return tie(i).place[1].node[0]; }
  [[nodiscard]] Vec3 applied(std::size_t i, std::span<const Vec3> velocity) const;
  [[nodiscard]] VesselBody& vessel(std::size_t i) const { return *vessel_[vesselOf(i) - model_.organs().size()]; }
  [[nodiscard]] const Vec3& velocityOf(std::size_t i) const {
    return vessel(i).freeVelocity()[static_cast<std::size_t>(nodeOf(i))];
  }
  bool takeState(const State& state) override;
  void pull(std::span<const Vec3> organVelocity);
  void gatherImpulses();
  void rigidity(std::vector<double>& out) const;

  const Model& model_;
  std::vector<std::size_t> tie_;
  double step_;
  OrganBody& organBody_;
  std::vector<VesselBody*> vessel_;
  std::vector<int> organNode_;  ///< distinct nodes of the organ at the ties, ascending
  std::vector<double> tight_;
  std::vector<Mat3> rotation_;  ///< of organNode_
  JointAttachment joint_;
  std::vector<Vec3> ahead_;       ///< g k / d (m/s)
  std::vector<Vec3> vesselSeen_;  ///< velocities that the organ knows of
  std::vector<Vec3> force_, change_, more_;
  std::vector<Vec3> impulse_;
};

/// The ties between a body of fat and a tree of vessels. With A_v the vessels' matrix (exactly factorised, with the
/// ties' dampers d = h k + c on its diagonal), N the nodes of the ties and P their places in the fat, what vessels
/// answer to fat is
///   -(h d P)^T N A_v^-1 N^T (h d P)
/// in the fat's matrix: the system of both, solved by elimination (a Schur complement). Each product with it costs one
/// pass over the vessels (TreeResponse). Vessels that are grown to an organ couple it to the fat besides
/// (GrownVessels::react()).
class VesselsInFat final : public Coupling, public SystemCoupling {
 public:
  /// @param body, fat the fat's number among all bodies, and among fat @param grown how the vessels are grown to an
  /// organ, or null
  VesselsInFat(const Model& model, std::size_t body, std::size_t fat, std::size_t tree, double step, FatMotion& fatBody,
               VesselBody& vessel, GrownVessels* grown);

  /// True if there is any such tie.
  [[nodiscard]] bool exists() const { return !tie_.empty(); }

  void assemble() override;
  [[nodiscard]] SystemCoupling* system() override { return this; }
  /// @param organ to which the vessels are grown; if to none, the fat again
  void addTo(ConjugateGradient& organ, ConjugateGradient& fat) override;
  void passOn(std::size_t body, std::vector<Vec3>& impulse) override;
  void follow() override;
  void see() override;

 private:
  /// By how much a row of the fat's system takes part in the force on a node: h d w of one tie (kg).
  struct Share {
    std::size_t row;
    std::uint32_t node;
    double weight;
  };

  [[nodiscard]] std::size_t nodeOf(std::size_t i) const;
  [[nodiscard]] const MaterialPoint& placeOf(std::size_t i) const;
  bool takeState(const State& state) override;
  void sumShares(const SolidSystem& fat);
  void findReach();
  void addGrown(ConjugateGradient& organ);

  const Model& model_;
  std::size_t vesselBody_;  ///< the vessels' number among all bodies
  double step_;
  FatMotion& fat_;
  VesselBody& vessel_;
  GrownVessels* grown_;
  std::vector<std::size_t> tie_;  ///< of the model
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
  TreeResponse response_;
  std::vector<FourFloats> moved_;  ///< pushes, then answers, of `touched_`
  // Per tie of `grown_`: its node's index in `touched_`, or none; then the columns of the response of `touched_`.
  std::vector<std::uint32_t> held_;
  std::vector<FourFloats> reach_;
  std::vector<Vec3> heldResponse_, heldPush_;
  std::vector<Vec3> push_;  ///< of pull(), per node
};

}  // namespace calot
