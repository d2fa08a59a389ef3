// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/step/penetration_resolver.h"

#include <algorithm>
#include <array>

#include "sim/contact/contact_solver.h"
#include "sim/step/contact_dimples.h"

namespace calot {

namespace {

constexpr int maxPasses = 6;              ///< of one search; more find nothing better (measured on folds)
constexpr double toleratedDepth = 2e-5;   ///< m; deeper is worth another pass
constexpr double maxDisplacement = 0.02;  ///< of a tip, by all passes of one search (m): the first may lead astray
/// The longest way out over the depth: tissue that presses from two sides a tenth of a millimetre too close is no
/// reason to leave its fold. Assumed; measured on folds.
constexpr double wayForDepth = 10.0;
constexpr double pinchedCosine = -0.25;  ///< normals that face each other more than this press from two sides
/// Along the shaft (m), where the nearest way out fails. Assumed.
constexpr std::array<double, 4> retreats{0.002, 0.005, 0.01, 0.02};

}  // namespace

void allowDepth(double allowed, double far, std::size_t from, std::vector<SurfaceContact>& contacts) {
  const auto first = contacts.begin() + static_cast<std::ptrdiff_t>(from);
  for (auto contact = first; contact != contacts.end(); ++contact) contact->gap += allowed;
  contacts.erase(std::remove_if(first, contacts.end(), [far](const SurfaceContact& c) { return !(c.gap < far); }),
                 contacts.end());
}

/// The deepest that the placed instrument stands in any structure or in the other instrument, and every point where it
/// does.
double PenetrationResolver::findInside(Surfaces& surfaces, const State& state, std::size_t hand, const Pose& pose) {
  const Vec3& port = model_.scene().hands[hand].port;
  inside_.clear();
  double depth = 0.0;
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    found_.clear();
    for (const Capsule& c : instrument_.capsule) {
      const Vec3 dimple = dimpleOf(state.hand[hand], s, c.piece);
      const Vec3 p0 = c.p0 + dimple;
      const Vec3 p1 = c.p1 + dimple;
      const std::span<const std::uint32_t> near = surfaces.patchesNear(s, p0, p1, capsuleSearch(c.radius, 0.0));
      const std::size_t before = found_.size();
      capsuleContacts(surfaces.mesh(s), surfaces.points(s), near, p0, p1, c.radius, 0.0, c.piece, found_);
      if (const double allowed = allowedDepth(model_, state, hand, c, s); allowed > 0.0)
        allowDepth(allowed, 0.0, before, found_);
    }
    for (const SurfaceContact& contact : found_) {
      if (!(contact.gap < 0.0)) continue;
      inside_.push_back({toolRow(port, pose, contact.onAxis, contact.normal), contact.normal, contact.gap});
      depth = std::max(depth, -contact.gap);
    }
  }
  clashPoints(instrument_, other_, 0.0, clash_);
  for (const ClashPoint& point : clash_) {
    inside_.push_back({toolRow(port, pose, point.onA, point.normal), point.normal, point.gap});
    depth = std::max(depth, -point.gap);
  }
  return depth;
}

/// The shortest motion of the instrument that leaves every point in `inside_`: a small complementarity problem without
/// tissue. Tip motion costs as its square; a roll as the motion of a point 5 mm from the axis.
ToolRow PenetrationResolver::minWayOut() const {
  constexpr double arm2 = 0.005 * 0.005;
  const std::size_t n = inside_.size();
  const std::vector<double> none(n, 0.0);
  const std::vector<BlockKind> kind(n, BlockKind::unilateral);
  std::vector<double> w(n * n);
  std::vector<double> free(n);
  std::vector<double> gaps(n);
  std::vector<double> force(n, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    free[i] = inside_[i].gap;
    for (std::size_t j = 0; j < n; ++j) {
      w[i * n + j] =
          inside_[i].row.head<3>().dot(inside_[j].row.head<3>()) + inside_[i].row[3] * inside_[j].row[3] / arm2;
    }
    w[i * n + i] *= 1.01;  // rows that repeat each other stay solvable
  }
  sweepContacts({kind, none, w, free}, force, gaps, 0.1 * toleratedDepth, 50);
  ToolRow q = ToolRow::Zero();
  for (std::size_t i = 0; i < n; ++i) q += force[i] * inside_[i].row;
  q[3] /= arm2;
  return q;
}

/// Follows minWayOut() from a pose, pass by pass. Keeps the best pose met: folds and pinches may lead a pass
/// astray.
PenetrationResolver::Outcome PenetrationResolver::search(Surfaces& surfaces, const State& state, std::size_t hand,
                                                         Pose pose) {
  const HandState& s = state.hand[hand];
  const HandDescription& description = model_.scene().hands[hand];
  Outcome best{pose, 1e300, false};
  double gone = 0.0;
  double mayGo = maxDisplacement;
  for (int pass = 0;; ++pass) {
    instrument_.place(description, s.instrument, pose, s.jaw);
    const double depth = findInside(surfaces, state, hand, pose);
    if (pass == 0) mayGo = std::min(mayGo, wayForDepth * depth);
    if (depth < best.depth) {
      best = {pose, depth, false};
      for (const Inside& a : inside_) {
        for (const Inside& b : inside_) best.pinched = best.pinched || a.normal.dot(b.normal) < pinchedCosine;
      }
    }
    if (depth <= toleratedDepth || pass >= maxPasses || gone >= mayGo) return best;
    const ToolRow q = minWayOut();
    Vec3 way = q.head<3>();
    const double size = way.norm();
    const double limit = std::min(mayGo - gone, 3.0 * depth);
    if (size > limit) way *= limit / size;
    gone += std::min(size, limit);
    pose = movedTool(description.port, pose, way, std::clamp(q[3], -0.2, 0.2));
  }
}

void PenetrationResolver::run(Surfaces& surfaces, std::size_t hand, State& state, ContactResult& contact) {
  HandState& s = state.hand[hand];
  if (s.instrument == InstrumentKind::none) return;
  const Vec3& port = model_.scene().hands[hand].port;
  const Pose from = simulatedPose(s);
  const HandState& neighbour = state.hand[1 - hand];
  other_.place(model_.scene().hands[1 - hand], neighbour.instrument, simulatedPose(neighbour), neighbour.jaw);
  Outcome best = search(surfaces, state, hand, from);
  const double longest = wayForDepth * best.depth;
  for (const double retreat : retreats) {
    if (best.depth <= toleratedDepth || retreat > longest) break;
    const Vec3 back = from.orientation * Vec3(0.0, 0.0, -retreat);
    const Outcome other = search(surfaces, state, hand, movedTool(port, from, back, 0.0));
    if (other.depth < best.depth) best = other;
  }
  s.simulatedPosition = best.pose.position;
  s.simulatedOrientation = best.pose.orientation;
  double& left = best.pinched ? contact.pinchedDepth : contact.maxDepth;
  left = std::max(left, best.depth);
}

}  // namespace calot
