// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/step/contact_block.h"

#include <algorithm>
#include <cmath>

#include "sim/contact/sphere_indentation.h"
#include "sim/math/linear.h"

namespace calot {

const PushedTool* ContactBlock::tool() const {
  if (const auto* touch = as<ToolOnTissue>()) return &touch->tool;
  const auto* grasp = as<Grasped>();
  return grasp != nullptr ? &grasp->tool : nullptr;
}

const std::array<ToolRow, 3>* ContactBlock::toolOf(std::size_t hand) const {
  const auto* both = as<ToolOnTool>();
  const PushedTool* const one = both == nullptr ? tool() : hand == both->left.hand ? &both->left : &both->right;
  return one != nullptr && one->hand == hand ? &one->row : nullptr;
}

const PushedBody* ContactBlock::along() const {
  const auto* tissue = as<TissueOnTissue>();
  return tissue != nullptr ? &tissue->along : nullptr;
}

const PushedBody* ContactBlock::against() const {
  if (const auto* touch = as<ToolOnTissue>()) return &touch->tissue;
  if (const auto* grasp = as<Grasped>()) return &grasp->tissue;
  const auto* tissue = as<TissueOnTissue>();
  return tissue != nullptr ? &tissue->against : nullptr;
}

const Press* ContactBlock::press() const {
  const auto* touch = as<ToolOnTissue>();
  return touch != nullptr && touch->press ? &*touch->press : nullptr;
}

void ContactSystem::numberRows() {
  rows = 0;
  kinds.clear();
  limits.clear();
  for (ContactBlock& block : blocks) {
    block.row = rows;
    rows += block.rows();
    kinds.push_back(block.kind);
    limits.push_back(block.limit);
  }
}

void addNodalForces(std::span<const ContactBlock> blocks, std::size_t body, std::size_t nodes,
                    std::span<const double> forces, double scale, std::vector<Vec3>& nodal) {
  for (const ContactBlock& block : blocks) {
    for (const bool along : {false, true}) {
      const PushedBody* const pushed = along ? block.along() : block.against();
      if (pushed == nullptr || pushed->body != body) continue;
      Vec3 force = Vec3::Zero();
      for (std::size_t k = 0; k < block.rows(); ++k) force += forces[block.row + k] * block.direction[k];
      if (force.isZero(0.0)) continue;
      if (nodal.empty()) nodal.assign(nodes, Vec3::Zero());
      const SolidSolver::Impulse& place = pushed->place;
      const double sign = along ? scale : -scale;
      for (std::size_t k = 0; k < place.count; ++k) {
        nodal[static_cast<std::size_t>(place.node[k])] += sign * place.weight[k] * force;
      }
    }
  }
}

namespace {

/// Down to here a dimple follows the half-space; deeper, tissue counts as pressed together, and the dimple goes at most
/// `lastDepth` further (m). Larger: thin instruments sink through organs; smaller: deep presses are too firm. Assumed.
constexpr double elasticDepth = 0.006;
constexpr double lastDepth = 0.002;
constexpr double forgottenDepth = 1e-7;  ///< dimples that faded below are dropped (m)
constexpr double smallForce = 1e-12;     ///< N; below, a force has no direction

std::uint64_t dimpleKey(std::size_t structure, std::size_t piece) {
  return static_cast<std::uint64_t>(structure) << 8U | piece;
}

/// w = h / (h + beta): share of the elastic dimple in that of a step.
double newShare(const Model& model, std::size_t structure, double step) {
  return step / (step + model.structures()[structure].soft->material().stiffnessDamping);
}

/// E* = E / (1 - nu^2) (Pa).
double contactModulus(const SolidModel& soft) {
  const LameConstants& lame = soft.material().lame;
  return 4.0 * lame.mu * (lame.lambda + lame.mu) / (lame.lambda + 2.0 * lame.mu);
}

/// A half-space's dimple as it is in tissue of finite thickness, with its derivative.
Indentation bounded(double depth) {
  if (depth <= elasticDepth) return {depth, 1.0};
  const double beyond = (depth - elasticDepth) / lastDepth;
  return {elasticDepth + lastDepth * beyond / (1.0 + beyond), 1.0 / ((1.0 + beyond) * (1.0 + beyond))};
}

/// Writes the gaps, and the derivative where it is asked for.
void evaluate(std::span<const double> lambda, bool derivative, ContactSystem& contact) {
  const std::size_t n = contact.pressed.size();
  contact.dimpleGap.assign(contact.rows, 0.0);
  if (derivative) contact.dimpleCompliance.assign(n * n, 1.0);
  for (Dimple& dimple : contact.dimples) dimple.force = 0.0;
  for (const std::size_t b : contact.pressed) {
    const ContactBlock& block = contact.blocks[b];
    contact.dimples[block.press()->dimple].force += block.press()->share * lambda[block.row];
  }
  for (Dimple& dimple : contact.dimples) {
    const double share = dimple.radius / dimple.size;
    dimple.end = roundEnd(share * notNegative(dimple.force), dimple.radius, dimple.modulus);
    dimple.end.slope *= share;
  }
  for (std::size_t i = 0; i < n; ++i) {
    const ContactBlock& a = contact.blocks[contact.pressed[i]];
    const Press& one = *a.press();
    const Dimple& dimple = contact.dimples[one.dimple];
    double elastic = one.share * dimple.end.depth;
    for (std::size_t j = 0; j < n; ++j) {
      const ContactBlock& b = contact.blocks[contact.pressed[j]];
      double slope = contact.sharedDimple[i * n + j];
      elastic += slope * lambda[b.row];
      if (!derivative) continue;
      const Press& two = *b.press();
      if (one.dimple == two.dimple) slope += one.share * two.share * dimple.end.slope;
      contact.dimpleCompliance[i * n + j] *= dimple.newShare * slope;
    }
    const Indentation finite = bounded(elastic);
    contact.dimpleGap[a.row] = dimple.newShare * (finite.depth - a.direction[0].dot(dimple.before));
    if (!derivative || finite.slope == 1.0) continue;
    // Symmetric: the rows of one dimple are about equally deep.
    const double share = std::sqrt(finite.slope);
    for (std::size_t j = 0; j < n; ++j) {
      contact.dimpleCompliance[i * n + j] *= share;
      contact.dimpleCompliance[j * n + i] *= share;
    }
  }
}

/// The direction in which a dimple gives way: mean of the smooth normals where the last step's forces act; where there
/// were none, at the nearest point.
void findWays(ContactSystem& contact) {
  for (std::size_t d = 0; d < contact.dimples.size(); ++d) {
    Vec3 sum = Vec3::Zero();
    const ContactBlock* nearest = nullptr;
    for (const std::size_t b : contact.pressed) {
      const ContactBlock& block = contact.blocks[b];
      if (block.press()->dimple != d) continue;
      sum += contact.carried[block.row] * block.press()->smooth;
      if (nearest == nullptr || block.gap[0] < nearest->gap[0]) nearest = &block;
    }
    if (!(sum.norm() > smallForce)) sum = nearest->press()->smooth;
    contact.dimples[d].way = sum.normalized();
  }
  for (const std::size_t b : contact.pressed) {
    ContactBlock& block = contact.blocks[b];
    block.press()->share = block.direction[0].dot(contact.dimples[block.press()->dimple].way);
  }
}

}  // namespace

Vec3 dimpleOf(const TouchState& touches, std::size_t structure, std::size_t piece) {
  const std::uint64_t key = dimpleKey(structure, piece);
  for (std::size_t k = 0; k < touches.dimpleKey.size(); ++k) {
    if (touches.dimpleKey[k] == key) return touches.dimple[k];
  }
  return Vec3::Zero();
}

double meshSpread(const StructureModel& structure, const SolidSolver::Impulse& place,
                  const SolidSolver::Impulse& force) {
  const double spread = structure.nodeSpread;
  const std::vector<Vec3>& rest = structure.soft->rest();
  double inverse = 0.0;
  for (std::size_t a = 0; a < place.count; ++a) {
    const Vec3& at = rest[static_cast<std::size_t>(place.node[a])];
    for (std::size_t b = 0; b < force.count; ++b) {
      const double squared = (rest[static_cast<std::size_t>(force.node[b])] - at).squaredNorm();
      inverse += place.weight[a] * force.weight[b] / std::sqrt(squared + spread * spread);
    }
  }
  return 1.0 / inverse;
}

void findDimples(const Model& model, const State& state, double step, ContactSystem& contact) {
  contact.dimples.clear();
  contact.pressed.clear();
  for (std::size_t b = 0; b < contact.blocks.size(); ++b) {
    Press* const press = contact.blocks[b].press();
    if (press == nullptr) continue;
    const auto& touch = *contact.blocks[b].as<ToolOnTissue>();
    const std::size_t hand = touch.tool.hand;
    const std::uint64_t key = dimpleKey(touch.structure, press->piece);
    const auto known = std::find_if(contact.dimples.begin(), contact.dimples.end(),
                                    [&](const Dimple& d) { return d.hand == hand && d.key == key; });
    press->dimple = static_cast<std::size_t>(known - contact.dimples.begin());
    contact.pressed.push_back(b);
    if (known != contact.dimples.end()) continue;
    Dimple dimple;
    dimple.hand = hand;
    dimple.key = key;
    dimple.radius = press->radius;
    dimple.size = press->size;
    dimple.modulus = contactModulus(*model.structures()[touch.structure].soft);
    dimple.newShare = newShare(model, touch.structure, step);
    dimple.before = dimpleOf(state.hand[hand].touches, touch.structure, press->piece);
    contact.dimples.push_back(dimple);
  }
  findWays(contact);
  const std::size_t n = contact.pressed.size();
  contact.sharedDimple.assign(n * n, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    const auto& one = *contact.blocks[contact.pressed[i]].as<ToolOnTissue>();
    const Press& a = *one.press;
    for (std::size_t j = 0; j <= i; ++j) {
      const auto& two = *contact.blocks[contact.pressed[j]].as<ToolOnTissue>();
      const Press& b = *two.press;
      if (one.tool.hand != two.tool.hand || one.structure != two.structure) continue;
      const double modulus = contact.dimples[a.dimple].modulus;
      const double squared = (a.foot - b.foot).squaredNorm();
      const double tool = 0.5 * (flatEndSpread(a.size) + flatEndSpread(b.size));
      const double mesh = std::max(tool, 0.5 * (a.spread + b.spread));
      const double k = a.share * b.share * contact.dimples[a.dimple].way.dot(contact.dimples[b.dimple].way) *
                       (spreadCompliance(squared, tool, modulus) - spreadCompliance(squared, mesh, modulus));
      contact.sharedDimple[i * n + j] = contact.sharedDimple[j * n + i] = k;
    }
  }
}

void evaluateDimples(std::span<const double> lambda, ContactSystem& contact) { evaluate(lambda, true, contact); }

void evaluateDimpleGaps(std::span<const double> lambda, ContactSystem& contact) { evaluate(lambda, false, contact); }

void storeDimples(const Model& model, double step, const ContactSystem& contact, State& state) {
  for (std::size_t h = 0; h < handCount; ++h) {
    TouchState& touches = state.hand[h].touches;
    // An unloaded dimple fades.
    std::size_t kept = 0;
    for (std::size_t k = 0; k < touches.dimpleKey.size(); ++k) {
      const std::uint64_t key = touches.dimpleKey[k];
      const bool pressed = std::any_of(contact.dimples.begin(), contact.dimples.end(),
                                       [&](const Dimple& d) { return d.hand == h && d.key == key; });
      const Vec3 left = (1.0 - newShare(model, key >> 8U, step)) * touches.dimple[k];
      if (pressed || left.norm() < forgottenDepth) continue;
      touches.dimpleKey[kept] = key;
      touches.dimple[kept++] = left;
    }
    touches.dimpleKey.resize(kept);
    touches.dimple.resize(kept);
  }
  for (std::size_t d = 0; d < contact.dimples.size(); ++d) {
    const Dimple& dimple = contact.dimples[d];
    double work = 0.0;
    for (const std::size_t b : contact.pressed) {
      const ContactBlock& block = contact.blocks[b];
      if (block.press()->dimple != d) continue;
      work += contact.lambda[block.row] * (contact.dimpleGap[block.row] + block.direction[0].dot(dimple.before));
    }
    const Vec3 now = dimple.force > smallForce ? Vec3(work / dimple.force * dimple.way)
                                               : Vec3((1.0 - dimple.newShare) * dimple.before);
    if (now.norm() < forgottenDepth) continue;
    state.hand[dimple.hand].touches.dimpleKey.push_back(dimple.key);
    state.hand[dimple.hand].touches.dimple.push_back(now);
  }
}

}  // namespace calot
