// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/geometry/isosurface_stuffing.h"

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "sim/geometry/surface_distance.h"
#include "sim/geometry/surface_report.h"
#include "sim/math/elementary.h"
#include "sim/math/linear.h"

namespace calot {
namespace {

constexpr double countTolerance = 0.15;
constexpr double countAim = 0.05;
constexpr double volumeTolerance = 0.01;
constexpr double volumeAim = 0.002;
/// Greatest offset of the level set as a share of a cell: beyond it the lattice's margin ends and the shape
/// differs from the surface.
constexpr double maxOffset = 0.75;

/// Signed distances on the lattice. Far from the surface only the sign matters: along a row, the last distance minus
/// the distance travelled bounds the next from below. Signs come from winding numbers, since imported surfaces may
/// intersect themselves, which invalidates pseudonormals. Neighbours whose distances add up to more than their spacing
/// have no surface between them and share the sign.
std::vector<double> sample(const SurfaceDistance& surface, const BccLattice& lattice) {
  std::vector<double> value(static_cast<std::size_t>(lattice.points()));
  const double enough = 2.0 * lattice.cell;
  std::size_t p = 0;
  int guess = 0;
  for (int kind = 0; kind < 2; ++kind) {
    const Index3 size = lattice.size - Index3::Constant(kind);
    const std::size_t stride[3] = {1, slot(size[0]), slot(size[0]) * slot(size[1])};
    for (int k = 0; k < size[2]; ++k) {
      for (int j = 0; j < size[1]; ++j) {
        for (int i = 0; i < size[0]; ++i, ++p) {
          const double last = i > 0 ? value[p - 1] : 0.0;
          const double bound = std::abs(last) - lattice.cell;
          if (bound > enough) {
            value[p] = last < 0.0 ? -bound : bound;
            continue;
          }
          const Vec3 x = lattice.position(static_cast<std::int64_t>(p));
          const SurfaceDistance::Closest closest = surface.closest(x, guess);
          guess = closest.triangle;
          const double distance = std::sqrt(closest.on.squaredDistance);
          const int at[3] = {i, j, k};
          double known = 0.0;
          for (int axis = 0; axis < 3 && known == 0.0; ++axis) {
            if (at[axis] == 0) continue;
            const double beside = value[p - stride[axis]];
            if (std::abs(beside) + distance > 1.000001 * lattice.cell) known = beside;
          }
          if (known != 0.0) {
            value[p] = known < 0.0 ? -distance : distance;
          } else {
            value[p] = surface.signedDistance(x, closest);
          }
        }
      }
    }
  }
  return value;
}

struct Candidate {
  TetrahedralMesh mesh;
  double cell = 0.0;
  double offset = 0.0;
  double volume = 0.0;
  double countError = 1e300;
  double volumeError = 1e300;
  int droppedPieces = 0;
  double droppedVolume = 0.0;

  /// At most 1: both tolerances hold. Smaller is better; a separated piece costs as much as one percent of count.
  [[nodiscard]] double cost() const {
    return std::max(countError / countTolerance, volumeError / volumeTolerance) + 0.07 * droppedPieces;
  }
  [[nodiscard]] bool holds() const { return countError <= countTolerance && volumeError <= volumeTolerance; }
  [[nodiscard]] bool aimed() const { return countError <= countAim && volumeError <= volumeAim && droppedPieces == 0; }
};

class Search {
 public:
  Search(const TriangleMesh& surface, int requested)
      : distance_(surface, InsideRule::winding),
        requested_(requested),
        maxLatticePoints_(20'000 + 60 * std::int64_t{requested}),
        box_(bounds(surface)),
        area_(surfaceArea(surface)),
        volume_(signedVolume(surface)) {
    component_ = triangleComponents(surface, components_);
  }

  [[nodiscard]] const SurfaceDistance& distance() const { return distance_; }
  [[nodiscard]] const std::vector<int>& component() const { return component_; }
  [[nodiscard]] int components() const { return components_; }
  [[nodiscard]] double volume() const { return volume_; }

  /// @return false: the lattice would be too large
  bool run(Candidate& best) {
    // A lattice cube has 12 tetrahedra; pieces at the surface come in addition, hence the correction below.
    double cell = cubeRoot(12.0 * volume_ / static_cast<double>(requested_));
    for (int i = 0; i < 6; ++i) {
      if (BccLattice::around(box_, cell).points() > maxLatticePoints_) return false;
      const Candidate now = at(cell);
      const auto count = static_cast<double>(now.mesh.tetrahedron.size());
      if (now.cost() < best.cost()) best = now;
      if (best.aimed()) return true;
      const double ratio = count > 0.0 ? count / static_cast<double>(requested_) : 0.125;
      cell *= cubeRoot(std::clamp(ratio, 0.125, 8.0));
    }
    if (best.cost() < 0.5) return true;
    // On coarse lattices the count jumps with the cell size: search around the best one, nearest first,
    // also with shifted lattices.
    const double middle = best.cell > 0.0 ? best.cell : cell;
    const Vec3 shifts[5] = {Vec3(0.25, 0.25, 0.25), Vec3(0.5, 0.0, 0.0), Vec3(0.0, 0.5, 0.0), Vec3(0.0, 0.0, 0.5),
                            Vec3::Zero()};
    for (int i = 0; i < 60; ++i) {
      const int ring = i / 10;
      const double share = 0.012 * static_cast<double>(ring);
      const double tried = middle * (i / 5 % 2 == 0 ? 1.0 + share : 1.0 - share);
      if (BccLattice::around(box_, tried).points() > maxLatticePoints_) continue;
      Candidate now = at(tried, shifts[i % 5]);
      if (now.cost() < best.cost()) best = std::move(now);
      if (best.cost() < 0.5 || (i >= 20 && best.holds())) break;
    }
    return true;
  }

 private:
  /// The best offset at one cell size: Newton steps, the slope of volume over offset being the surface's area.
  Candidate at(double cell, const Vec3& shift = Vec3::Zero()) {
    Box box = box_;
    if (shift != Vec3::Zero()) box.grow(0.5 * cell);
    BccLattice lattice = BccLattice::around(box, cell);
    lattice.origin += cell * shift;
    const std::vector<double> value = sample(distance_, lattice);
    Candidate best;
    best.cell = cell;
    double offset = 0.0;
    double step = 1.0;
    for (int i = 0; i < 8; ++i) {
      Candidate now;
      now.cell = cell;
      now.offset = offset;
      now.mesh = stuff(lattice, value, offset);
      removeFragments(now);
      now.volume = meshVolume(now.mesh);
      const double missing = volume_ - now.volume;
      now.volumeError = std::abs(missing) / volume_;
      now.countError = std::abs(static_cast<double>(now.mesh.tetrahedron.size()) - static_cast<double>(requested_)) /
                       static_cast<double>(requested_);
      const bool better = now.volumeError < best.volumeError;
      if (better) best = std::move(now);
      if (best.volumeError <= volumeAim) break;
      // Snapping makes volume jump: damp once the steps stop helping.
      if (!better) step *= 0.5;
      offset = std::clamp(offset + step * missing / area_, -maxOffset * cell, maxOffset * cell);
    }
    return best;
  }

  /// A part thinner than the lattice can resolve may leave loose pieces: of those on one component of the surface, only
  /// the largest is kept.
  void removeFragments(Candidate& candidate) const {
    int pieces = 0;
    const std::vector<int> piece = tetrahedronComponents(candidate.mesh, pieces);
    if (pieces <= 1) return;
    std::vector<double> volume(slot(pieces), 0.0);
    std::vector<int> on(slot(pieces), -1);
    for (std::size_t t = 0; t < piece.size(); ++t) {
      const Index4& v = candidate.mesh.tetrahedron[t];
      const Vec3& a = candidate.mesh.vertex[slot(v[0])];
      const Vec3& b = candidate.mesh.vertex[slot(v[1])];
      const Vec3& c = candidate.mesh.vertex[slot(v[2])];
      const Vec3& d = candidate.mesh.vertex[slot(v[3])];
      volume[slot(piece[t])] += (b - a).cross(c - a).dot(d - a) / 6.0;
      if (on[slot(piece[t])] < 0) {
        on[slot(piece[t])] = component_[slot(distance_.closest(0.25 * (a + b + c + d)).triangle)];
      }
    }
    std::vector<int> largest(slot(components_), -1);
    for (int i = 0; i < pieces; ++i) {
      int& l = largest[slot(on[slot(i)])];
      if (l < 0 || volume[slot(i)] > volume[slot(l)]) l = i;
    }
    std::vector<std::uint8_t> keep(piece.size());
    for (std::size_t t = 0; t < piece.size(); ++t) keep[t] = largest[slot(on[slot(piece[t])])] == piece[t] ? 1 : 0;
    for (int i = 0; i < pieces; ++i) {
      if (largest[slot(on[slot(i)])] == i) continue;
      ++candidate.droppedPieces;
      candidate.droppedVolume += volume[slot(i)];
    }
    if (candidate.droppedPieces > 0) candidate.mesh = subMesh(candidate.mesh, keep);
  }

  SurfaceDistance distance_;
  int requested_;
  /// A lattice has about 1/6 point per tetrahedron and fills its box; a body that leaves more than 99 % of its box
  /// empty would take minutes and fall into fragments.
  std::int64_t maxLatticePoints_;
  Box box_;
  double area_;
  double volume_;
  std::vector<int> component_;
  int components_ = 0;
};

/// Fills in what compares surface and mesh.
void compare(const Search& search, StuffedMesh& result) {
  StuffingReport& report = result.report;
  const TriangleMesh& surface = search.distance().mesh();
  const SurfaceDistance boundary(boundarySurface(result.mesh));
  report.lostDistance = 0.5 * result.cellSize;

  double maxSquared = -1.0;
  const auto measure = [&](const Vec3& p, int& guess) {
    const SurfaceDistance::Closest closest = boundary.closest(p, guess);
    guess = closest.triangle;
    if (closest.on.squaredDistance > maxSquared) {
      maxSquared = closest.on.squaredDistance;
      report.lostWhere = p;
    }
    return closest.on.squaredDistance;
  };
  int guess = 0;
  for (const Vec3& p : surface.vertex) measure(p, guess);
  double lost = 0.0;
  double area = 0.0;
  TriangleMesh lostPart;
  for (int t = 0; t < surface.triangles(); ++t) {
    const Vec3& a = surface.corner(t, 0);
    const Vec3& b = surface.corner(t, 1);
    const Vec3& c = surface.corner(t, 2);
    const double own = 0.5 * (b - a).cross(c - a).norm();
    area += own;
    if (measure((a + b + c) / 3.0, guess) <= report.lostDistance * report.lostDistance) continue;
    lost += own;
    lostPart.triangle.push_back(surface.triangle[slot(t)]);
  }
  report.surfaceToMesh = std::sqrt(notNegative(maxSquared));
  report.lostArea = area > 0.0 ? lost / area : 0.0;
  static_cast<void>(triangleComponents(lostPart, report.lostParts));

  std::vector<char> followed(slot(search.components()), 0);
  double maximum = 0.0;
  guess = 0;
  const auto back = [&](const Vec3& p) {
    const SurfaceDistance::Closest closest = search.distance().closest(p, guess);
    guess = closest.triangle;
    maximum = std::max(maximum, closest.on.squaredDistance);
    if (closest.on.squaredDistance <= result.cellSize * result.cellSize) {
      followed[slot(search.component()[slot(closest.triangle)])] = 1;
    }
  };
  const TriangleMesh& shell = boundary.mesh();
  for (const Vec3& p : shell.vertex) back(p);
  for (int t = 0; t < shell.triangles(); ++t)
    back((shell.corner(t, 0) + shell.corner(t, 1) + shell.corner(t, 2)) / 3.0);
  report.meshToSurface = std::sqrt(maximum);
  report.lostComponents = static_cast<int>(std::count(followed.begin(), followed.end(), char{0}));
}

std::string faultOf(const TriangleMesh& surface) {
  if (surface.triangle.empty()) return "the surface has no triangles";
  for (const Vec3& p : surface.vertex) {
    if (!p.allFinite() || !(p.cwiseAbs().maxCoeff() < 1e6))
      return "the surface has a vertex that is not finite or farther than 1000 km";
  }
  const SurfaceReport report = inspectSurface(surface);
  if (report.openEdges > 0)
    return "the surface is open: " + std::to_string(report.openEdges) + " edges have one triangle only; close it";
  if (report.flippedEdges > 0) {
    return "neighbouring triangles disagree on what is outside at " + std::to_string(report.flippedEdges) + " edges";
  }
  if (!(report.volume > 0.0)) return "the surface encloses no volume, or is turned inside out";
  return {};
}

}  // namespace

StuffedMesh stuffToCount(const TriangleMesh& surface, int tetrahedra) {
  StuffedMesh result;
  result.report.requested = tetrahedra;
  if (tetrahedra < 12 || tetrahedra > maxTetrahedronCount) {
    result.error = "the number of tetrahedra must be from 12 to " + std::to_string(maxTetrahedronCount);
    return result;
  }
  result.error = faultOf(surface);
  if (!result.error.empty()) {
    result.unusable = true;
    return result;
  }
  Search search(surface, tetrahedra);
  Candidate best;
  if (!search.run(best) || best.mesh.tetrahedron.empty()) {
    result.error = "the surface is too thin for its size: no lattice fills it with " + std::to_string(tetrahedra) +
                   " tetrahedra; ask for more";
    return result;
  }
  StuffingReport& report = result.report;
  result.cellSize = best.cell;
  result.levelOffset = best.offset;
  report.tetrahedra = static_cast<int>(best.mesh.tetrahedron.size());
  report.surfaceVolume = search.volume();
  report.meshVolume = best.volume;
  report.volumeError = best.volumeError;
  report.countError = best.countError;
  report.droppedPieces = best.droppedPieces;
  report.droppedVolume = best.droppedVolume;
  const bool holds = best.holds();
  result.mesh = std::move(best.mesh);
  const DihedralRange angles = dihedralRange(result.mesh);
  report.dihedralMin = angles.min;
  report.dihedralMax = angles.max;
  compare(search, result);
  if (!holds) {
    result.error = "count and volume cannot both be met at " + std::to_string(tetrahedra) +
                   " tetrahedra: parts of the surface are thinner than the lattice; ask for more";
  }
  return result;
}

}  // namespace calot
