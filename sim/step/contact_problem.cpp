// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/step/stages.h"

#include <algorithm>
#include <array>

#include "sim/step/contact_block.h"

namespace calot {

namespace {

/// Relative weight of a skin more compliant than the mesh can show; keeps rows that repeat each other apart. Larger
/// softens contact; smaller costs Newton steps. Measured.
constexpr double skinShare = 1e-4;

}  // namespace

void measureGaps(const Model& model, const Bodies& bodies, const Activity& activity, const InstrumentTravels& travels,
                 ContactSystem& contact) {
  const double h = bodies.step();
  std::array<ToolRow, handCount> stretch;
  for (std::size_t hand = 0; hand < handCount; ++hand) {
    ToolRow& q = stretch[hand];
    q = travels[hand].stretch;
    const HandDescription& description = model.scene().hands[hand];
    for (const ContactBlock& b : contact.blocks) {
      const std::array<ToolRow, 3>* const tool = b.toolOf(hand);
      if (tool == nullptr) continue;
      for (std::size_t k = 0; k < b.rows(); ++k) {
        q.head<3>() += contact.lambda[b.row + k] / description.couplingStiffness * (*tool)[k].head<3>();
        q[3] += contact.lambda[b.row + k] / description.rollStiffness * (*tool)[k][3];
      }
    }
  }
  contact.trueGap.resize(contact.rows);
  for (const ContactBlock& block : contact.blocks) {
    Vec3 apart = Vec3::Zero();
    const auto way = [&](const PushedBody& pushed) {
      return Vec3(h * pushed.place.of(bodies[pushed.body].freeVelocity()));
    };
    const PushedBody *const against = block.against(), *const along = block.along();
    if (against != nullptr && activity.awake[against->body]) apart -= way(*against);
    if (along != nullptr && activity.awake[along->body]) apart += way(*along);
    for (std::size_t k = 0; k < block.rows(); ++k) {
      double& gap = contact.trueGap[block.row + k];
      gap = block.gap[k] + block.direction[k].dot(apart);
      for (std::size_t hand = 0; hand < handCount; ++hand) {
        if (const std::array<ToolRow, 3>* const tool = block.toolOf(hand)) gap += (*tool)[k].dot(stretch[hand]);
      }
    }
    if (const auto* tissue = block.as<TissueOnTissue>())
      contact.trueGap[block.row] += tissue->softness * contact.lambda[block.row];
  }
  if (contact.pressed.empty()) return;
  evaluateDimpleGaps(contact.lambda, contact);
  for (const std::size_t b : contact.pressed) {
    const std::size_t row = contact.blocks[b].row;
    contact.trueGap[row] += contact.dimpleGap[row];
  }
}

void sumCompliances(ContactSystem& contact) {
  const std::size_t rows = contact.rows;
  contact.compliance.resize(rows * rows);
  for (std::size_t i = 0; i < rows * rows; ++i) {
    contact.compliance[i] = contact.tissueCompliance[i] + contact.couplingCompliance[i];
  }
  for (std::size_t i = 0; i < rows; ++i) contact.compliance[i * rows + i] *= 1.0 + skinShare;
  const std::size_t n = contact.pressed.size();
  if (n == 0) return;
  evaluateDimples(contact.lambda, contact);
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      contact.compliance[contact.blocks[contact.pressed[i]].row * rows + contact.blocks[contact.pressed[j]].row] +=
          contact.dimpleCompliance[i * n + j];
    }
  }
}

/// Drops blocks that stay open and carry no force. @return the largest violation (m)
double ContactProblemStage::dropOpenBlocks(ContactSystem& contact) const {
  double largest = 0.0;
  std::size_t kept = 0;
  for (std::size_t b = 0; b < contact.blocks.size(); ++b) {
    const ContactBlock& block = contact.blocks[b];
    const double* g = contact.trueGap.data() + block.row;
    const bool bilateral = block.kind == BlockKind::bilateral;
    largest = std::max(largest, bilateral ? Vec3(g[0], g[1], g[2]).norm() : std::max(0.0, -g[0]));
    if (!bilateral && g[0] > openGap && contact.carried[block.row] == 0.0) continue;
    if (kept != b) contact.blocks[kept] = block;
    ++kept;
  }
  contact.blocks.resize(kept);
  std::size_t to = 0;
  for (const ContactBlock& block : contact.blocks) {
    for (std::size_t k = 0; k < block.rows(); ++k) {
      contact.carried[to + k] = contact.carried[block.row + k];
      contact.trueGap[to + k] = contact.trueGap[block.row + k];
    }
    to += block.rows();
  }
  contact.numberRows();
  contact.carried.resize(contact.rows);
  contact.trueGap.resize(contact.rows);
  contact.lambda = contact.carried;
  return largest;
}

std::vector<ContactProblemStage::Part> ContactProblemStage::partsOf(Bodies& bodies, const Activity& activity,
                                                                    const State& state, const ContactSystem& contact) {
  std::vector<Part> parts;
  std::array<Mat3, SolidSolver::Impulse::maxNodes> rotation;
  const std::vector<GrownVessels*>& couplings = bodies.joined().grown();
  std::vector<bool> stiffened(couplings.size(), false);
  rotations_.clear();
  for (std::size_t b = 0; b < contact.blocks.size(); ++b) {
    const auto add = [&](const PushedBody* pushed, double sign) {
      if (pushed == nullptr || !activity.awake[pushed->body]) return;
      const std::size_t which = pushed->body;
      const SolidSolver::Impulse& place = pushed->place;
      parts.push_back({b, which, sign, &place, rotations_.size(), {}, {}, {}});
      bodies[which].precomputeCompliance({place.node.data(), place.count});
      for (std::size_t k = 0; k < place.count; ++k) {
        rotation[k] = place.weight[k] * bodies[which].rotation(state, place.node[k]);
        rotations_.push_back(columnsOf(rotation[k]));
      }
      for (std::size_t c = 0; c < couplings.size(); ++c) {
        if (!couplings[c]->joins(which)) continue;
        if (!stiffened[c]) couplings[c]->stiffen(state);
        stiffened[c] = true;
        parts.back().coupling = c;
        couplings[c]->responses(bodies[which], which, place, rotation, parts.back().responses);
        couplings[c]->tieImpulses(parts.back().responses, parts.back().impulses);
        break;
      }
    };
    add(contact.blocks[b].against(), -1.0);
    add(contact.blocks[b].along(), 1.0);
  }
  return parts;
}

/// Compliance of the reference configurations, rotated with the nodes.
void ContactProblemStage::assembleTissue(Bodies& bodies, const std::vector<Part>& parts, ContactSystem& contact) {
  const double h2 = bodies.step() * bodies.step();
  const std::size_t rows = contact.rows;
  std::vector<double>& w = contact.tissueCompliance;
  w.assign(rows * rows, 0.0);
  for (std::size_t p = 0; p < parts.size(); ++p) {
    for (std::size_t q = p; q < parts.size(); ++q) {
      const Part& a = parts[p];
      const Part& b = parts[q];
      const bool coupled = a.coupling && a.coupling == b.coupling;
      if (a.body != b.body && !coupled) continue;
      Mat3 c = Mat3::Zero();
      if (a.body == b.body) {
        nodeBlocks_.resize(9 * a.place->count * b.place->count + 1);
        bodies[a.body].blocks(a.nodes(), b.nodes(), nodeBlocks_);
        c = sumOfRotated({rotations_.data() + a.rotations, a.place->count}, nodeBlocks_,
                         {rotations_.data() + b.rotations, b.place->count});
      }
      if (coupled) c -= bodies.joined().grown()[*a.coupling]->schurComplement(a.responses, b.impulses);
      c *= h2 * a.sign * b.sign;
      const ContactBlock& one = contact.blocks[a.block];
      const ContactBlock& two = contact.blocks[b.block];
      for (std::size_t i = 0; i < one.rows(); ++i) {
        for (std::size_t j = 0; j < two.rows(); ++j) {
          const double share = one.direction[i].dot(c * two.direction[j]);
          w[(one.row + i) * rows + two.row + j] += share;
          if (p != q) w[(two.row + j) * rows + one.row + i] += share;
        }
      }
    }
  }
  // C_ab and C_ba come from different solves, each to its tolerance.
  for (std::size_t i = 0; i < rows; ++i) {
    for (std::size_t j = i + 1; j < rows; ++j) {
      const double mean = 0.5 * (w[i * rows + j] + w[j * rows + i]);
      w[i * rows + j] = w[j * rows + i] = mean;
    }
  }
}

/// Compliance of the virtual couplings, and of skin on skin.
void ContactProblemStage::assembleCouplings(ContactSystem& contact) const {
  const std::size_t rows = contact.rows;
  std::vector<double>& w = contact.couplingCompliance;
  w.assign(rows * rows, 0.0);
  for (const ContactBlock& a : contact.blocks) {
    if (const auto* tissue = a.as<TissueOnTissue>()) w[a.row * rows + a.row] = tissue->softness;
    for (const ContactBlock& b : contact.blocks) {
      for (std::size_t h = 0; h < handCount; ++h) {
        const std::array<ToolRow, 3>* const one = a.toolOf(h);
        const std::array<ToolRow, 3>* const two = b.toolOf(h);
        if (one == nullptr || two == nullptr) continue;
        const HandDescription& hand = model_.scene().hands[h];
        for (std::size_t i = 0; i < a.rows(); ++i) {
          for (std::size_t j = 0; j < b.rows(); ++j) {
            w[(a.row + i) * rows + b.row + j] += (*one)[i].head<3>().dot((*two)[j].head<3>()) / hand.couplingStiffness +
                                                 (*one)[i][3] * (*two)[j][3] / hand.rollStiffness;
          }
        }
      }
    }
  }
}

double ContactProblemStage::run(Bodies& bodies, const Activity& activity, const InstrumentTravels& travels,
                                const State& state, ContactSystem& contact) {
  findDimples(model_, state, bodies.step(), contact);
  measureGaps(model_, bodies, activity, travels, contact);
  const double violation = dropOpenBlocks(contact);
  findDimples(model_, state, bodies.step(), contact);
  assembleTissue(bodies, partsOf(bodies, activity, state, contact), contact);
  assembleCouplings(contact);
  sumCompliances(contact);
  contact.ruler = contact.compliance;
  recallResponses(contact);
  sumCompliances(contact);
  return violation;
}

}  // namespace calot
