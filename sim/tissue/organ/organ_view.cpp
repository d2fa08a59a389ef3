// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/geometry/triangle_cells.h"
#include "sim/scene/model.h"
#include "sim/scene/scene_view.h"
#include "sim/scene/state.h"
#include "sim/tissue/tissue_viewer.h"

namespace calot {

namespace {

class OrganViewer final : public TissueViewer {
 public:
  explicit OrganViewer(const Model& model) : model_(model) {
    for (const OrganModel& organ : model.organs()) {
      std::vector<double>& area = vertexArea_.emplace_back(organ.skin.size(), 0.0);
      for (std::size_t t = 0; t < organ.triangleArea.size(); ++t) {
        for (int k = 0; k < 3; ++k)
          area[static_cast<std::size_t>(organ.surface.triangles()[t][k])] += organ.triangleArea[t] / 3.0;
      }
    }
  }

  void addTo(SceneView& view, const State& state) override {
    for (std::size_t o = 0; o < model_.organs().size(); ++o) {
      const OrganModel& organ = model_.organs()[o];
      SurfaceView& surface = view.surface.emplace_back();
      surface.organ = organ.name;
      surface.appearance = organ.appearance;
      surface.role = model_.structures()[o].role;
      surface.rest = organ.skin;
      organ.embedding.map(state.organ[o].position, surface.position);
      surface.triangle = organ.surface.triangles();
      if (state.charred[o].area > 0.0) addChar(organ, state.charred[o], surface);
    }
  }

 private:
  /// At a vertex: mean over the cells around it, each by its area and its weight of that vertex.
  void addChar(const OrganModel& organ, const CharState& charred, SurfaceView& surface) const {
    const double full = model_.scene().cautery.charTime;
    const std::vector<double>& area = vertexArea_[static_cast<std::size_t>(&organ - model_.organs().data())];
    std::vector<double> sum(organ.skin.size(), 0.0);
    for (std::size_t k = 0; k < charred.triangle.size(); ++k) {
      const std::size_t t = charred.triangle[k];
      const std::uint32_t n = organ.division[t];
      const Index3& corner = organ.surface.triangles()[t];
      forEachTriangleCell(n, [&](std::uint32_t cell, const Vec3& weight) {
        const double share = organ.triangleArea[t] / (n * n) * double{charred.charring[charred.firstCell[k] + cell]};
        for (int c = 0; c < 3; ++c) sum[static_cast<std::size_t>(corner[c])] += weight[c] * share;
      });
    }
    for (std::size_t v = 0; v < sum.size(); ++v)
      surface.charred.push_back(area[v] > 0.0 ? static_cast<float>(sum[v] / (area[v] * full)) : 0.0F);
  }

  const Model& model_;
  std::vector<std::vector<double>> vertexArea_;  ///< per organ: a third of the triangles around each vertex (m^2)
};

}  // namespace

std::unique_ptr<TissueViewer> OrganTissue::makeViewer(const Model& model) {
  return std::make_unique<OrganViewer>(model);
}

}  // namespace calot
