// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/fat/fat_model.h"

#include <algorithm>
#include <cmath>

#include "sim/carving/carved_field.h"
#include "sim/geometry/closest_point_transform.h"
#include "sim/math/floating_point.h"

namespace calot {

namespace {

constexpr int marginCells = 3;                 ///< of the lattice around the surface
constexpr std::uint32_t nodesOfBlock = 192;    ///< lattice edges of a block, each with one index in contact
constexpr std::uint32_t maxNodes = 1U << 25U;  ///< ContactSurface
constexpr int maxCellsPerCube = 16;

/// Calls visit(node, its coordinates) for the inside nodes of a field, ascending.
template <class Visit>
void forEachInside(const FieldModel& field, Visit&& visit) {
  for (std::uint32_t n = 0; n < field.value.size(); ++n) {
    if (field.value[n] < 0.0) visit(n, field.lattice.nodeAt(n));
  }
}

std::string settingsFault(const FatSettings& s) {
  const auto positive = [](double v) { return std::isfinite(v) && v > 0.0; };
  const auto notNegative = [](double v) { return std::isfinite(v) && v >= 0.0; };
  if (!positive(s.cell)) return "the cell size must be positive";
  if (s.cellsPerCube < 1 || s.cellsPerCube > maxCellsPerCube) {
    return "cells per cube must be 1 to " + std::to_string(maxCellsPerCube);
  }
  if (!positive(s.material.density)) return "the density must be positive";
  if (!positive(s.material.lame.mu) || !notNegative(s.material.lame.lambda)) {
    return "the material must be stiff: positive Young's modulus, Poisson's ratio from 0 to below 0.5";
  }
  if (!notNegative(s.material.massDamping) || !notNegative(s.material.stiffnessDamping)) {
    return "damping must not be negative";
  }
  return {};
}

std::string partnerFault(const FatPartner& p) {
  const auto notNegative = [](double v) { return std::isfinite(v) && v >= 0.0; };
  if (!notNegative(p.reach)) return "the distance to " + p.name + " must not be negative";
  if (!(std::isfinite(p.stiffness) && p.stiffness > 0.0))
    return "the stiffness towards " + p.name + " must be positive";
  if (!notNegative(p.damping)) return "the damping towards " + p.name + " must not be negative";
  return {};
}

}  // namespace

std::unique_ptr<FatModel> FatModel::make(const TriangleMesh& surface, const FatSettings& settings,
                                         std::span<const FatPartner> partners, std::span<const FatRegion> regions,
                                         std::string& error) {
  const FloatingPointScope scope;
  error = settingsFault(settings);
  for (const FatPartner& p : partners) {
    if (error.empty()) error = partnerFault(p);
  }
  if (!error.empty()) return nullptr;
  std::unique_ptr<FatModel> model(new FatModel);
  model->k_ = settings.cellsPerCube;
  error = model->cast(surface, settings.cell);
  if (!error.empty()) return nullptr;
  model->attach(partners);
  if (model->anchor_.empty()) {
    error = "it hangs on nothing: no part of it is within reach of what it is attached to";
    return nullptr;
  }
  model->removeLoose();
  error = model->divide(settings.material);
  if (!error.empty()) return nullptr;
  model->tie(partners);
  model->rankBlocks();
  if (model->block_.size() > maxNodes / nodesOfBlock) {
    error = "its cells are too fine: choose a larger cell size";
    return nullptr;
  }
  const BrickLattice& lattice = model->lattice();
  for (const FatRegion& region : regions) {
    model->regionName_.push_back(region.name);
    std::vector<BrickBits>& bits = model->region_.emplace_back(lattice.brickCount(), BrickBits{});
    forEachIndex(Index3::Zero(), lattice.nodes().array() - 1, [&](const Index3& n) {
      if (!region.contains(lattice.position(n))) return;
      const std::uint32_t node = lattice.node(n);
      bits[node / BrickLattice::brickNodes][node >> 6U & 7U] |= std::uint64_t{1} << (node & 63U);
    });
  }
  return model;
}

std::string FatModel::cast(const TriangleMesh& surface, double cell) {
  if (surface.triangle.empty()) return "its surface has no triangles";
  for (const Vec3& p : surface.vertex) {
    if (!p.allFinite()) return "its surface has a vertex that is not finite";
  }
  const Box box = bounds(surface);
  for (int a = 0; a < 3; ++a) {
    if ((box.upper[a] - box.lower[a]) / cell > BrickLattice::maxNodes - 2 * marginCells - k_ - 2) {
      return "its cells are too fine: more than " + std::to_string(BrickLattice::maxNodes) + " along an axis";
    }
  }
  field_.lattice = BrickLattice::around(box, cell, marginCells, k_);
  DistanceTransform transform = closestPointTransform(surface, field_.lattice, bandCells);
  if (!transform.error.empty()) return transform.error;
  field_.band = transform.band;
  field_.value = std::move(transform.value);
  std::string fault = field_.fault();
  if (!fault.empty()) return fault;
  const bool any = std::any_of(field_.value.begin(), field_.value.end(), [](double v) { return v < 0.0; });
  return any ? std::string() : "it is thinner than a cell everywhere";
}

/// Finds the nodes attached to each partner.
void FatModel::attach(std::span<const FatPartner> partners) {
  partnerNodes_.resize(partners.size());
  forEachInside(field_, [&](std::uint32_t node, const Index3& n) {
    const Vec3 x = lattice().position(n);
    bool any = false;
    for (std::size_t p = 0; p < partners.size(); ++p) {
      if (!(partners[p].distance(x) <= partners[p].reach)) continue;
      partnerNodes_[p].push_back(node);
      any = true;
    }
    if (any) anchor_.push_back(node);
  });
}

/// Removes unattached parts.
void FatModel::removeLoose() {
  std::vector<double> value;
  {
    CarvedField field(field_);
    Islands islands(lattice(), anchor_);
    islands.rebuild(field);
    field.begin();
    islands.remove(field);
    value = field.values();
  }
  field_.value = std::move(value);
}

/// Builds the solid from cubes with inside nodes.
std::string FatModel::divide(const SolidModel::Material& material) {
  const CarvedField field(field_);
  Fill fill(lattice(), k_);
  fill.rebuild(field);
  hexahedra_ = fill.size();
  cubeOf_.assign(fill.counts().size(), -1);
  const Index3 corners = hexahedra_.array() + 1;
  std::vector<std::int32_t> nodeOf(slot(corners[0]) * slot(corners[1]) * slot(corners[2]), -1);
  const auto cornerAt = [&](const Index3& h, int c) {
    const Index3 at = h + Index3(c & 1, c >> 1 & 1, c >> 2);
    return slot(at[0]) + slot(corners[0]) * (slot(at[1]) + slot(corners[1]) * slot(at[2]));
  };
  forEachIndex(Index3::Zero(), hexahedra_.array() - 1, [&](const Index3& h) {
    const std::uint32_t number = fill.hexahedron(h);
    if (fill.counts()[number] == 0) return;
    cubeOf_[number] = static_cast<std::int32_t>(hexahedron_.size());
    hexahedron_.push_back(h);
    restFill_.push_back(std::min(1.0, static_cast<double>(fill.counts()[number]) / fullCount()));
    for (int c = 0; c < 8; ++c) nodeOf[cornerAt(h, c)] = 0;
  });
  const double edge = k_ * lattice().cell();
  std::vector<Vec3> rest;
  forEachIndex(Index3::Zero(), hexahedra_, [&](const Index3& n) {
    std::int32_t& number = nodeOf[cornerAt(n, 0)];
    if (number < 0) return;
    number = static_cast<std::int32_t>(rest.size());
    rest.emplace_back(lattice().origin() + edge * n.cast<double>());
  });
  std::vector<Index8> cubes;
  std::vector<std::vector<std::int32_t>> at(rest.size());
  for (const Index3& cube : hexahedron_) {
    Index8 corner{};
    for (int c = 0; c < 8; ++c) {
      corner[slot(c)] = nodeOf[cornerAt(cube, c)];
      at[slot(corner[slot(c)])].push_back(static_cast<std::int32_t>(cubes.size()));
    }
    cubes.push_back(corner);
  }
  cubeStart_.push_back(0);
  for (const std::vector<std::int32_t>& list : at) {
    cubeAtNode_.insert(cubeAtNode_.end(), list.begin(), list.end());
    cubeStart_.push_back(cubeAtNode_.size());
  }
  const std::size_t nodes = rest.size();
  solid_ =
      std::make_unique<SolidModel>(std::move(rest), std::move(cubes), edge, std::vector<bool>(nodes, false), material);
  return {};
}

/// Adds one spring per cube and partner, at the centroid of the nodes that it represents.
void FatModel::tie(std::span<const FatPartner> partners) {
  const double cell = lattice().cell();
  const double nodeVolume = cell * (cell * cell);
  tieStart_.push_back(0);
  std::vector<std::pair<int, std::uint32_t>> byCube;
  for (std::size_t p = 0; p < partners.size(); ++p) {
    byCube.clear();
    for (const std::uint32_t node : partnerNodes_[p]) {
      if (field_.value[node] < 0.0) byCube.emplace_back(cubeOfNode(lattice().nodeAt(node)), node);
    }
    std::sort(byCube.begin(), byCube.end());
    for (std::size_t first = 0; first < byCube.size();) {
      FatTie tie;
      tie.cube = byCube[first].first;
      tie.firstNode = tieNode_.size();
      Index3 sum = Index3::Zero();
      std::size_t last = first;
      for (; last < byCube.size() && byCube[last].first == tie.cube; ++last) {
        tieNode_.push_back(byCube[last].second);
        sum += lattice().nodeAt(byCube[last].second);
      }
      tie.lastNode = tieNode_.size();
      const auto count = static_cast<double>(last - first);
      tie.point.element = tie.cube;
      tie.point.node = solid_->cubes()[slot(tie.cube)];
      tie.point.weight = shares(tie.cube, sum.cast<double>() / count);
      tie.point.count = 8;
      tie.rest = tie.point.of(solid_->rest());
      tie.stiffness = partners[p].stiffness * nodeVolume * count;
      tie.damping = partners[p].damping * nodeVolume * count;
      tie_.push_back(tie);
      first = last;
    }
    tieStart_.push_back(tie_.size());
  }
  partnerNodes_.clear();
}

/// The surface can only reach cells and edges at nodes that are inside now, since fat only decreases.
void FatModel::rankBlocks() {
  rank_.assign(8 * lattice().brickCount(), -1);
  forEachInside(field_, [&](std::uint32_t, const Index3& n) {
    for (int d = 0; d < 8; ++d) {
      const std::uint32_t node = lattice().node(n - Index3(d & 1, d >> 1 & 1, d >> 2));
      const std::uint32_t local = node % BrickLattice::brickNodes;
      rank_[8 * (node / BrickLattice::brickNodes) + (local >> 2U & 1U) + 2 * (local >> 5U & 1U) + 4 * (local >> 8U)] =
          0;
    }
  });
  for (std::uint32_t b = 0; b < rank_.size(); ++b) {
    if (rank_[b] < 0) continue;
    rank_[b] = static_cast<std::int32_t>(block_.size());
    block_.push_back(b);
  }
}

int FatModel::cubeAt(const Index3& h) const {
  if ((h.array() < 0).any() || (h.array() >= hexahedra_.array()).any()) return -1;
  return cubeOf_[slot(h[0] + hexahedra_[0] * (h[1] + hexahedra_[1] * h[2]))];
}

std::array<double, 8> FatModel::shares(int cube, const Vec3& cells) const {
  const Vec3 s = (cells - (k_ * hexahedron_[slot(cube)]).cast<double>()) / static_cast<double>(k_);
  const double x[2] = {1.0 - s[0], s[0]};
  const double y[2] = {1.0 - s[1], s[1]};
  const double z[2] = {1.0 - s[2], s[2]};
  std::array<double, 8> out{};
  for (std::size_t c = 0; c < 8; ++c) out[c] = x[c & 1U] * y[c >> 1U & 1U] * z[c >> 2U];
  return out;
}

std::vector<Attachment> FatModel::restAttachments(double step) const {
  std::vector<Attachment> out;
  for (const FatTie& tie : tie_) {
    Attachment& a = out.emplace_back();
    a.point = tie.point;
    a.damper = (step * tie.stiffness + tie.damping) * Mat3::Identity();
  }
  return out;
}

FatState restState(const FatModel& model) {
  FatState state;
  state.solid = restState(model.solid());
  state.solid.volume = model.solid().volume(state.solid.position, model.restFill());
  return state;
}

bool fits(const FatModel& model, const FatState& state) {
  const SolidState& s = state.solid;
  if (s.position.size() != model.solid().nodes() || s.velocity.size() != s.position.size()) return false;
  if (s.rotation.size() != model.solid().groups()) return false;
  const auto finite = [](const std::vector<Vec3>& values) {
    return std::all_of(values.begin(), values.end(), [](const Vec3& v) { return v.allFinite(); });
  };
  if (!finite(s.position) || !finite(s.velocity)) return false;
  for (const RotationGroup& group : s.rotation) {
    for (std::size_t l = 0; l < laneCount; ++l) {
      double size = 0.0;
      for (const auto& part : group) size += part[l] * part[l];
      if (!(size > 0.99 && size < 1.01)) return false;
    }
  }
  if (!std::isfinite(s.volume) || !std::isfinite(s.maxDisplacement)) return false;
  CarvedField field(model.field());
  if (!field.restore(state.carved)) return false;
  for (std::size_t n = 0; n < field.values().size(); ++n) {
    if (field.values()[n] < model.field().value[n]) return false;  // fat cannot grow
  }
  return true;
}

}  // namespace calot
