// SPDX-License-Identifier: GPL-3.0-or-later
// What a step's contact problem knows from the steps before.
#include <algorithm>
#include <array>
#include <cstdlib>

#include "sim/step/contact_block.h"
#include "sim/step/stages.h"

namespace calot {

namespace {

/// The hand that keeps the force of an instrument's touch.
std::size_t keeperOf(const ContactBlock& block) {
  const auto* both = block.as<ToolOnTool>();
  return both != nullptr ? both->left.hand : block.tool()->hand;
}

/// The last step's force at a block's contact point (N); zero where there was none.
Vec3 lastForce(const State& state, const ContactBlock& block) {
  Vec3 force = Vec3::Zero();
  if (block.as<TissueOnTissue>() != nullptr) {
    const std::vector<std::uint64_t>& keys = state.tissue.key;
    const auto found = std::lower_bound(keys.begin(), keys.end(), block.key);
    if (found != keys.end() && *found == block.key) {
      force = state.tissue.force[static_cast<std::size_t>(found - keys.begin())] * block.direction[0];
    }
  } else if (const auto* grasp = block.as<Grasped>()) {
    force = state.hand[grasp->tool.hand].grasp.force[grasp->anchor];
  } else {
    const TouchState& touches = state.hand[keeperOf(block)].touches;
    for (std::size_t k = 0; k < touches.key.size(); ++k) {
      if (touches.key[k] == block.key) force = touches.force[k];
    }
  }
  return force;
}

/// Bits of a block's key that name capsule and structure of an instrument's touch.
constexpr std::uint64_t pressedPart(std::uint64_t key) { return key >> structureShift; }

bool has(const std::vector<std::uint64_t>& keys, std::uint64_t key) {
  return std::find(keys.begin(), keys.end(), key) != keys.end();
}

/// Where the force of a contact point goes that is there no more: to the deepest point of the same capsule on the same
/// structure, a new one if there is any; null: the capsule has left it.
const ContactBlock* successorOf(std::uint64_t lost, const TouchState& touches, std::size_t hand,
                                std::span<const ContactBlock> blocks) {
  const ContactBlock* best = nullptr;
  bool bestIsNew = false;
  for (const ContactBlock& block : blocks) {
    const auto* touch = block.as<ToolOnTissue>();
    if (touch == nullptr || touch->tool.hand != hand || pressedPart(block.key) != pressedPart(lost)) continue;
    const bool isNew = !has(touches.key, block.key);
    const bool better = best == nullptr || (isNew && !bestIsNew) || (isNew == bestIsNew && block.gap[0] < best->gap[0]);
    if (!better) continue;
    best = &block;
    bestIsNew = isNew;
  }
  return best;
}

/// An instrument that slides leaves its contact points and finds others: they take over.
void passOnForces(const State& state, ContactSystem& contact) {
  for (std::size_t h = 0; h < handCount; ++h) {
    const TouchState& touches = state.hand[h].touches;
    for (std::size_t k = 0; k < touches.key.size(); ++k) {
      const auto stays = [&](const ContactBlock& block) {
        return block.as<ToolOnTissue>() != nullptr && block.tool()->hand == h && block.key == touches.key[k];
      };
      if (touches.force[k].isZero(0.0) || std::any_of(contact.blocks.begin(), contact.blocks.end(), stays)) continue;
      const ContactBlock* const to = successorOf(touches.key[k], touches, h, contact.blocks);
      if (to == nullptr) continue;
      for (std::size_t i = 0; i < to->rows(); ++i)
        contact.carried[to->row + i] += touches.force[k].dot(to->direction[i]);
      projectOntoFrictionCone(to->kind, to->limit, std::span(contact.carried).subspan(to->row, to->rows()));
    }
  }
}

}  // namespace

void loadWarmStart(const State& state, ContactSystem& contact) {
  contact.numberRows();
  contact.carried.clear();
  for (const ContactBlock& block : contact.blocks) {
    const Vec3 force = lastForce(state, block);
    for (std::size_t k = 0; k < block.rows(); ++k) contact.carried.push_back(force.dot(block.direction[k]));
    projectOntoFrictionCone(block.kind, block.limit, std::span(contact.carried).subspan(block.row, block.rows()));
  }
  if (!getenv("NOTRANSFER")) passOnForces(state, contact);
  contact.lambda = contact.carried;
  contact.learned = state.response;
}

void storeWarmStart(const ContactSystem& contact, State& state) {
  for (HandState& hand : state.hand) {
    hand.touches.key.clear();
    hand.touches.force.clear();
  }
  state.tissue.key.clear();
  state.tissue.force.clear();
  state.response = contact.learned;
  for (const ContactBlock& block : contact.blocks) {
    Vec3 force = Vec3::Zero();
    for (std::size_t k = 0; k < block.rows(); ++k) force += contact.lambda[block.row + k] * block.direction[k];
    if (block.as<TissueOnTissue>() != nullptr) {
      state.tissue.key.push_back(block.key);
      state.tissue.force.push_back(contact.lambda[block.row]);
    } else if (const auto* grasp = block.as<Grasped>()) {
      state.hand[grasp->tool.hand].grasp.force[grasp->anchor] = force;
    } else {
      TouchState& touches = state.hand[keeperOf(block)].touches;
      touches.key.push_back(block.key);
      touches.force.push_back(force);
    }
  }
}

namespace {

/// Changes that are remembered. More: older ones, of a tissue that has turned since; fewer: more passes. Measured on
/// the whole operation.
constexpr std::size_t maxLearned = 8;
/// Share of a change (of its squared forces) whose contact points are still there: with less nothing is known of it.
/// Larger: a sliding instrument forgets; smaller: the motion of one place is taken for that of others. Assumed.
constexpr double leastKnown = 0.9;
/// Tissue that answered by more or by less than this multiple or share of what the estimate says was another. Larger:
/// wrong estimates after a cut; smaller: more passes. Assumed.
const double mostOff = getenv("OFF") ? atof(getenv("OFF")) : 20.0;

/// Names a contact point of an instrument among those of both hands; 0: none of an instrument on tissue.
std::uint64_t nameOf(const ContactBlock& block) {
  const PushedTool* const tool = block.tool();
  if (tool == nullptr) return 0;
  const auto* grasp = block.as<Grasped>();
  if (grasp == nullptr) return block.key << 3U | 2U | tool->hand;
  return (static_cast<std::uint64_t>(grasp->tissue.body) << 32U | grasp->anchor) << 3U | 4U | tool->hand;
}

/// A vector of a block from numbers in its rows.
Vec3 inSpace(const ContactBlock& block, std::span<const double> rows) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 0; k < block.rows(); ++k) sum += rows[block.row + k] * block.direction[k];
  return sum;
}

}  // namespace

void correctCompliance(std::span<const double> change, std::span<const double> response,
                       std::span<const double> expected, ContactSystem& contact) {
  const std::size_t rows = contact.rows;
  double measured = 0.0;
  double predicted = 0.0;
  for (std::size_t i = 0; i < rows; ++i) {
    measured += change[i] * response[i];
    predicted += change[i] * expected[i];
  }
  for (std::size_t i = 0; i < rows; ++i) {
    for (std::size_t j = 0; j < rows; ++j) {
      contact.tissueCompliance[i * rows + j] +=
          response[i] * response[j] / measured - expected[i] * expected[j] / predicted;
    }
  }
}

void learnResponse(std::span<const double> change, std::span<const double> response, ContactSystem& contact) {
  double whole = 0.0;
  double ofInstruments = 0.0;
  for (const ContactBlock& block : contact.blocks) {
    const double own = inSpace(block, change).squaredNorm();
    whole += own;
    if (nameOf(block) != 0) ofInstruments += own;
  }
  if (ofInstruments < leastKnown * whole) return;
  ResponseState& learned = contact.learned;
  if (learned.points.size() == maxLearned) {
    const auto oldest = static_cast<std::ptrdiff_t>(learned.points.front());
    learned.points.erase(learned.points.begin());
    learned.key.erase(learned.key.begin(), learned.key.begin() + oldest);
    learned.force.erase(learned.force.begin(), learned.force.begin() + oldest);
    learned.motion.erase(learned.motion.begin(), learned.motion.begin() + oldest);
  }
  std::uint32_t points = 0;
  for (const ContactBlock& block : contact.blocks) {
    if (nameOf(block) == 0) continue;
    ++points;
    learned.key.push_back(nameOf(block));
    learned.force.push_back(inSpace(block, change));
    learned.motion.push_back(inSpace(block, response));
  }
  learned.points.push_back(points);
}

void recallResponses(ContactSystem& contact) {
  if (getenv("NOPAIRS")) return;
  const ResponseState& learned = contact.learned;
  const std::size_t rows = contact.rows;
  std::vector<std::uint64_t> name;
  for (const ContactBlock& block : contact.blocks) name.push_back(nameOf(block));
  std::vector<double> change(rows), response(rows), expected(rows);
  for (std::size_t c = 0, first = 0; c < learned.points.size(); first += learned.points[c], ++c) {
    std::fill(change.begin(), change.end(), 0.0);
    std::vector<bool> isKnown(rows, false);
    double known = 0.0;
    double whole = 0.0;
    for (std::size_t p = first; p < first + learned.points[c]; ++p) {
      whole += learned.force[p].squaredNorm();
      const auto found = std::find(name.begin(), name.end(), learned.key[p]);
      if (found == name.end()) continue;
      const ContactBlock& block = contact.blocks[static_cast<std::size_t>(found - name.begin())];
      for (std::size_t k = 0; k < block.rows(); ++k) {
        const std::size_t i = block.row + k;
        change[i] = learned.force[p].dot(block.direction[k]);
        response[i] = learned.motion[p].dot(block.direction[k]);
        isKnown[i] = true;
        known += change[i] * change[i];
      }
    }
    if (!(known > 0.0) || known < leastKnown * whole) continue;
    double measured = 0.0;
    double predicted = 0.0;
    for (std::size_t i = 0; i < rows; ++i) {
      expected[i] = 0.0;
      for (std::size_t j = 0; j < rows; ++j) expected[i] += contact.tissueCompliance[i * rows + j] * change[j];
      if (!isKnown[i]) response[i] = expected[i];
      measured += change[i] * response[i];
      predicted += change[i] * expected[i];
    }
    if (!(predicted > 0.0) || !(mostOff * measured > predicted) || measured > mostOff * predicted) continue;
    correctCompliance(change, response, expected, contact);
  }
}

}  // namespace calot
