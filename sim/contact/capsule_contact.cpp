// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/contact/capsule_contact.h"

#include <algorithm>
#include <cmath>

#include "sim/contact/surface_patches.h"
#include "sim/contact/triangle_lanes.h"
#include "sim/geometry/closest_point.h"
#include "sim/math/linear.h"

namespace calot {

namespace {

constexpr double onSurface = 1e-9;      // m: nearer than this, the direction of the distance is noise
constexpr double mergeDistance = 1e-6;  // m: contacts nearer to each other are merged

struct Segment {
  const Vec3& p0;
  const Vec3& p1;
  [[nodiscard]] Vec3 at(double s) const { return p0 + s * (p1 - p0); }
};

/// A crossing of the axis with a face.
struct Crossing {
  double parameter = 0.0;
  bool inward = false;
  std::size_t triangle = 0;
  Vec3 weight = Vec3::Zero();
};

/// The triangle nearest to the axis.
struct Nearest {
  bool found = false;
  std::size_t triangle = 0;
  SegmentTriangle pair;
};

/// A part of the axis, by its parameters, that lies inside; -1 where its end is an end of the axis.
struct Inside {
  double from = 0.0;
  double to = 1.0;
  int entry = -1;
  int exit = -1;
};

/// Calls f(triangle, pair) for every triangle within `limit` of the axis, with the closest points; f may lower `limit`.
template <class F>
void forEachNear(const ContactSurface& surface, std::span<const Vec3> position, std::span<const std::uint32_t> patches,
                 const Segment& axis, double& limit, F&& f) {
  std::array<std::uint32_t, ContactSurface::maxPatchTriangles> near{};
  for (const std::uint32_t patch : patches) {
    Box box;
    box.include(axis.p0);
    box.include(axis.p1);
    box.grow(limit);
    const std::size_t count = trianglesInBox(surface, position, patch, box, near);
    for (std::size_t first = 0; first < count; first += laneCount) {
      const std::size_t lanes = std::min<std::size_t>(laneCount, count - first);
      TriangleLanes group;
      LaneValues squared;
      gatherTriangles(surface, position, {near.data() + first, lanes}, group);
      segmentTriangleDistances(group, axis.p0, axis.p1, squared);
      for (std::size_t l = 0; l < lanes; ++l) {
        if (!(squared[l] <= limit * limit)) continue;
        const std::size_t i = near[first + l];
        const Index3& t = surface.triangles()[i];
        const Vec3& a = position[static_cast<std::size_t>(t[0])];
        const Vec3& b = position[static_cast<std::size_t>(t[1])];
        const Vec3& c = position[static_cast<std::size_t>(t[2])];
        if (!((b - a).cross(c - a).norm() > 1e-18)) continue;
        f(i, closestSegmentTriangle(axis.p0, axis.p1, a, b, c));
      }
    }
  }
}

class Finder {
 public:
  Finder(const ContactSurface& surface, std::span<const Vec3> position, std::span<const std::uint32_t> patches,
         const Segment& axis, double radius, std::uint64_t pieceKey, std::vector<SurfaceContact>& out)
      : surface_(surface),
        position_(position),
        patches_(patches),
        axis_(axis),
        radius_(radius),
        pieceKey_(pieceKey),
        start_(out.size()),
        out_(out) {}

  void find(double reach) {
    double limit = capsuleSearch(radius_, reach);
    forEachNear(surface_, position_, patches_, axis_, limit, [&](std::size_t i, const SegmentTriangle& pair) {
      if (pair.crosses) {
        const bool inward = (axis_.p1 - axis_.p0).dot(faceNormal(surface_, position_, i)) < 0.0;
        crossing_.push_back({pair.parameter, inward, i, pair.barycentric});
        return;
      }
      if (!nearest_.found || pair.squaredDistance < nearest_.pair.squaredDistance) {
        nearest_ = {true, i, pair};
        // Triangles farther than this and out of reach cannot change the result.
        limit = std::min(limit, std::max(radius_ + reach, std::sqrt(pair.squaredDistance)) * (1.0 + 1e-9));
      }
      offerOutside(i, pair, reach);
    });
    if (crossing_.empty() && !nearest_.found) return;
    findInside();
    order();
  }

 private:
  void offerOutside(std::size_t i, const SegmentTriangle& pair, double reach) {
    const Vec3 away = pair.onSegment - pair.onTriangle;
    const double distance = std::sqrt(pair.squaredDistance);
    if (!(distance <= radius_ + reach) || !(distance > onSurface)) return;
    if (!(away.dot(faceNormal(surface_, position_, i)) > 0.0)) return;
    if (!isLocalMinimum(surface_, position_, i, pair.feature, away)) return;
    push(i, pair.barycentric, away / distance, pair.onSegment, distance - radius_,
         featureKey(surface_, i, pair.feature));
  }

  /// Finds the parts of the axis that are inside, and their contacts.
  void findInside() {
    if (crossing_.empty()) {
      const Vec3 away = nearest_.pair.onSegment - nearest_.pair.onTriangle;
      const Vec3 normal = pseudonormal(surface_, position_, nearest_.triangle, nearest_.pair.feature);
      if (std::sqrt(nearest_.pair.squaredDistance) <= onSurface) {
        push(nearest_.triangle, nearest_.pair.barycentric, outward(nearest_.triangle, nearest_.pair.feature),
             nearest_.pair.onSegment, -radius_, featureKey(surface_, nearest_.triangle, nearest_.pair.feature));
      } else if (away.dot(normal) < 0.0) {
        out_.erase(first(), out_.end());
        part({}, 0);
      }
      return;
    }
    std::sort(crossing_.begin(), crossing_.end(), [](const Crossing& a, const Crossing& b) {
      return a.parameter != b.parameter ? a.parameter < b.parameter : a.triangle < b.triangle;
    });
    std::vector<Inside> parts;
    for (int c = 0; c < static_cast<int>(crossing_.size()); ++c) {
      const Crossing& crossing = crossing_[static_cast<std::size_t>(c)];
      const bool open = !parts.empty() && parts.back().exit < 0;
      if (crossing.inward) {
        // Crossing through an edge: both of its triangles report it.
        if (!open) parts.push_back({crossing.parameter, 1.0, c, -1});
      } else if (open || parts.empty()) {
        if (!open) parts.push_back({0.0, 1.0, -1, -1});
        parts.back().to = crossing.parameter;
        parts.back().exit = c;
      }
    }
    const auto within = [&](const SurfaceContact& contact) {
      const Vec3 d = axis_.p1 - axis_.p0;
      const double s = (contact.onAxis - axis_.p0).dot(d) / d.squaredNorm();
      return std::any_of(parts.begin(), parts.end(), [s](const Inside& p) { return s >= p.from && s <= p.to; });
    };
    out_.erase(std::remove_if(first(), out_.end(), within), out_.end());
    std::uint64_t number = 0;
    for (const Inside& p : parts) part(p, number++);
  }

  /// Adds contacts at both ends and the middle of a part inside.
  void part(const Inside& inside, std::uint64_t number) {
    const double parameter[3] = {inside.from, 0.5 * (inside.from + inside.to), inside.to};
    const int crossing[3] = {inside.entry, -1, inside.exit};
    for (std::size_t k = 0; k < 3; ++k) {
      if (crossing[k] >= 0) {
        const Crossing& c = crossing_[static_cast<std::size_t>(crossing[k])];
        push(c.triangle, c.weight, faceNormal(surface_, position_, c.triangle), axis_.at(c.parameter), -radius_,
             featureKey(surface_, c.triangle, TriangleFeature::face));
        continue;
      }
      const std::uint64_t key = 4 * number + k;
      const Vec3 point = k == 0 ? axis_.p0 : (k == 2 ? axis_.p1 : axis_.at(parameter[1]));
      if (wayOut(point, key) || k == 1) continue;
      // Deeper than the search: measure from the face through which the axis entered.
      const int through = k == 0 ? inside.exit : inside.entry;
      if (through < 0) continue;
      const Crossing& c = crossing_[static_cast<std::size_t>(through)];
      const Vec3 normal = faceNormal(surface_, position_, c.triangle);
      const double depth = std::min(notNegative((axis_.at(c.parameter) - point).dot(normal)), maxAxisDepth);
      push(c.triangle, c.weight, normal, point, -depth - radius_, key);
    }
  }

  /// Adds the contact of an axis point inside with its nearest surface point. @return
  /// false: nothing within maxAxisDepth
  bool wayOut(const Vec3& point, std::uint64_t key) {
    const NearestPoint nearest = nearestPoint(surface_, position_, patches_, point, maxAxisDepth);
    if (!nearest.found) return false;
    const double depth = std::sqrt(nearest.point.squaredDistance);
    Vec3 normal;
    if (depth > onSurface) {
      if (!nearest.inside) return true;
      normal = (nearest.point.point - point) / depth;
    } else {
      normal = outward(nearest.triangle, nearest.point.feature);
    }
    push(nearest.triangle, nearest.point.barycentric, normal, point, -depth - radius_, key);
    return true;
  }

  /// Outward unit normal; the face's own if the normals of a feature's faces cancel.
  [[nodiscard]] Vec3 outward(std::size_t triangle, TriangleFeature feature) const {
    const Vec3 normal = pseudonormal(surface_, position_, triangle, feature);
    const double length = normal.norm();
    return length > 1e-6 ? Vec3(normal / length) : faceNormal(surface_, position_, triangle);
  }

  void push(std::size_t triangle, const Vec3& weight, const Vec3& normal, const Vec3& onAxis, double gap,
            std::uint64_t key) {
    if (!(normal.squaredNorm() > 0.5)) return;  // degenerate triangle
    const Index3& t = surface_.triangles()[triangle];
    SurfaceContact contact;
    contact.node = {t[0], t[1], t[2]};
    contact.weight = weight;
    contact.normal = normal;
    contact.onAxis = onAxis;
    contact.gap = gap;
    contact.key = pieceKey_ | key;
    out_.push_back(contact);
  }

  [[nodiscard]] Vec3 foot(const SurfaceContact& c) const {
    Vec3 p = Vec3::Zero();
    for (std::size_t k = 0; k < 3; ++k) {
      p += c.weight[static_cast<int>(k)] * position_[static_cast<std::size_t>(c.node[k])];
    }
    return p;
  }

  /// Sorts by key and removes duplicate keys and contact points.
  void order() {
    std::stable_sort(first(), out_.end(),
                     [](const SurfaceContact& a, const SurfaceContact& b) { return a.key < b.key; });
    const auto same = [&](const SurfaceContact& a, const SurfaceContact& b) {
      return a.key == b.key ||
             ((a.onAxis - b.onAxis).squaredNorm() < mergeDistance * mergeDistance &&
              a.normal.dot(b.normal) > 1.0 - 1e-9 && (foot(a) - foot(b)).squaredNorm() < mergeDistance * mergeDistance);
    };
    std::size_t kept = start_;
    for (std::size_t i = start_; i < out_.size(); ++i) {
      bool known = false;
      for (std::size_t j = start_; j < kept && !known; ++j) known = same(out_[j], out_[i]);
      if (!known) out_[kept++] = out_[i];
    }
    out_.resize(kept);
  }

  std::vector<SurfaceContact>::iterator first() { return out_.begin() + static_cast<std::ptrdiff_t>(start_); }

  const ContactSurface& surface_;
  std::span<const Vec3> position_;
  std::span<const std::uint32_t> patches_;
  Segment axis_;
  double radius_;
  std::uint64_t pieceKey_;
  std::size_t start_;
  std::vector<SurfaceContact>& out_;
  std::vector<Crossing> crossing_;
  Nearest nearest_;
};

}  // namespace

void capsuleContacts(const ContactSurface& surface, std::span<const Vec3> position,
                     std::span<const std::uint32_t> patches, const Vec3& p0, const Vec3& p1, double radius,
                     double reach, std::uint32_t piece, std::vector<SurfaceContact>& out) {
  Finder(surface, position, patches, {p0, p1}, radius, static_cast<std::uint64_t>(piece) << 56U, out).find(reach);
}

AxisDistance axisDistance(const ContactSurface& surface, std::span<const Vec3> position,
                          std::span<const std::uint32_t> patches, const Vec3& p0, const Vec3& p1, double limit) {
  Nearest nearest;
  bool inside = false;
  const double none = limit;
  forEachNear(surface, position, patches, {p0, p1}, limit, [&](std::size_t i, const SegmentTriangle& pair) {
    inside = inside || pair.crosses;
    if (nearest.found && pair.squaredDistance >= nearest.pair.squaredDistance) return;
    nearest = {true, i, pair};
    limit = std::sqrt(pair.squaredDistance) * (1.0 + 1e-12);
  });
  if (!nearest.found) return {false, false, none};
  const double distance = std::sqrt(nearest.pair.squaredDistance);
  if (!inside && distance > onSurface) {
    const Vec3 away = nearest.pair.onSegment - nearest.pair.onTriangle;
    inside = away.dot(pseudonormal(surface, position, nearest.triangle, nearest.pair.feature)) < 0.0;
  }
  return {true, inside, distance};
}

double minGap(const ContactSurface& surface, std::span<const Vec3> position, std::span<const std::uint32_t> patches,
              const Vec3& p0, const Vec3& p1, double radius, double reach) {
  const AxisDistance nearest =
      axisDistance(surface, position, patches, p0, p1, capsuleSearch(radius, notNegative(reach)));
  if (!nearest.found) return reach;
  if (!nearest.inside) return std::min(reach, nearest.distance - radius);
  std::vector<SurfaceContact> found;
  capsuleContacts(surface, position, patches, p0, p1, radius, notNegative(reach), 0, found);
  double minimum = reach;
  for (const SurfaceContact& c : found) minimum = std::min(minimum, c.gap);
  return minimum;
}

}  // namespace calot
