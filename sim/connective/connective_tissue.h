// SPDX-License-Identifier: GPL-3.0-or-later
// Connective tissue between two organs: fibrous strands from places on one to places on the other, and sheets between
// neighbouring strands.
//
// A strand is a spring with damper between a place a of the first organ and a place b of the second:
//   T = alpha k (l - l0) (pull positive),   f_a = -T d,   d = (x_a - x_b) / l.
// Each organ is solved with the other one taken as it is known at that moment, and with the strand's own-side change
// implicit (sim/solid/solid.h, Attachment): stable at any stiffness; at rest the two forces balance exactly, while in
// motion the one organ lags the other by at most a step.
//
// The energised hook fades a strand (alpha falls from 1) until it is gone: burned. A strand that is pulled above its
// strength tears; what is left of a torn strand hangs on the organs as residue until the hook burns it away.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/solid/solid.h"

namespace calot {

enum class StrandCondition : std::uint8_t { attached = 0, burned = 1, torn = 2 };

struct Strand {
  SolidPlace a, b;                     ///< in an element of the first and of the second organ
  double restLength = 0.0;             ///< l0 (m)
  Vec3 restDirection = Vec3::UnitZ();  ///< d at rest, used where the ends meet
  double area = 0.0;                   ///< of the bed that it stands for (m^2)
};

/// What the tissue is made of, per area of bed, so that a finer division into strands is the same tissue.
struct ConnectiveMaterial {
  double stiffness = 2e5;  ///< of a unit area of bed (N/m^3)
  double damping = 2e3;    ///< (N s/m^3)
  double strength = 4e3;   ///< pull per area at which it tears (Pa)
  double fadeTime = 0.4;   ///< how long the energised hook takes to burn a strand through (s)
  double goneBelow = 0.2;  ///< a strand of this alpha is gone
};

/// Fixed data of one connective tissue.
class ConnectiveTissue {
 public:
  /// @param sheets pairs of neighbouring strands, each pair once
  /// @pre indices in range, areas and rest lengths not negative
  ConnectiveTissue(std::vector<Strand> strands, std::vector<std::array<std::uint32_t, 2>> sheets,
                   ConnectiveMaterial material);

  [[nodiscard]] const std::vector<Strand>& strands() const { return strand_; }
  [[nodiscard]] const std::vector<std::array<std::uint32_t, 2>>& sheets() const { return sheet_; }
  [[nodiscard]] const ConnectiveMaterial& material() const { return material_; }
  [[nodiscard]] double area() const { return area_; }  ///< of all strands (m^2)

 private:
  std::vector<Strand> strand_;
  std::vector<std::array<std::uint32_t, 2>> sheet_;
  ConnectiveMaterial material_;
  double area_ = 0.0;
};

/// Everything of it that changes.
struct ConnectiveState {
  std::vector<StrandCondition> condition;
  std::vector<double> alpha;  ///< 1: intact; below ConnectiveMaterial::goneBelow: gone

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("condition", self.condition);
    visit("alpha", self.alpha);
  }
};

/// All strands attached and intact.
ConnectiveState intactState(const ConnectiveTissue& tissue);

/// Nodes of one organ as a strand meets them.
struct OrganMotion {
  std::span<const Vec3> position;  ///< m
  std::span<const Vec3> velocity;  ///< m/s
};

/// Which organ of a tissue: the one of the places a, or of the places b.
enum class ConnectiveSide : std::uint8_t { a, b };

/// Appends the attachments of all attached strands to one of the two organs over a step.
/// @param own, other motions of that organ and of the other one, as known now
/// @param step h (s)
void addConnectiveLoads(const ConnectiveTissue& tissue, const ConnectiveState& state, ConnectiveSide side,
                        const OrganMotion& own, const OrganMotion& other, double step, std::vector<Attachment>& out);

/// Pull of a strand (N), negative while it is pressed, 0 where it is not attached.
double strandTension(const ConnectiveTissue& tissue, const ConnectiveState& state, std::size_t strand,
                     std::span<const Vec3> positionA, std::span<const Vec3> positionB);

/// Tears every attached strand that is pulled above its strength, ascending; appends their indices.
/// @return largest pull per area of any attached strand before (Pa)
double tearOverstretched(const ConnectiveTissue& tissue, ConnectiveState& state, std::span<const Vec3> positionA,
                         std::span<const Vec3> positionB, std::vector<std::uint32_t>& torn);

/// A part of the energised hook: a capsule that moves from one place to another during a step.
struct HookSweep {
  std::array<Vec3, 2> before{Vec3::Zero(), Vec3::Zero()};  ///< ends of its axis at the step's beginning (m)
  std::array<Vec3, 2> now{Vec3::Zero(), Vec3::Zero()};     ///< and at its end
  double radius = 0.0;                                     ///< m
};

/// Fades what any part of the hook touches during a step: attached strands along their length, the stumps of torn ones
/// at their organs (half of the rest length, at least `radius`). Indices of strands that this burned through are
/// appended, ascending. @return how many strands it touched
std::size_t burnStrands(const ConnectiveTissue& tissue, ConnectiveState& state, std::span<const Vec3> positionA,
                        std::span<const Vec3> positionB, std::span<const HookSweep> hook, double step,
                        std::vector<std::uint32_t>& burned);

/// Shares of the bed's area.
struct ConnectiveShares {
  double attached = 0.0;
  double burned = 0.0;
  double torn = 0.0;  ///< residue once nothing is attached any more
};
ConnectiveShares sharesOf(const ConnectiveTissue& tissue, const ConnectiveState& state);

}  // namespace calot
