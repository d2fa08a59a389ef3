// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/tissue/fat/fat_tissue.h"

#include <algorithm>
#include <limits>

#include "sim/carving/carved_surface.h"
#include "sim/fat/fat_model.h"
#include "sim/geometry/closest_point.h"
#include "sim/geometry/surface_distance.h"
#include "sim/math/linear.h"
#include "sim/scene/model.h"
#include "sim/scene/scene_view.h"
#include "sim/scene/state.h"
#include "sim/tissue/structure.h"

namespace calot {

std::vector<Field> FatAttachmentDescription::fields() {
  using S = FatAttachmentDescription;
  return {
      object("fatAttachment", "Springs between fat and a near organ or vessel"),
      {"to", at<S, &S::to>, sceneName, "Name of that organ or vessel"},
      {"distance", at<S, &S::distance>, "m", above(0, 0.05),
       "Fat no farther from its surface, in the reference configuration, is tied to it"},
      {"stiffness", at<S, &S::stiffness>, "N/m^4", above(0, 1e12), "Stiffness of a unit volume of that fat"},
      {"damping", at<S, &S::damping>, "N s/m^4", within(0, 1e10), "Damping of a unit volume of that fat"},
  };
}

namespace {

/// Size of the patch over which a node of the cubes spreads a force, in their edges.
constexpr double cubeSpread = 0.22;

std::vector<Field> triangleFields() {
  using S = FatDescription;
  return {
      object("fatTriangle", "Fat to be cleared, in the reference configuration: that over or under a triangle"),
      Field("corners", at<S, &S::triangle>, "m", sceneCoordinate, "Its corners, not on one line").items(3, 3),
      {"depth", at<S, &S::triangleDepth>, "m", above(0, 0.1), "Largest distance from its plane"},
  };
}

}  // namespace

std::vector<Field> FatDescription::fields() {
  using S = FatDescription;
  return {
      object("fat", "Fat: a potential field over coarse cubes (docs/explanation/carving.md)"),
      {"name", at<S, &S::name>, sceneName, "Name, unique among organs, vessels and fat"},
      {"appearance", at<S, &S::appearance>, sceneName, "Look that a renderer gives it"},
      roleField(at<S, &S::role>, {StructureRole::triangleFat}),
      {"mesh", at<S, &S::surface>, "Closed surface in W, in the reference configuration"},
      {"cellSize", at<S, &S::cellSize>, "m", within(0.0001, 0.01),
       "Cell of the potential field; from 4 to 496 along each side of the surface's box, at most 16 "
       "million in it"},
      optional("cellsPerCube", at<S, &S::cellsPerCube>, "", within(1, 8), "Cells along the edge of a mechanical cube"),
      {"material", at<S, &S::material>, "Material"},
      optional("friction", at<S, &S::friction>, "", within(0, 2), "Coulomb coefficient of an instrument on it"),
      Field("attachments", at<S, &S::attachments>, "Organs and vessels that it is tied to, each once")
          .items(0, maxStructures),
      optional("triangle", keyGroup<S, triangleFields>, "Part of it that is to be cleared"),
  };
}

Field FatTissue::sceneKey() {
  return optional("fat", at<SceneDescription, &SceneDescription::fat>, "Fat that the energised hook carves")
      .items(0, 4);
}

namespace {

/// Distance of a point from a branch's wall at rest (m).
double distanceFrom(const BeamModel& beams, std::size_t branch, const Vec3& p) {
  const BeamModel::Branch& b = beams.branches()[branch];
  double least = std::numeric_limits<double>::max();
  for (std::size_t i = 0; i + 1 < b.node.size(); ++i) {
    const Vec3& from = beams.rest()[static_cast<std::size_t>(b.node[i])];
    const Vec3& to = beams.rest()[static_cast<std::size_t>(b.node[i + 1])];
    least = std::min(least, (from + closestOnSegment(p, from, to) * (to - from) - p).norm());
  }
  return least - b.section.outerRadius;
}

/// Does a point lie over or under the triangle, no farther from its plane than `depth`?
bool isOverTriangle(const std::array<Vec3, 3>& corner, double depth, const Vec3& p) {
  const Vec3 normal = (corner[1] - corner[0]).cross(corner[2] - corner[0]).normalized();
  const Vec3 foot = p - (p - corner[0]).dot(normal) * normal;
  if ((p - foot).squaredNorm() > depth * depth) return false;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3& from = corner[k];
    const Vec3& to = corner[(k + 1) % 3];
    if ((to - from).cross(foot - from).dot(normal) < 0.0) return false;
  }
  return true;
}

/// A field and its cubes, and what ties them to organs and vessels. @return its fault, or nothing
std::string addFat(const SceneDescription& scene, const FatDescription& description, Model& model) {
  const std::vector<OrganModel>& organs = model.organs();
  const std::vector<VesselTree>& trees = model.vesselTrees();
  const std::string what = "fat '" + description.name + "': ";
  std::vector<std::unique_ptr<SurfaceDistance>> surfaces;
  std::vector<FatPartner> partners;
  struct Partner {
    bool vessel = false;
    std::size_t index = 0;  // organ; vessel tree
    std::size_t branch = 0;
  };
  std::vector<Partner> known;
  for (const FatAttachmentDescription& attachment : description.attachments) {
    FatPartner partner{attachment.to, {}, attachment.distance, attachment.stiffness, attachment.damping};
    Partner& to = known.emplace_back();
    const std::size_t o = indexNamed(organs, attachment.to);
    bool found = o < organs.size();
    if (found) {
      surfaces.push_back(std::make_unique<SurfaceDistance>(scene.organs[o].surface.mesh()));
      partner.distance = [distance = surfaces.back().get()](const Vec3& p) { return distance->signedDistance(p); };
      to = {false, o, 0};
    }
    for (std::size_t t = 0; t < trees.size() && !found; ++t) {
      for (std::size_t b = 0; b < trees[t].vessel.size() && !found; ++b) {
        if (scene.vessels[trees[t].vessel[b]].name != attachment.to) continue;
        partner.distance = [beams = &trees[t].beams, b](const Vec3& p) { return distanceFrom(*beams, b, p); };
        to = {true, t, b};
        found = true;
      }
    }
    if (!found) return what + "hangs on '" + attachment.to + "', which is neither an organ nor a vessel of the scene";
    partners.push_back(std::move(partner));
  }
  std::vector<FatRegion> regions;
  if (description.triangleDepth > 0.0) {
    regions.push_back({"to clear", [&](const Vec3& p) {
                         return isOverTriangle(description.triangle, description.triangleDepth, p);
                       }});
  }
  // Tissue that hides a vessel that is to be divided.
  constexpr double coverDepth = 0.0015;  // m
  for (const DivideDescription& divide : scene.procedure.divide) {
    if (scene.procedure.fat != description.name) break;
    for (const VesselTree& tree : trees) {
      for (std::size_t b = 0; b < tree.vessel.size(); ++b) {
        if (scene.vessels[tree.vessel[b]].name != divide.vessel) continue;
        regions.push_back({divide.vessel, [beams = &tree.beams, b](const Vec3& p) {
                             return distanceFrom(*beams, b, p) <= coverDepth;
                           }});
      }
    }
  }
  FatSettings settings;
  settings.cell = description.cellSize;
  settings.cellsPerCube = static_cast<int>(description.cellsPerCube);
  settings.material = solidMaterial(description.material);
  std::string error;
  std::unique_ptr<FatModel> fat = FatModel::make(description.surface.mesh(), settings, partners, regions, error);
  if (fat == nullptr) return what + error;
  const std::size_t body = model.bodies();
  for (std::size_t p = 0; p < known.size(); ++p) {
    const std::span<const FatTie> ties = fat->ties(p);
    std::vector<Vec3> points;
    points.reserve(ties.size());
    for (const FatTie& tie : ties) points.push_back(tie.rest);
    std::vector<MaterialPoint> places;
    if (!known[p].vessel && !points.empty()) places = pointsOnOrgan(organs[known[p].index], points);
    for (std::size_t i = 0; i < ties.size(); ++i) {
      Tie tie;
      tie.place[1] = ties[i].point;
      tie.stiffness = ties[i].stiffness;
      tie.damping = ties[i].damping;
      tie.fat = model.fat().size();
      tie.fatTie = fat->firstTie(p) + i;
      if (known[p].vessel) {
        const BeamModel& beams = trees[known[p].index].beams;
        const std::vector<int>& nodes = beams.branches()[known[p].branch].node;
        const auto away = [&](int n) {
          return (beams.rest()[static_cast<std::size_t>(n)] - ties[i].rest).squaredNorm();
        };
        const int nearest =
            *std::min_element(nodes.begin(), nodes.end(), [&](int a, int b) { return away(a) < away(b); });
        const auto n = static_cast<std::size_t>(nearest);
        tie.body = {organs.size() + known[p].index, body};
        tie.place[0].node[0] = nearest;
        tie.place[0].weight[0] = 1.0;
        tie.place[0].count = 1;
        tie.offset = beams.restOrientation()[n].conjugate() * (ties[i].rest - beams.rest()[n]);
      } else {
        tie.body = {known[p].index, body};
        tie.place[0] = places[i];
      }
      model.addTie(tie);
    }
  }
  model.fatModel.push_back(std::move(fat));
  return {};
}

}  // namespace

std::string FatTissue::build(const SceneDescription& scene, Model& model) {
  for (const FatDescription& description : scene.fat) {
    if (std::string fault = addFat(scene, description, model); !fault.empty()) return fault;
  }
  return {};
}

void FatTissue::listStructures(const Model& model, TissueId kind, std::size_t firstBody,
                               std::vector<StructureModel>& structures) {
  for (std::size_t f = 0; f < model.fat().size(); ++f) {
    const FatDescription& d = model.scene().fat[f];
    const double edge = d.cellsPerCube * d.cellSize;
    structures.push_back({d.name, d.appearance, d.role, kind, f, 0, firstBody + f, d.friction, &model.fat()[f]->solid(),
                          cubeSpread * edge});
  }
}

const std::string& FatTissue::nameOf(const Model& model, std::size_t index) { return model.scene().fat[index].name; }

void FatTissue::start(const Model& model, States& states) {
  const std::size_t firstBody = model.organs().size() + model.vesselTrees().size();
  for (std::size_t f = 0; f < model.fat().size(); ++f) {
    states.fat.push_back(restState(*model.fat()[f]));
    if (!model.holds(firstBody + f)) states.fat.back().solid.quietSteps = 0;
  }
}

bool FatTissue::fits(const Model& model, const States& states) {
  for (std::size_t f = 0; f < states.fat.size(); ++f) {
    if (!calot::fits(*model.fat()[f], states.fat[f])) return false;
  }
  return true;
}

void FatTissue::resize(const Model& model, Results& results) { results.fat.resize(model.fat().size()); }

namespace {

/// Depth below the uncarved surface at which the hook laid tissue bare, in cells: from, fully.
constexpr double bareFrom = 0.4;
constexpr double bareFully = 1.6;
/// Such tissue is seared, not charred through.
constexpr float searing = 0.3F;

/// One body of fat from view to view.
class FatView {
 public:
  explicit FatView(const FatModel& model);

  /// Fills in vertices, triangles and what the hook has seared; where nothing was carved since the last call, only
  /// the places are new.
  void fill(const FatState& state, SurfaceView& surface);

 private:
  void sear();

  const FatModel& model_;
  CarvedField uncarved_;
  FatPicture picture_;
  std::vector<float> seared_;  ///< per vertex; empty: nothing is carved
};

FatView::FatView(const FatModel& model) : model_(model), uncarved_(model.field()), picture_(model) {}

void FatView::sear() {
  const BrickLattice& lattice = model_.lattice();
  seared_.clear();
  for (const Vec3& rest : picture_.rest()) {
    const Vec3 at = (rest - lattice.origin()) / lattice.cell();
    const double depth = -sampleField(uncarved_, at).value / lattice.cell();
    const double bare = std::min(notNegative((depth - bareFrom) / (bareFully - bareFrom)), 1.0);
    seared_.push_back(searing * static_cast<float>(bare));
  }
}

void FatView::fill(const FatState& state, SurfaceView& surface) {
  if (picture_.update(state.carved)) sear();
  surface.rest = picture_.rest();
  surface.triangle = picture_.triangles();
  if (!state.carved.brick.empty()) surface.charred = seared_;
  picture_.positions(state.solid.position, surface.position);
}

class FatViewer final : public TissueViewer {
 public:
  explicit FatViewer(const Model& model) : model_(model) {
    for (const auto& fat : model.fat()) fat_.push_back(std::make_unique<FatView>(*fat));
  }

  void addTo(SceneView& view, const State& state) override {
    for (std::size_t f = 0; f < fat_.size(); ++f) {
      const FatDescription& description = model_.scene().fat[f];
      SurfaceView& surface = view.surface.emplace_back();
      surface.organ = description.name;
      surface.appearance = description.appearance;
      surface.role = description.role;
      fat_[f]->fill(state.fat[f], surface);
    }
  }

 private:
  const Model& model_;
  std::vector<std::unique_ptr<FatView>> fat_;
};

}  // namespace

std::unique_ptr<TissueViewer> FatTissue::makeViewer(const Model& model) { return std::make_unique<FatViewer>(model); }

}  // namespace calot
