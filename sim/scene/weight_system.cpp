// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/math/no_fused_pairs.h"  // first

#include "sim/scene/weight_system.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <vector>

#include "sim/scene/model.h"
#include "sim/vessel/beam_model.h"

namespace calot {

namespace {

/// A group is held if what its system leaves is less than this share of its weight. Larger: what nothing holds might
/// count as held; smaller: rounding might let what is held fall. Assumed.
constexpr double unheldShare = 1e-6;

/// By how much what bears is stiffer than what it bears. Larger: digits are lost; smaller: fat props the liver.
/// Assumed: a sag of 80 mm moves what hangs on it by 0.08 mm.
constexpr double bearing = 1000.0;

/// One group of bodies as a system.
class WeightSystem {
 public:
  WeightSystem(const Model& model, const std::vector<double>& stiffening)
      : model_(model), stiffening_(stiffening), row_(model.bodies()), massOf_(model.bodies()) {}

  void addBody(std::size_t body);
  /// @pre its bodies were added
  void addJoints(const std::vector<bool>& member);
  /// @return is it held?
  bool solve(WeightMotion& out);

 private:
  void number(std::size_t body, std::size_t nodes, std::size_t each, const auto& isFixed);
  [[nodiscard]] std::size_t firstFat() const { return model_.organs().size() + model_.vesselTrees().size(); }
  [[nodiscard]] const BeamModel& beams(std::size_t body) const {
    return model_.vesselTrees()[body - model_.organs().size()].beams;
  }
  void assemble(SymmetricBlocks& matrix) const;

  [[nodiscard]] double ofJoint(std::size_t a, std::size_t b) const { return std::min(stiffening_[a], stiffening_[b]); }

  const Model& model_;
  const std::vector<double>& stiffening_;
  std::vector<std::size_t> body_;
  std::size_t rows_ = 0;
  std::vector<std::vector<int>> row_;        ///< per body and node; -1: fixed
  std::vector<std::vector<double>> massOf_;  ///< per body and node (kg)
  std::vector<const Tie*> tie_;
  std::vector<const ConnectiveModel*> connective_;
};

void WeightSystem::number(std::size_t body, std::size_t nodes, std::size_t each, const auto& isFixed) {
  for (std::size_t n = 0; n < nodes; ++n) {
    row_[body].push_back(isFixed(n) ? -1 : static_cast<int>(rows_));
    if (!isFixed(n)) rows_ += each;
  }
}

void WeightSystem::addBody(std::size_t body) {
  body_.push_back(body);
  if (body < model_.organs().size()) {
    const SolidModel& solid = model_.organs()[body].solid;
    massOf_[body] = solid.mass();
    number(body, solid.nodes(), 1, [&](std::size_t n) { return solid.row(n) < 0; });
  } else if (body < firstFat()) {
    massOf_[body] = beams(body).mass();
    number(body, beams(body).nodes(), 2, [&](std::size_t n) { return beams(body).fixed(n); });
  } else {
    const FatModel& fat = *model_.fat()[body - firstFat()];
    fat.solid().massOf(fat.restFill(), massOf_[body]);
    number(body, fat.solid().nodes(), 1, [](std::size_t) { return false; });
  }
}

void WeightSystem::addJoints(const std::vector<bool>& member) {
  for (const Tie& tie : model_.ties()) {
    if (member[tie.body[0]]) tie_.push_back(&tie);
  }
  for (const ConnectiveModel& connective : model_.connective()) {
    if (member[connective.a]) connective_.push_back(&connective);
  }
}

void WeightSystem::assemble(SymmetricBlocks& matrix) const {
  for (const std::size_t body : body_) {
    if (body < model_.organs().size()) {
      addStiffness(model_.organs()[body].solid, {}, stiffening_[body], row_[body], matrix);
    } else if (body < firstFat()) {
      addStiffness(beams(body), stiffening_[body], row_[body], matrix);
    } else {
      const FatModel& fat = *model_.fat()[body - firstFat()];
      addStiffness(fat.solid(), fat.restFill(), stiffening_[body], row_[body], matrix);
    }
  }
  for (const Tie* tie : tie_) {
    addSpring({tie->place[0], row_[tie->body[0]]}, {tie->place[1], row_[tie->body[1]]},
              ofJoint(tie->body[0], tie->body[1]) * tie->stiffness, matrix);
  }
  for (const ConnectiveModel* connective : connective_) {
    for (const Strand& strand : connective->tissue.strands()) {
      addSpring({strand.a, row_[connective->a]}, {strand.b, row_[connective->b]},
                ofJoint(connective->a, connective->b) * connective->tissue.stiffnessOf(strand), matrix);
    }
  }
}

bool WeightSystem::solve(WeightMotion& out) {
  SymmetricBlocks matrix(rows_);
  assemble(matrix);
  std::vector<Vec3> weight(rows_, Vec3::Zero());
  for (const std::size_t body : body_) {
    for (std::size_t n = 0; n < row_[body].size(); ++n) {
      if (row_[body][n] >= 0)
        weight[static_cast<std::size_t>(row_[body][n])] = massOf_[body][n] * model_.scene().gravity;
    }
  }
  matrix.factor();
  const std::vector<Vec3> x = matrix.solve(weight);
  const std::vector<Vec3> carried = matrix.times(x);
  Vec3 whole = Vec3::Zero();
  double left = 0.0;
  for (std::size_t i = 0; i < rows_; ++i) {
    if (!x[i].allFinite()) return false;
    whole += weight[i];
    left = std::max(left, (weight[i] - carried[i]).norm());
  }
  if (left > unheldShare * whole.norm()) return false;
  for (const std::size_t body : body_) {
    const bool turns = body >= model_.organs().size() && body < firstFat();
    for (std::size_t n = 0; n < row_[body].size(); ++n) {
      if (row_[body][n] < 0) continue;
      const auto i = static_cast<std::size_t>(row_[body][n]);
      out.displacement[body][n] = x[i];
      if (turns) out.rotation[body][n] = x[i + 1];
    }
  }
  return true;
}

/// Index of each body in K.
std::vector<double> stiffeningOf(const Model& model) {
  std::vector<double> out;
  for (const OrganModel& organ : model.organs()) {
    const bool anchored = organ.solid.freeNodes().size() < organ.solid.nodes();
    out.push_back(anchored ? bearing * bearing : bearing);
  }
  out.resize(model.organs().size() + model.vesselTrees().size(), bearing);
  out.resize(model.bodies(), 1.0);
  return out;
}

/// Per body, the first of the bodies that ties and strands join it to.
std::vector<std::size_t> groupsOf(const Model& model) {
  std::vector<std::size_t> first(model.bodies());
  std::iota(first.begin(), first.end(), std::size_t{0});
  const auto join = [&](std::size_t a, std::size_t b) {
    const std::size_t kept = std::min(first[a], first[b]);
    const std::size_t merged = std::max(first[a], first[b]);
    std::replace(first.begin(), first.end(), merged, kept);
  };
  for (const Tie& tie : model.ties()) join(tie.body[0], tie.body[1]);
  for (const ConnectiveModel& connective : model.connective()) join(connective.a, connective.b);
  return first;
}

}  // namespace

WeightMotion motionUnderWeight(const Model& model) {
  WeightMotion out;
  const std::size_t bodies = model.bodies();
  out.displacement.resize(bodies);
  out.rotation.resize(bodies);
  out.held.assign(bodies, false);
  for (std::size_t o = 0; o < model.organs().size(); ++o) {
    out.displacement[o].assign(model.organs()[o].solid.nodes(), Vec3::Zero());
  }
  for (std::size_t t = 0; t < model.vesselTrees().size(); ++t) {
    const std::size_t body = model.organs().size() + t;
    out.displacement[body].assign(model.vesselTrees()[t].beams.nodes(), Vec3::Zero());
    out.rotation[body] = out.displacement[body];
  }
  for (std::size_t f = 0; f < model.fat().size(); ++f) {
    const std::size_t body = model.organs().size() + model.vesselTrees().size() + f;
    out.displacement[body].assign(model.fat()[f]->solid().nodes(), Vec3::Zero());
  }
  out.stiffening = stiffeningOf(model);
  const std::vector<std::size_t> first = groupsOf(model);
  for (std::size_t group = 0; group < bodies; ++group) {
    if (first[group] != group) continue;
    WeightSystem system(model, out.stiffening);
    std::vector<bool> member(bodies, false);
    for (std::size_t body = group; body < bodies; ++body) {
      if (first[body] != group) continue;
      member[body] = true;
      system.addBody(body);
    }
    system.addJoints(member);
    const bool held = system.solve(out);
    for (std::size_t body = 0; body < bodies; ++body) {
      if (member[body]) out.held[body] = held;
    }
  }
  return out;
}

// Loads that carry the weight where the scene is drawn.

namespace {

std::vector<Vec3> times(double factor, std::vector<Vec3> values) {
  for (Vec3& v : values) v *= factor;
  return values;
}

}  // namespace

void Model::carryWeight() {
  held_.assign(bodies(), true);
  if (scene_.gravity.isZero(0.0)) return;
  const WeightMotion x = motionUnderWeight(*this);
  held_ = x.held;
  const std::size_t firstVessel = organs().size();
  const std::size_t firstFat = firstVessel + vesselTrees().size();
  const auto loads = [&](std::size_t body) { return times(x.stiffening[body], x.displacement[body]); };
  const auto ofJoint = [&](std::size_t a, std::size_t b) { return std::min(x.stiffening[a], x.stiffening[b]); };
  for (std::size_t o = 0; o < firstVessel; ++o) organModel[o].solid.preload(loads(o));
  for (std::size_t t = 0; t < vesselTrees().size(); ++t) {
    const std::size_t body = firstVessel + t;
    preload(vesselTree[t].beams, loads(body), times(x.stiffening[body], x.rotation[body]));
  }
  for (std::size_t f = 0; f < fat().size(); ++f) fatModel[f]->preload(loads(firstFat + f));
  for (Tie& tie : tie_) {
    const Vec3 apart = tie.place[0].of(x.displacement[tie.body[0]]) - tie.place[1].of(x.displacement[tie.body[1]]);
    const Vec3 ahead = ofJoint(tie.body[0], tie.body[1]) * apart;
    if (tie.body[0] < firstVessel) {
      tie.offset += ahead;
      continue;
    }
    const BeamModel& beams = vesselTrees()[tie.body[0] - firstVessel].beams;
    tie.offset += beams.restOrientation()[static_cast<std::size_t>(tie.place[0].node[0])].conjugate() * ahead;
  }
  for (ConnectiveModel& connective : connectiveModel) {
    const double factor = ofJoint(connective.a, connective.b);
    connective.tissue.preload(times(factor, x.displacement[connective.a]), times(factor, x.displacement[connective.b]));
  }
}

namespace {

void addBlock(std::span<const int> row, int a, int b, const Mat3& block, SymmetricBlocks& matrix) {
  const int i = row[static_cast<std::size_t>(a)];
  const int j = row[static_cast<std::size_t>(b)];
  if (i >= 0 && j >= 0) matrix.add(static_cast<std::size_t>(i), static_cast<std::size_t>(j), block);
}

/// K_ab = V (mu (g_a . g_b) I + mu g_b g_a^T + lambda g_a g_b^T)
void addTetrahedra(const SolidModel& model, double factor, std::span<const int> row, SymmetricBlocks& matrix) {
  const LameConstants m = model.material().lame;
  for (std::size_t e = 0; e < model.tetrahedra().size(); ++e) {
    const ElementGroup& group = model.elements().groups()[e / laneCount];
    const std::size_t l = e % laneCount;
    std::array<Vec3, 4> g;
    for (std::size_t a = 0; a < 4; ++a)
      g[a] = {group.gradient[a][0][l], group.gradient[a][1][l], group.gradient[a][2][l]};
    for (std::size_t a = 0; a < 4; ++a) {
      for (std::size_t b = 0; b <= a; ++b) {
        Mat3 block = (m.mu * g[a].dot(g[b])) * Mat3::Identity();
        block += m.mu * (g[b] * g[a].transpose()) + m.lambda * (g[a] * g[b].transpose());
        addBlock(row, group.node[a][l], group.node[b][l], (factor * group.volume[l]) * block, matrix);
      }
    }
  }
}

void addCubes(const SolidModel& model, std::span<const double> fill, double factor, std::span<const int> row,
              SymmetricBlocks& matrix) {
  const auto& stiffness = model.hexahedra().stiffness();
  for (std::size_t e = 0; e < model.cubes().size(); ++e) {
    const Index8& cube = model.cubes()[e];
    const double share = fill.empty() ? factor : factor * fill[e];
    for (std::size_t a = 0; a < 8; ++a) {
      for (std::size_t b = 0; b <= a; ++b) {
        Mat3 block;
        for (std::size_t i = 0; i < 3; ++i) {
          for (std::size_t j = 0; j < 3; ++j) {
            block(static_cast<int>(i), static_cast<int>(j)) = share * stiffness[3 * a + i][3 * b + j];
          }
        }
        addBlock(row, cube[a], cube[b], block, matrix);
      }
    }
  }
}

}  // namespace

void addStiffness(const SolidModel& model, std::span<const double> fill, double factor, std::span<const int> row,
                  SymmetricBlocks& matrix) {
  if (model.madeOfCubes()) {
    addCubes(model, fill, factor, row, matrix);
  } else {
    addTetrahedra(model, factor, row, matrix);
  }
}

void addSpring(const PlacedPoint& a, const PlacedPoint& b, double stiffness, SymmetricBlocks& matrix) {
  const std::array<const PlacedPoint*, 2> end{&a, &b};
  for (std::size_t p = 0; p < 2; ++p) {
    for (std::size_t q = 0; q <= p; ++q) {
      const MaterialPoint& from = end[p]->point;
      const MaterialPoint& to = end[q]->point;
      for (std::size_t k = 0; k < from.count; ++k) {
        const int i = end[p]->row[static_cast<std::size_t>(from.node[k])];
        if (i < 0) continue;
        for (std::size_t l = 0; l < to.count; ++l) {
          const int j = end[q]->row[static_cast<std::size_t>(to.node[l])];
          if (j < 0 || (p == q && l > k)) continue;
          const double share = (p == q ? stiffness : -stiffness) * (from.weight[k] * to.weight[l]);
          matrix.add(static_cast<std::size_t>(i), static_cast<std::size_t>(j), share * Mat3::Identity());
        }
      }
    }
  }
}

}  // namespace calot
