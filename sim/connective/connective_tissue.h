// SPDX-License-Identifier: GPL-3.0-or-later
// Connective tissue between two organs: fibrous strands from points of one to points of the other, and
// sheets between neighbouring strands.
//
// A strand is a cohesive spring (CohesiveLaw) and a damper between point a of the first organ and point b of the
// second, over its area A of the bed:
//   T = alpha A t(w),   w = l - l0 (tension positive),   f_a = -T e + alpha (1 - d) R f_0,   e = (x_a - x_b) / l.
// f_0 is what it carries of the weight where the scene is drawn (sim/scene/weight_system.h), mostly shear; R turns it
// with the second organ. It fades and breaks with the strand.
// Over a step it is linear in the velocities of both ends: f_a = -T e - c (v_a - v_b) with c = h k + damping, k the
// secant stiffness. k I is an upper bound of the spring's tangent stiffness in every direction, so that implicit Euler
// of both organs as one system never gains energy from a strand, at any stiffness and step.
//
// The energised hook fades a strand (alpha falls from 1) until it is gone: burned. A strand pulled beyond the strength
// softens, and is torn once its separation reaches the final one; its remains stay on the organs as residue until the
// hook burns them away.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "sim/geometry/dwell.h"
#include "sim/geometry/isosurface_stuffing.h"
#include "sim/geometry/surface_distance.h"
#include "sim/geometry/triangle_mesh.h"
#include "sim/solid/solid.h"

namespace calot {

// Traction and separation of connective tissue per unit area: linear up to the strength, then softening linearly until
// the fracture energy is used up (bilinear cohesive law; Camanho, Davila and de Moura 2003, "Numerical simulation of
// mixed-mode progressive delamination in composite materials", with one mode).
//
//   t(w) = (1 - d) K w  for w > 0,   t(w) = K w  for w <= 0,
//   d(w_max) = w_f (w_max - w_0) / (w_max (w_f - w_0))  for w_0 < w_max < w_f,   0 below, 1 above,
//   w_0 = sigma / K,   w_f = 2 G_c / sigma.
//
// w is the separation, w_max the largest so far: damage d never falls, unloading returns along the secant to the
// origin, and compression is that of intact tissue. Up to w_f, opening takes the fracture energy G_c.

struct CohesiveLaw {
  double stiffness = 0.0;       ///< K (N/m^3)
  double strength = 0.0;        ///< sigma (Pa)
  double fractureEnergy = 0.0;  ///< G_c (J/m^2)

  /// Energy stored where softening begins, the least fracture energy (J/m^2).
  [[nodiscard]] double minFractureEnergy() const { return 0.5 * strength * strength / stiffness; }
  /// w_0 (m)
  [[nodiscard]] double peakSeparation() const { return strength / stiffness; }
  /// w_f (m)
  [[nodiscard]] double finalSeparation() const { return 2.0 * fractureEnergy / strength; }

  /// d for the largest separation so far (m).
  /// @pre fractureEnergy >= minFractureEnergy(); where both are equal, the law is brittle.
  [[nodiscard]] double damageAt(double largest) const {
    const double peak = peakSeparation();
    const double last = finalSeparation();
    if (!(largest < last)) return 1.0;
    if (largest <= peak) return 0.0;
    return last * (largest - peak) / (largest * (last - peak));
  }

  /// Secant stiffness at a separation (N/m^3).
  [[nodiscard]] double secant(double separation, double damage) const {
    return separation > 0.0 ? (1.0 - damage) * stiffness : stiffness;
  }

  /// Energy that reaching a damage has dissipated (J/m^2): the work of opening to w_max less what is stored there,
  /// sigma d w_max / 2, from 0 to G_c.
  [[nodiscard]] double dissipated(double damage) const {
    const double peak = peakSeparation();
    const double last = finalSeparation();
    const double largest = last * peak / (last - damage * (last - peak));
    return 0.5 * strength * damage * largest;
  }
};

enum class StrandCondition : std::uint8_t { attached = 0, burned = 1, torn = 2 };

struct Strand {
  MaterialPoint a, b;                  ///< in an element of the first and of the second organ
  double restLength = 0.0;             ///< l0 (m)
  Vec3 restDirection = Vec3::UnitZ();  ///< d at rest, used if the ends coincide
  double area = 0.0;                   ///< of the bed that it represents (m^2)
  /// Force on the first organ that it carries at rest, besides its law, in the frame of the second one's element (N).
  Vec3 load = Vec3::Zero();
};

/// Material per area of bed, independent of the subdivision into strands.
struct ConnectiveMaterial {
  double stiffness = 2e5;        ///< K (N/m^3)
  double damping = 2e3;          ///< (N s/m^3)
  double strength = 4e3;         ///< sigma, the largest traction (Pa)
  double fractureEnergy = 60.0;  ///< G_c (J/m^2)
  double fadeTime = 0.4;         ///< time that the energised hook takes to burn a strand through (s)
  double goneBelow = 0.2;        ///< a strand of this alpha is gone

  [[nodiscard]] CohesiveLaw law() const { return {stiffness, strength, fractureEnergy}; }
};

/// Constant data of one connective tissue.
class ConnectiveTissue {
 public:
  /// @param sheets pairs of neighbouring strands, each pair once
  /// @pre indices in range, areas and rest lengths not negative, G_c >= CohesiveLaw::minFractureEnergy()
  ConnectiveTissue(std::vector<Strand> strands, std::vector<std::array<std::uint32_t, 2>> sheets,
                   ConnectiveMaterial material);

  [[nodiscard]] const std::vector<Strand>& strands() const { return strand_; }
  [[nodiscard]] const std::vector<std::array<std::uint32_t, 2>>& sheets() const { return sheet_; }
  [[nodiscard]] const ConnectiveMaterial& material() const { return material_; }
  [[nodiscard]] double area() const { return area_; }  ///< of all strands (m^2)
  /// Stiffness of an intact strand, in any direction (N/m).
  [[nodiscard]] double stiffnessOf(const Strand& strand) const { return strand.area * material_.stiffness; }
  /// Loads the strands at rest as displacements of the organs' nodes (m) would if they were as stiff in all directions.
  void preload(std::span<const Vec3> displacementA, std::span<const Vec3> displacementB);

 private:
  std::vector<Strand> strand_;
  std::vector<std::array<std::uint32_t, 2>> sheet_;
  ConnectiveMaterial material_;
  double area_ = 0.0;
};

/// State of one connective tissue.
struct ConnectiveState {
  std::vector<StrandCondition> condition;
  std::vector<double> alpha;   ///< 1: intact; below ConnectiveMaterial::goneBelow: gone
  std::vector<double> damage;  ///< d of CohesiveLaw, 0 to 1; never falls

  template <class Self, class Visitor>
  static void fields(Self& self, Visitor& visit) {
    visit("condition", self.condition);
    visit("alpha", self.alpha);
    visit("damage", self.damage);
  }
};

/// All strands attached and intact.
ConnectiveState intactState(const ConnectiveTissue& tissue);

/// Nodal positions and velocities of one organ.
struct OrganMotion {
  std::span<const Vec3> position;                ///< m
  std::span<const Vec3> velocity;                ///< m/s
  std::span<const RotationGroup> rotation = {};  ///< of its elements; empty: none is rotated
};

/// The attached strands over a step, as both organs feel them.
struct ConnectiveLoads {
  std::vector<Attachment> onA, onB;  ///< of the attached strands, ascending
  std::vector<double> damper;        ///< per strand: c (N s/m), 0 if it is not attached
};

/// Linearises all strands over a step, about the velocities at its beginning: what is left to the joined system
/// (PointCoupling) is what each organ feels of the other's change of velocity.
/// @param a, b motion at the step's beginning @param step h (s)
void linearise(const ConnectiveTissue& tissue, const ConnectiveState& state, const OrganMotion& a, const OrganMotion& b,
               double step, ConnectiveLoads& out);

/// Tension of a strand (N), negative in compression, 0 if it is not attached.
double strandTension(const ConnectiveTissue& tissue, const ConnectiveState& state, std::size_t strand,
                     std::span<const Vec3> positionA, std::span<const Vec3> positionB);

struct DamageReport {
  double maxTraction = 0.0;  ///< greatest traction of any attached strand, over its remaining section alpha A (Pa)
  bool grown = false;        ///< did the damage of any strand grow?
};

/// Damage at these positions: grows with the separation of each attached strand, which is torn where it reaches the
/// final one. Appends indices of strands that this tore, ascending.
DamageReport advanceDamage(const ConnectiveTissue& tissue, ConnectiveState& state, std::span<const Vec3> positionA,
                           std::span<const Vec3> positionB, std::vector<std::uint32_t>& torn);

/// A strand that a hook touched.
struct StrandTouch {
  std::uint32_t strand = 0;
  double share = 0.0;  ///< of the step
};

/// Appends the strands that come within `reach` of any part of the hook during a step, ascending, with the exact share
/// of the step that they do: attached ones along their length, torn ones at their stumps (half of the rest length, at
/// least the part's radius). @param a, b motions of the organs at the step's end @param step h (s)
void touchStrands(const ConnectiveTissue& tissue, const ConnectiveState& state, const OrganMotion& a,
                  const OrganMotion& b, std::span<const MovingCapsule> hook, double reach, double step,
                  std::vector<StrandTouch>& touches);

/// Fades strands: one that was touched for ConnectiveMaterial::fadeTime in all is burned through.
/// @param seconds of current at full power that a whole step of touch is worth (s)
/// Appends indices of strands that this burned through, ascending.
void burnStrands(const ConnectiveTissue& tissue, ConnectiveState& state, std::span<const StrandTouch> touches,
                 double seconds, std::vector<std::uint32_t>& burned);

/// Shares of the bed's area.
struct ConnectiveShares {
  double attached = 0.0;
  double burned = 0.0;
  double torn = 0.0;  ///< residue once no strand is attached
};
ConnectiveShares sharesOf(const ConnectiveTissue& tissue, const ConnectiveState& state);

// Strands over the bed between two adjacent organs.

/// An organ in its reference configuration.
struct BedOrgan {
  const TriangleMesh& surface;  ///< closed, outward
  const TetrahedralMesh& mesh;  ///< of its solid
};

struct ConnectiveBed {
  std::vector<Strand> strands;
  std::vector<std::array<std::uint32_t, 2>> sheets;
  std::string error;  ///< one sentence if there is no bed

  [[nodiscard]] bool ok() const { return error.empty(); }
};

/// The bed: all triangles of the first organ's surface whose corners all lie within `reach` of the second organ.
std::vector<Index3> bedTriangles(const TriangleMesh& first, const SurfaceDistance& second, double reach);

/// Strands over the whole bed (bedTriangles()). Its triangles' edges are divided by the smallest n that gives at least
/// `minStrands` strands, one from each vertex to the nearest point of the second organ. Each strand represents a third
/// of the area of the subdivided triangles around it; sheets join neighbours along edges.
/// @pre both organs have triangles and tetrahedra of positive volume; reach > 0; minStrands > 0
ConnectiveBed makeBed(const BedOrgan& first, const BedOrgan& second, double reach, std::size_t minStrands);

}  // namespace calot
