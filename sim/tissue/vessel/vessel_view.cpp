// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>
#include <utility>

#include "sim/math/elementary.h"
#include "sim/math/linear.h"
#include "sim/scene/model.h"
#include "sim/scene/scene_view.h"
#include "sim/scene/state.h"
#include "sim/tissue/structure.h"
#include "sim/vessel/beam_state.h"
#include "sim/vessel/tube_surface.h"

namespace calot {

namespace {

/// Rounder and smoother than contact has it.
constexpr TubeSurface::Settings pictureTube{12, 2};

/// The rim of a cut draws together by this share of its radius, and is stained (SurfaceView::face).
constexpr double inwards = 0.3;
constexpr float stained = 0.45F;
constexpr double stainReach = 0.0012;  ///< from the cut along the vessel (m)

constexpr int domeRings = 5;
/// A vessel that comes from elsewhere is drawn on for this length beyond where it is held (m).
constexpr double beyond = 0.08;

/// In place of the flat cap at an end: a dome, which rounds the bend where a vessel grows out of another.
/// @param ring first vertex of the end's ring, @param cap first triangle of its cap, @param away how far beyond (m)
void addDome(int ring, std::size_t cap, double away, SurfaceView& surface) {
  constexpr int sides = static_cast<int>(pictureTube.sides);
  const bool atEnd = ring > 0;
  const int middle = surface.triangle[cap][0];
  const int first = static_cast<int>(surface.position.size());
  for (std::vector<Vec3>* place : {&surface.position, &surface.rest}) {
    const Vec3 centre = (*place)[slot(middle)];
    Vec3 area = Vec3::Zero();
    for (int k = 0; k < sides; ++k)
      area += ((*place)[slot(ring + k)] - centre).cross((*place)[slot(ring + (k + 1) % sides)] - centre);
    const double size = area.norm();
    if (!(size > 0.0)) return;
    const double radius = ((*place)[slot(ring)] - centre).norm();
    const Vec3 outwards = (atEnd ? 1.0 : -1.0) * area / size;
    for (int d = 0; d < domeRings; ++d) {
      const double angle = 0.5 * std::numbers::pi * d / domeRings;
      for (int k = 0; k < sides; ++k) {
        const Vec3 p = (*place)[slot(ring + k)];
        place->push_back(centre + cosine(angle) * (p - centre) + (away + radius * sine(angle)) * outwards);
      }
    }
    (*place)[slot(middle)] = centre + (away + radius) * outwards;
  }
  surface.charred.resize(surface.position.size(), surface.charred[slot(middle)]);
  const auto strip = [&](int from, int to) {
    for (int k = 0; k < sides; ++k) {
      const int next = (k + 1) % sides;
      const int a = from + k;
      const int b = from + next;
      const int c = to + next;
      const int d = to + k;
      surface.triangle.push_back(atEnd ? Index3(a, b, c) : Index3(a, c, b));
      surface.triangle.push_back(atEnd ? Index3(a, c, d) : Index3(a, d, c));
    }
  };
  for (int k = 0; k < sides; ++k)
    surface.triangle[cap + slot(k)].tail<2>().array() += first + (domeRings - 1) * sides - ring;
  strip(ring, first);
  for (int d = 0; d + 1 < domeRings; ++d) strip(first + d * sides, first + (d + 1) * sides);
}

/// Cautery at a place: linear between stations.
double exposureAt(const BeamModel& beams, const BeamState& vessels, const BeamPoint& where) {
  const auto& branch = beams.branches()[where.branch];
  const double last = static_cast<double>(branch.stations - 1);
  const double at = std::min(notNegative(where.arcLength / branch.spacing() - 0.5), last);
  const auto before = static_cast<std::size_t>(at);
  const std::size_t after = std::min(before + 1, branch.stations - 1);
  const double* const exposure = vessels.exposure.data() + branch.firstStation;
  return exposure[before] + (at - static_cast<double>(before)) * (exposure[after] - exposure[before]);
}

/// Blood on the skin beside a cut.
void stain(const Vec3& middle, double rim, SurfaceView& surface) {
  const double radius = rim / (1.0 - inwards);
  for (std::size_t v = 0; v < surface.face.size(); ++v) {
    if (surface.face[v] >= 1.0F) continue;
    const double along2 = (surface.rest[v] - middle).squaredNorm() - radius * radius;
    const double along = std::sqrt(notNegative(along2)) / stainReach;
    if (along < 1.0) surface.face[v] = std::max(surface.face[v], stained * static_cast<float>(1.0 - along));
  }
}

/// The faces of cuts get vertices of their own, so that their edge is one: of each parted element the last 2 `sides`
/// triangles are faces (tube_surface.h).
/// @param open does each face, in this order, bleed or leak?
void sharpenFaces(const std::vector<bool>& open, SurfaceView& surface) {
  if (open.empty()) return;
  const std::size_t partings = open.size() / 2;
  constexpr std::size_t sides = pictureTube.sides;
  surface.face.assign(surface.position.size(), 0.0F);
  const std::size_t first = surface.triangle.size() - partings * 4 * sides;
  for (std::size_t f = 0; f < 2 * partings; ++f) {
    const std::size_t from = first + (f / 2 * 4 + 2 + f % 2) * sides;
    const std::span<Index3> face = std::span(surface.triangle).subspan(from, sides);  // middle first, then the ring
    int ring = face[0][1];
    for (const Index3& t : face) ring = std::min(ring, t[1]);
    const int middle = face[0][0];
    surface.face[slot(middle)] = open[f] ? 2.0F : 1.5F;  // no lumen is seen where a clip keeps it shut
    const int copy = static_cast<int>(surface.position.size());
    for (int k = 0; k < static_cast<int>(sides); ++k) {
      for (std::vector<Vec3>* place : {&surface.position, &surface.rest}) {
        Vec3& rim = (*place)[slot(ring + k)];
        rim += inwards * ((*place)[slot(middle)] - rim);
      }
      surface.position.push_back(Vec3(surface.position[slot(ring + k)]));
      surface.rest.push_back(Vec3(surface.rest[slot(ring + k)]));
      surface.charred.push_back(float{surface.charred[slot(ring + k)]});
      surface.face.push_back(1.0F);
    }
    for (Index3& t : face) t.tail<2>().array() += copy - ring;
    stain(surface.rest[slot(middle)], (surface.rest[slot(copy)] - surface.rest[slot(middle)]).norm(), surface);
  }
}

Quat aboutZ(double angle) { return {cosine(0.5 * angle), 0.0, 0.0, sine(0.5 * angle)}; }

/// State knows in which direction a clip flattens, not from which side it came. Appliers come from the ports: the
/// crotch is put towards them, judged at rest, so that it never jumps.
bool crotchAhead(const Model& model, const Pose& rest, double roll) {
  Vec3 ports = Vec3::Zero();
  for (const HandDescription& hand : model.scene().hands) ports += hand.port / static_cast<double>(handCount);
  return (ports - rest.position).dot(rest.orientation * aboutZ(roll) * Vec3::UnitY()) > 0.0;
}

/// For each parting of a branch, the face before and the face after it: open, judged as when it was parted, with the
/// clips that are there now?
std::vector<bool> openFaces(const BeamModel& beams, const BeamState& vessels, std::size_t which) {
  std::vector<bool> open;
  const auto& branch = beams.branches()[which];
  for (std::size_t element = 0; element < branch.elements(); ++element) {
    const std::size_t e = branch.firstElement + element;
    if (vessels.parting[e] == Parting::none) continue;
    BeamState whole = vessels;
    whole.parting[e] = Parting::none;
    const double share = vessels.partedAt[e];
    const double place =
        branch.arcLength[element] + share * (branch.arcLength[element + 1] - branch.arcLength[element]);
    const CutSides judged = cutSides(beams, whole, {which, e, share, place});
    open.push_back(judged.opensBefore);
    open.push_back(judged.opensAfter);
  }
  return open;
}

/// One vessel from view to view.
class VesselView {
 public:
  /// @param structure of `model`, a vessel; both outlive this
  VesselView(const Model& model, const StructureModel& structure);

  /// Fills in all but name and appearance; places alone are worked out where nothing was parted since the last call.
  void fill(const State& state, SurfaceView& surface);
  [[nodiscard]] const StructureModel& structure() const { return structure_; }

 private:
  void layRest(const BeamState& vessels);
  void addChar(const BeamState& vessels, SurfaceView& surface) const;

  const Model& model_;
  const StructureModel& structure_;
  const VesselTree& tree_;
  TubeSurface tube_;
  std::vector<Vec3> rest_;  ///< of the tube, with its partings
};

VesselView::VesselView(const Model& model, const StructureModel& structure)
    : model_(model),
      structure_(structure),
      tree_(model.vesselTrees()[structure.index]),
      tube_(tree_.beams, structure.branch, pictureTube) {
  layRest(restState(tree_.beams));
}

void VesselView::layRest(const BeamState& vessels) {
  BeamState rest = restState(tree_.beams);
  rest.parting = vessels.parting;
  rest.partedAt = vessels.partedAt;
  tube_.positions(rest, rest_);
}

void VesselView::addChar(const BeamState& vessels, SurfaceView& surface) const {
  const double through = model_.scene().vessels[tree_.vessel[structure_.branch]].burnThrough;
  for (std::size_t v = 0; v < tube_.vertices(); ++v) {
    const BeamPoint where = tube_.where(static_cast<int>(v));
    surface.charred.push_back(static_cast<float>(exposureAt(tree_.beams, vessels, where) / through));
  }
}

void VesselView::fill(const State& state, SurfaceView& surface) {
  const BeamState& vessels = state.vessel[structure_.index];
  if (tube_.update(vessels)) layRest(vessels);
  tube_.positions(vessels, surface.position);
  surface.rest = rest_;
  surface.triangle = tube_.triangles();
  addChar(vessels, surface);
  const auto& branch = tree_.beams.branches()[structure_.branch];
  sharpenFaces(openFaces(tree_.beams, vessels, structure_.branch), surface);
  const VesselDescription& description = model_.scene().vessels[tree_.vessel[structure_.branch]];
  const std::size_t last = pictureTube.ringsPerElement * branch.elements();  // ring
  const std::size_t caps = 2 * pictureTube.sides * last;
  const bool fromElsewhere = description.start.kind == VesselEndDescription::Kind::fixed;
  addDome(0, caps, fromElsewhere ? beyond : 0.0, surface);
  addDome(static_cast<int>(pictureTube.sides * last), caps + pictureTube.sides, 0.0, surface);
  if (!surface.face.empty()) surface.face.resize(surface.position.size(), 0.0F);
  if (std::none_of(surface.charred.begin(), surface.charred.end(), [](float c) { return c > 0.0F; }))
    surface.charred.clear();
}

void addClips(const Model& model, const State& state, SceneView& view) {
  for (std::size_t t = 0; t < model.vesselTrees().size(); ++t) {
    const BeamModel& beams = model.vesselTrees()[t].beams;
    const BeamState& vessels = state.vessel[t];
    for (std::size_t c = 0; c < vessels.clips(); ++c) {
      const BeamPoint where = pointAt(beams, vessels.clipBranch[c], vessels.clipPlace[c]);
      const Pose frame = centreLine(beams, vessels, where, stumpAt(vessels, where));
      ClipView clip;
      clip.pose = {frame.position, frame.orientation * aboutZ(vessels.clipRoll[c])};
      if (crotchAhead(model, centreLine(beams, restState(beams), where), vessels.clipRoll[c]))
        clip.pose.orientation = clip.pose.orientation * aboutZ(std::numbers::pi);
      clip.width = vessels.clipWidth[c];
      clip.legs = model.scene().clip.legs;
      clip.halfGap = pinchedSection(beams.branches()[where.branch].section, vessels.clipClosure[c]).thin;
      view.clip.push_back(clip);
    }
  }
}

class VesselViewer final : public TissueViewer {
 public:
  explicit VesselViewer(const Model& model) : model_(model) {
    for (const StructureModel& structure : model.structures()) {
      if (structure.kind == tissueId<VesselTissue>) vessel_.emplace_back(model, structure);
    }
  }

  void addTo(SceneView& view, const State& state) override {
    for (VesselView& vessel : vessel_) {
      SurfaceView& surface = view.surface.emplace_back();
      surface.organ = vessel.structure().name;
      surface.appearance = vessel.structure().appearance;
      surface.role = vessel.structure().role;
      vessel.fill(state, surface);
    }
    addClips(model_, state, view);
  }

 private:
  const Model& model_;
  std::vector<VesselView> vessel_;
};

}  // namespace

std::unique_ptr<TissueViewer> VesselTissue::makeViewer(const Model& model) {
  return std::make_unique<VesselViewer>(model);
}

}  // namespace calot
