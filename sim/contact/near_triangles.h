// SPDX-License-Identifier: GPL-3.0-or-later
// Neighbour lists (Verlet 1967): triangles of a surface that were recently near the vertices of another or
// of the same one.
//
// Far from the reference configuration, displacements since rest exclude few pairs. A search for a patch of vertices
// therefore extends `margin` beyond the distance that matters and stores the triangles found, their distances and all
// positions. As long as a vertex and the nearby triangles have moved relative to each other by less than the margin, no
// other triangle can have come within that distance, and only listed triangles that were within that distance plus the
// relative displacement need a test. A rigid motion that all of them share does not count as relative displacement. In
// fast motion, where lists would expire too soon to pay off, the margin is zero. Per step, only a third of the patches
// may build a list with a margin, which spreads the cost.
//
// Lists only exclude triangles; the side of a vertex follows from current positions alone. Results are therefore
// identical with lists of any age and without lists, and none of this is part of State.
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/contact/patch_triangles.h"
#include "sim/contact/surface_patches.h"
#include "sim/contact/surface_surface.h"
#include "sim/math/linear.h"

namespace calot {

/// Lists for the vertices of one SurfacePair. Memory is reused from step to step.
class NearTriangles {
 public:
  static constexpr double margin = 0.003;  ///< search distance beyond the one that matters (m)

  /// Work counters since reset().
  struct Counts {
    std::size_t rebuilt = 0;   ///< patches of vertices whose lists were rebuilt
    std::size_t searched = 0;  ///< vertices with at least one triangle to test
    std::size_t tested = 0;    ///< triangles tested
  };

  /// Drops all lists; keeps their memory.
  void reset();
  [[nodiscard]] const Counts& counts() const { return counts_; }

  /// Precomputes the exclusion masks that lists of a surface with itself need. @param surface at rest
  void precompute(const SurfacePair& pair, const ContactSurface& surface);

  /// Call once per search, after the surfaces have moved and before the first patch.
  void begin(const SurfaceSearch& search);
  /// Prepares nearest() for the open vertices of a patch (SearchScratch::open): reuses the lists if they are valid for
  /// all of them, else rebuilds them.
  /// @param near patches whose bounds overlap those of the patch grown by search(), or more
  void updateLists(const SurfaceSearch& search, std::uint32_t patch, std::span<const std::uint32_t> near, double reach);
  /// Same result as SurfaceSearch::nearest() with limitOf(). @param index of the vertex in its patch
  [[nodiscard]] Near nearest(const SurfaceSearch& search, std::size_t index, double reach);

  SearchScratch& scratch() { return scratch_; }

 private:
  static constexpr std::size_t unknown = ~std::size_t{0};
  struct Entry {
    float distance = 0.0F;  ///< lower bound when the list was built (m)
    std::uint32_t triangle = 0;
    auto operator<=>(const Entry&) const = default;  // NOLINT(modernize-use-nullptr): the check's own fault
  };
  using Padded = std::array<double, 4>;  ///< a position (m), padded to four numbers

  /// List of one patch of vertices.
  struct List {
    bool made = false;
    double reach = 0.0;                 ///< when the list was built (m)
    double margin = 0.0;                ///< NearTriangles::margin, or 0 in fast motion
    double speed = 0.0;                 ///< mean relative displacement since the list was built (m per step)
    std::uint64_t age = 0;              ///< step in which the list was built
    bool rotating = false;              ///< moved so far that a common rotation is removed
    std::vector<std::uint32_t> patch;   ///< patches of triangles whose corners are stored; ascending
    std::vector<std::size_t> start;     ///< per such patch: its start in `corner`; then the end
    std::vector<Padded> corner;         ///< corner positions (m)
    std::vector<Vec3> vertex;           ///< positions of the patch's own vertices (m)
    std::vector<std::size_t> entryEnd;  ///< per vertex
    std::vector<Entry> entry;           ///< nearest first
  };

  double measure(const SurfaceSearch& search, std::uint32_t patch, std::span<const std::uint32_t> near,
                 const std::array<Padded, 4>* rigid);
  double measureRotated(const SurfaceSearch& search, std::uint32_t patch, std::span<const std::uint32_t> near);
  bool isValid(const SurfaceSearch& search, std::uint32_t patch, std::span<const std::uint32_t> near, double reach);
  void rebuild(const SurfaceSearch& search, std::uint32_t patch, std::span<const std::uint32_t> near, double reach);
  void readBounds(const SurfaceSearch& search);
  void count(const SurfacePair& pair, const ContactSurface& surface, std::uint32_t vertices, std::uint32_t triangles);

  SearchScratch scratch_;
  std::vector<List> list_;  ///< per patch of vertices
  PatchTriangles triangles_;
  /// For a surface with itself: per patch of vertices and patch of triangles, its start in `included_`.
  std::vector<std::size_t> includedStart_;
  /// Per vertex and group of eight triangles: a bit for each triangle that SurfacePair does not exclude.
  std::vector<std::uint8_t> included_;
  std::vector<Padded> now_;                  ///< current node positions of the triangles' surface (m)
  std::vector<Box> bounds_;                  ///< current bounds of the patches of triangles; empty until needed
  std::vector<const Padded*> was_;           ///< per near patch: its stored corner positions
  std::vector<Vec3> sampleWas_, sampleNow_;  ///< of measureRotated()
  std::vector<double> displaced_;  ///< per vertex of the current patch: upper bound of its displacement relative to
                                   ///< nearby triangles (m)
  std::uint32_t patch_ = 0;        ///< current patch
  std::uint64_t age_ = 0;          ///< steps
  Counts counts_;
};

// Rigid motion fitted to some points. Internal to this folder.

/// Least-squares rigid motion x -> rotation x + shift from `was` to `now`, by two Gauss-Newton steps: enough for a
/// tenth of a revolution. The result is rigid for any input. @pre was.size() == now.size() > 0
struct RigidMotion {
  Mat3 rotation = Mat3::Identity();
  Vec3 shift = Vec3::Zero();

  RigidMotion(std::span<const Vec3> was, std::span<const Vec3> now) {
    Vec3 from = Vec3::Zero();
    Vec3 to = Vec3::Zero();
    for (std::size_t i = 0; i < was.size(); ++i) {
      from += was[i] / static_cast<double>(was.size());
      to += now[i] / static_cast<double>(was.size());
    }
    for (int step = 0; step < 2; ++step) {
      Mat3 inertia = Mat3::Zero();
      Vec3 moment = Vec3::Zero();
      for (std::size_t i = 0; i < was.size(); ++i) {
        const Vec3 arm = rotation * (was[i] - from);
        inertia += arm.squaredNorm() * Mat3::Identity() - arm * arm.transpose();
        moment += arm.cross(now[i] - to);
      }
      const Vec3 half = 0.5 * (inertia.inverse() * moment);
      if (!(half.squaredNorm() < 1.0)) break;  // collinear points or too large a rotation: stop here
      rotation = Quat(1.0, half[0], half[1], half[2]).normalized().toRotationMatrix() * rotation;
    }
    shift = to - rotation * from;
  }
};

}  // namespace calot
