// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/scene/model.h"

#include <algorithm>
#include <array>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "sim/math/floating_point.h"
#include "sim/scene/state.h"

namespace calot {

Model::Built Model::build(SceneDescription scene) {
  const FloatingPointScope floatingPoint;
  Built built;
  const std::size_t structures = scene.organs.size() + scene.vessels.size() + scene.fat.size();
  if (structures > maxStructures) {
    built.error = std::to_string(structures) + " structures (organs, vessels and bodies of fat); at most " +
                  std::to_string(maxStructures) + " are allowed";
    return built;
  }
  std::unique_ptr<Model> model(new Model);
  model->scene_ = std::move(scene);
  Tissues::forEach([&]<class Kind>(std::type_identity<Kind>, TissueId) {
    if (built.error.empty()) built.error = Kind::build(model->scene_, *model);
  });
  if (!built.error.empty()) return built;
  std::size_t firstBody = 0;
  Tissues::forEach([&]<class Kind>(std::type_identity<Kind>, TissueId kind) {
    Kind::listStructures(*model, kind, firstBody, model->structure_);
    firstBody += Kind::bodies(*model);
  });
  built.error = model->addProcedure(model->scene_);
  if (built.error.empty()) built.error = model->addRetractions(model->scene_);
  if (!built.error.empty()) return built;
  model->carryWeight();
  model->layout_ = digestLayout(*model);
  built.model = std::move(model);
  return built;
}

std::size_t Model::bodies() const {
  std::size_t count = 0;
  Tissues::forEach([&]<class Kind>(std::type_identity<Kind>, TissueId) { count += Kind::bodies(*this); });
  return count;
}

std::size_t Model::structureNamed(const std::string& name) const { return indexNamed(structure_, name); }

// A Model's procedure and retractions.

namespace {

/// Strands of a bed in three parts of a third of its area each, by how far they are from a point on the specimen.
std::array<std::vector<std::uint32_t>, 3> thirdsOf(const ConnectiveTissue& tissue, bool specimenIsA,
                                                   std::span<const Vec3> rest, const Vec3& from) {
  const std::vector<Strand>& strands = tissue.strands();
  std::vector<std::uint32_t> order(strands.size());
  std::vector<double> away(strands.size());
  for (std::size_t s = 0; s < strands.size(); ++s) {
    order[s] = static_cast<std::uint32_t>(s);
    away[s] = ((specimenIsA ? strands[s].a : strands[s].b).of(rest) - from).norm();
  }
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return away[a] != away[b] ? away[a] < away[b] : a < b; });
  std::array<std::vector<std::uint32_t>, 3> third;
  double area = 0.0;
  std::size_t at = 0;
  for (std::size_t part = 0; part < third.size(); ++part) {
    const double until = tissue.area() * static_cast<double>(part + 1) / 3.0;
    const bool last = part + 1 == third.size();
    while (at < order.size() && (last || area < until)) {
      third[part].push_back(order[at]);
      area += strands[order[at++]].area;
    }
    std::sort(third[part].begin(), third[part].end());
  }
  return third;
}

}  // namespace

/// Checks the procedure's names; finds what a step reports of it. @return its fault, or nothing
std::string Model::addProcedure(const SceneDescription& scene) {
  const ProcedureDescription& d = scene.procedure;
  if (d.specimen.empty()) return {};
  const std::size_t specimen = indexNamed(scene.organs, d.specimen);
  if (specimen == scene.organs.size()) return "procedure: the scene has no organ '" + d.specimen + "'";
  const std::size_t bed = indexNamed(scene.connective, d.bed);
  if (!d.bed.empty()) {
    if (bed == scene.connective.size()) return "procedure: the scene has no connective tissue '" + d.bed + "'";
    if (connective()[bed].a != specimen && connective()[bed].b != specimen) {
      return "procedure: connective tissue '" + d.bed + "' does not hold '" + d.specimen + "'";
    }
  }
  const std::size_t fat = indexNamed(scene.fat, d.fat);
  if (!d.fat.empty() && fat == scene.fat.size()) return "procedure: the scene has no fat '" + d.fat + "'";
  for (const DivideDescription& divide : d.divide) {
    const std::size_t vessel = indexNamed(scene.vessels, divide.vessel);
    if (vessel == scene.vessels.size()) return "procedure: the scene has no vessel '" + divide.vessel + "'";
    if (fat == scene.fat.size()) continue;
    for (std::size_t r = 0; r < this->fat()[fat]->regions(); ++r) {
      if (this->fat()[fat]->regionName(r) == divide.vessel) cover_.push_back({vessel, fat, r});
    }
  }
  for (const std::string& name : d.spare) {
    if (indexNamed(scene.vessels, name) == scene.vessels.size())
      return "procedure: the scene has no vessel '" + name + "'";
  }
  if (!d.bed.empty() && !d.divide.empty()) {
    const StructureModel& first = structure_[structureNamed(d.divide[0].vessel)];
    const BeamModel& beams = vesselTrees()[first.index].beams;
    const std::vector<int>& node = beams.branches()[first.branch].node;
    const int end = d.divide[0].patientAtStart ? node.back() : node.front();
    ConnectiveModel& tissue = connectiveModel[bed];
    tissue.third = thirdsOf(tissue.tissue, tissue.a == specimen, organs()[specimen].solid.rest(),
                            beams.rest()[static_cast<std::size_t>(end)]);
  }
  return {};
}

/// @return their fault, or nothing
std::string Model::addRetractions(const SceneDescription& scene) {
  for (const RetractionDescription& d : scene.retraction) {
    RetractionModel& out = retraction_.emplace_back();
    out.organ = indexNamed(organs(), d.organ);
    if (out.organ == organs().size()) return "retraction: the scene has no organ '" + d.organ + "'";
    const std::vector<Vec3>& rest = organs()[out.organ].solid.rest();
    for (std::size_t n = 0; n < rest.size(); ++n) {
      if ((rest[n] - d.centre).norm() <= d.radius) out.node.push_back(static_cast<int>(n));
    }
    if (out.node.empty()) return "retraction: no node of '" + d.organ + "' lies inside its sphere";
  }
  return {};
}

}  // namespace calot
