// SPDX-License-Identifier: GPL-3.0-or-later
// The part of a Model that says what is to be done, and what an assistant does.
#include <algorithm>
#include <string>
#include <vector>

#include "sim/scene/model.h"

namespace calot {

namespace {

/// Strands whose places on the specimen are the nearest to a point, up to a third of the bed's area.
std::vector<std::uint32_t> lowerThirdOf(const ConnectiveTissue& tissue, bool specimenIsA, std::span<const Vec3> rest,
                                        const Vec3& from) {
  const std::vector<Strand>& strands = tissue.strands();
  std::vector<std::uint32_t> order(strands.size());
  std::vector<double> away(strands.size());
  for (std::size_t s = 0; s < strands.size(); ++s) {
    order[s] = static_cast<std::uint32_t>(s);
    away[s] = ((specimenIsA ? strands[s].a : strands[s].b).of(rest) - from).norm();
  }
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return away[a] != away[b] ? away[a] < away[b] : a < b; });
  double area = 0.0;
  std::size_t count = 0;
  while (count < order.size() && area < tissue.area() / 3.0) area += strands[order[count++]].area;
  order.resize(count);
  std::sort(order.begin(), order.end());
  return order;
}

}  // namespace

/// @return what is wrong with it, or nothing
std::string Model::addProcedure(const SceneDescription& scene) {
  const ProcedureDescription& d = scene.procedure;
  if (d.specimen.empty()) return {};
  ProcedureModel& out = procedure_;
  out.present = true;
  while (out.specimen < organs_.size() && organs_[out.specimen].name != d.specimen) ++out.specimen;
  if (out.specimen == organs_.size()) return "procedure: the scene has no organ '" + d.specimen + "'";
  for (std::size_t c = 0; c < connective_.size(); ++c) {
    if (connective_[c].name == d.bed) out.bed = c;
  }
  if (!d.bed.empty()) {
    if (out.bed == ProcedureModel::none) return "procedure: the scene has no connective tissue '" + d.bed + "'";
    const ConnectiveModel& bed = connective_[out.bed];
    if (bed.a != out.specimen && bed.b != out.specimen) {
      return "procedure: connective tissue '" + d.bed + "' does not hold '" + d.specimen + "'";
    }
  }
  for (std::size_t f = 0; f < scene.fat.size(); ++f) {
    if (scene.fat[f].name != d.fat) continue;
    out.fat = f;
    if (scene.fat[f].triangleDepth > 0.0) out.clearRegion = 0;
  }
  if (!d.fat.empty() && out.fat == ProcedureModel::none) return "procedure: the scene has no fat '" + d.fat + "'";
  const auto vessel = [&](const std::string& name, std::size_t& structure) {
    structure = structureNamed(name);
    return structure < structure_.size() && structure_[structure].kind == StructureKind::vessel;
  };
  for (const DivideDescription& divide : d.divide) {
    ProcedureModel::Divide& to = out.divide.emplace_back();
    if (!vessel(divide.vessel, to.structure)) return "procedure: the scene has no vessel '" + divide.vessel + "'";
    if (out.fat == ProcedureModel::none) continue;
    for (std::size_t r = 0; r < fat_[out.fat]->regions(); ++r) {
      if (fat_[out.fat]->regionName(r) == divide.vessel) to.coverRegion = r;
    }
  }
  for (const std::string& name : d.spare) {
    if (!vessel(name, out.spare.emplace_back())) return "procedure: the scene has no vessel '" + name + "'";
  }
  if (out.bed != ProcedureModel::none && !d.divide.empty()) {
    const StructureModel& first = structure_[out.divide[0].structure];
    const BeamModel& beams = vesselTree_[first.index].beams;
    const std::vector<int>& node = beams.branches()[first.branch].node;
    const int end = d.divide[0].patientAtStart ? node.back() : node.front();
    const ConnectiveModel& bed = connective_[out.bed];
    out.lowerThird = lowerThirdOf(bed.tissue, bed.a == out.specimen, organs_[out.specimen].solid.rest(),
                                  beams.rest()[static_cast<std::size_t>(end)]);
  }
  return {};
}

/// @return what is wrong with them, or nothing
std::string Model::addRetractions(const SceneDescription& scene) {
  for (const RetractionDescription& d : scene.retraction) {
    RetractionModel& out = retraction_.emplace_back();
    while (out.organ < organs_.size() && organs_[out.organ].name != d.organ) ++out.organ;
    if (out.organ == organs_.size()) return "retraction: the scene has no organ '" + d.organ + "'";
    const std::vector<Vec3>& rest = organs_[out.organ].solid.rest();
    for (std::size_t n = 0; n < rest.size(); ++n) {
      if ((rest[n] - d.centre).norm() <= d.radius) out.node.push_back(static_cast<int>(n));
    }
    if (out.node.empty()) return "retraction: no node of '" + d.organ + "' lies inside its sphere";
  }
  return {};
}

}  // namespace calot
