// SPDX-License-Identifier: GPL-3.0-or-later
// Which triangles of a surface were near to the vertices of another, or of its own, not long ago.
//
// Where a surface has gone far from its rest, the displacements since rest settle little. So a look at a patch of
// vertices goes `margin` farther than it need, and what it came upon is written down, with its distances and with where
// everything was. Until a vertex and the patches of triangles near it have been displaced against one another by that
// margin, no other triangle can have come within the distance that counts, and of those in the list only the ones that
// were not farther than that distance and the displacement (Verlet's neighbour lists, 1967). What all
// near have in common, a rotation too, displaces nothing against anything. Where things move so fast that lists do not
// live long enough to pay, a look goes no farther than it need; and lists that live are made for a third of the patches
// a step, so that no step has all of them to make.
//
// The lists say which triangles need not be looked at, never on which side of one a vertex is: that is told from the
// present alone. So the answer is the same with lists of any age and without, and nothing of this is part of State.
#pragma once

#include <array>
#include <compare>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "sim/contact/patch_triangles.h"
#include "sim/contact/surface_patches.h"
#include "sim/contact/surface_search.h"
#include "sim/math/linear.h"

namespace calot {

/// Lists for the vertices of one SurfacePair; one object a pair. Memory is kept from step to step.
class NearTriangles {
 public:
  static constexpr double margin = 0.003;  ///< by which a look goes farther than what counts (m)

  /// What there was to do, since reset().
  struct Counts {
    std::size_t renewed = 0;   ///< patches of vertices whose lists were made anew
    std::size_t searched = 0;  ///< vertices that had a triangle to look at
    std::size_t looked = 0;    ///< triangles looked at
  };

  /// Forgets everything; keeps the memory.
  void reset();
  [[nodiscard]] const Counts& counts() const { return counts_; }

  /// Works out ahead what the lists of a surface with itself would have to, patch by patch. @param surface at rest
  void precompute(const SurfacePair& pair, const ContactSurface& surface);

  /// To be called before the patches of one answer: surfaces have moved.
  void begin(const SurfaceSearch& search);
  /// Makes nearest() ready for the open vertices of a patch (SearchRoom::open): with the lists there are, where they
  /// hold for each, else with new ones.
  /// @param near patches whose bounds overlap those of the patch grown by search(), or more
  void follow(const SurfaceSearch& search, std::uint32_t patch, std::span<const std::uint32_t> near, double reach);
  /// The same answer as SurfaceSearch::nearest() with limitOf(). @param place of the vertex in its patch
  [[nodiscard]] Near nearest(const SurfaceSearch& search, std::size_t place, double reach);

  SearchRoom& room() { return room_; }

 private:
  static constexpr std::size_t unknown = ~std::size_t{0};
  struct Entry {
    float distance = 0.0F;  ///< not above what it was (m)
    std::uint32_t triangle = 0;
    auto operator<=>(const Entry&) const = default;  // NOLINT(modernize-use-nullptr): the check's own fault
  };
  using Padded = std::array<double, 4>;  ///< a place (m) and nothing: a vector's worth

  /// Of one patch of vertices.
  struct List {
    bool made = false;
    double reach = 0.0;                 ///< with which it was made (m)
    double margin = 0.0;                ///< the same: NearTriangles::margin, or nothing where all moves fast
    double pace = 0.0;                  ///< at which all was displaced when it was last asked (m a step)
    std::uint64_t age = 0;              ///< the step in which it was made
    bool turning = false;               ///< has so far moved that a common rotation is looked for
    std::vector<std::uint32_t> patch;   ///< of triangles, whose corners were written down; ascending
    std::vector<std::size_t> start;     ///< of each in `corner`, and the end
    std::vector<Padded> corner;         ///< where they were (m)
    std::vector<Vec3> vertex;           ///< where the patch's own vertices were (m)
    std::vector<std::size_t> entryEnd;  ///< per vertex
    std::vector<Entry> entry;           ///< nearest first
  };

  double measure(const SurfaceSearch& search, std::uint32_t patch, std::span<const std::uint32_t> near,
                 const std::array<Padded, 4>* rigid);
  double measureTurned(const SurfaceSearch& search, std::uint32_t patch, std::span<const std::uint32_t> near);
  bool holds(const SurfaceSearch& search, std::uint32_t patch, std::span<const std::uint32_t> near, double reach);
  void renew(const SurfaceSearch& search, std::uint32_t patch, std::span<const std::uint32_t> near, double reach);
  void readBounds(const SurfaceSearch& search);
  void count(const SurfacePair& pair, const ContactSurface& surface, std::uint32_t vertices, std::uint32_t triangles);

  SearchRoom room_;
  std::vector<List> list_;  ///< per patch of vertices
  PatchTriangles triangles_;
  /// Of a surface with itself: for a patch of vertices and one of triangles where in `counting_` it begins.
  std::vector<std::size_t> countingStart_;
  /// For each vertex and eight triangles which of them SurfacePair does not exclude, a bit each.
  std::vector<std::uint8_t> counting_;
  std::vector<Padded> now_;                  ///< where the nodes of the triangles' surface are (m)
  std::vector<Box> bounds_;                  ///< of the patches of triangles now; empty until asked for
  std::vector<const Padded*> was_;           ///< per near patch: where its corners were
  std::vector<Vec3> sampleWas_, sampleNow_;  ///< of measureTurned()
  std::vector<double> displaced_;  ///< of the patch at hand, per vertex: against the triangles near it, at most (m)
  std::uint32_t patch_ = 0;        ///< at hand
  std::uint64_t age_ = 0;          ///< steps
  Counts counts_;
};

}  // namespace calot
