// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/step/specimen_hold.h"

#include <algorithm>

#include "sim/tissue/structure.h"

namespace calot {

namespace {

constexpr std::uint32_t specimenSide = 0;
constexpr std::uint32_t stayingSide = 1;
constexpr std::uint32_t sides = 2;

}  // namespace

SpecimenHold::SpecimenHold(const Model& model)
    : model_(model),
      specimen_(indexNamed(model.scene().organs, model.scene().procedure.specimen)),
      holds_(model.fat().size(), false) {
  std::size_t nodes = 0;
  for (const VesselTree& tree : model.vesselTrees()) {
    first_.push_back(nodes);
    nodes += tree.beams.nodes();
  }
  piece_.resize(nodes);
  side_.resize(nodes);
}

/// Divides the vessels where they are parted, and finds each piece's side. What stays decides where it is on both.
void SpecimenHold::findPieces(const State& state) {
  for (std::uint32_t n = 0; n < side_.size(); ++n) side_[n] = sides + n;
  for (std::size_t t = 0; t < first_.size(); ++t) {
    const BeamModel& beams = model_.vesselTrees()[t].beams;
    for (std::size_t n = 0; n < beams.nodes(); ++n) {
      const int before = beams.elementBefore(n);
      const bool begins = before < 0 || state.vessel[t].parting[static_cast<std::size_t>(before)] != Parting::none;
      const std::size_t from = begins ? n : static_cast<std::size_t>(beams.parents()[n]);
      piece_[first_[t] + n] = begins ? static_cast<std::uint32_t>(first_[t] + n) : piece_[first_[t] + from];
      if (beams.fixed(n)) side_[piece_[first_[t] + n]] = stayingSide;
    }
  }
  const std::size_t organs = model_.organs().size();
  for (const Tie& tie : model_.ties()) {
    if (tie.fat != Tie::none) continue;
    for (std::size_t s = 0; s < 2; ++s) {
      if (tie.body[s] < organs || tie.body[1 - s] >= organs) continue;
      const std::size_t node = first_[tie.body[s] - organs] + static_cast<std::size_t>(tie.place[s].node[0]);
      std::uint32_t& side = side_[piece_[node]];
      if (side != stayingSide) side = tie.body[1 - s] == specimen_ ? specimenSide : stayingSide;
    }
  }
}

void SpecimenHold::run(Bodies& bodies, const Activity& activity, const State& state, StepResult& result) {
  const std::size_t organs = model_.organs().size();
  const auto changed = std::find(activity.reshaped.begin() + static_cast<std::ptrdiff_t>(organs),
                                 activity.reshaped.end(), true) != activity.reshaped.end();
  if (specimen_ < organs && !holds_.empty() && (changed || !known_)) {
    findPieces(state);
    for (std::size_t f = 0; f < holds_.size(); ++f) {
      thing_.assign(model_.fat()[f]->allTies().size(), stayingSide);
      for (const Tie& tie : model_.ties()) {
        if (tie.fat != f) continue;
        const std::size_t body = tie.body[0];
        if (body == specimen_) thing_[tie.fatTie] = specimenSide;
        if (body < organs) continue;
        thing_[tie.fatTie] = side_[piece_[first_[body - organs] + static_cast<std::size_t>(tie.place[0].node[0])]];
      }
      holds_[f] = bodies.fat(f).joins(thing_, sides + static_cast<std::uint32_t>(side_.size()));
    }
    known_ = true;
  }
  for (std::size_t f = 0; f < holds_.size(); ++f) result.fat[f].holdsSpecimen = holds_[f];
}

}  // namespace calot
