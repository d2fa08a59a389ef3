// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/step/joined_solids.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace calot {

namespace {

/// With fat no tolerance of speed ends a solve (solveUnconstrained()), and its relative tolerance is by this larger.
/// Larger: motion of fat is less exact; smaller: slower, with no figure of a grade nearer to its limit
/// (docs/explanation/accuracy.md).
constexpr double fatToleranceFactor = 10.0;
/// Tolerance of speed of solves that others of the same step go on from, over that of responses. Larger: contact takes
/// more passes; smaller: solves do what the next ones do again. Measured on the whole operation.
constexpr double looseFactor = 3.0;

}  // namespace

JoinedSolids::JoinedSolids(const Model& model, std::vector<OrganBody*> organs, const std::vector<VesselBody*>& vessels,
                           const std::vector<FatMotion*>& fat, const std::vector<std::vector<std::size_t>>& grown,
                           const SolidSolver::Settings& settings, const SolidSolver::Settings& responses)
    : organs_(organs.size()), vessels_(vessels.size()), settings_(settings), responses_(responses) {
  for (std::size_t c = 0; c < model.connective().size(); ++c)
    coupling_.push_back(std::make_unique<StrandCoupling>(model, c, settings.step));
  std::vector<std::unique_ptr<Coupling>> last;
  for (std::size_t o = 0; o < grown.size(); ++o) {
    if (grown[o].empty()) continue;
    auto made = std::make_unique<GrownVessels>(model, o, grown[o], settings.step, *organs[o], vessels);
    grown_.push_back(made.get());
    last.push_back(std::move(made));
  }
  for (std::size_t f = 0; f < fat.size(); ++f) {
    const std::size_t body = firstFat() + f;
    for (std::size_t o = 0; o < organs.size(); ++o) {
      std::vector<std::size_t> ties;
      for (std::size_t t = 0; t < model.ties().size(); ++t) {
        if (model.ties()[t].fat == f && model.ties()[t].body[0] == o) ties.push_back(t);
      }
      if (ties.empty()) continue;
      coupling_.push_back(
          std::make_unique<FatTies>(model, o, body, std::move(ties), settings.step, *organs[o], *fat[f]));
    }
    for (std::size_t v = 0; v < vessels.size(); ++v) {
      const auto holder = std::find_if(grown_.begin(), grown_.end(),
                                       [&](const GrownVessels* g) { return g->joins(organs.size() + v); });
      auto made = std::make_unique<VesselsInFat>(model, body, f, v, settings.step, *fat[f], *vessels[v],
                                                 holder == grown_.end() ? nullptr : *holder);
      if (made->exists()) coupling_.push_back(std::move(made));
    }
  }
  std::move(last.begin(), last.end(), std::back_inserter(coupling_));
  solid_.assign(organs.begin(), organs.end());
  solid_.insert(solid_.end(), fat.begin(), fat.end());
  first_.resize(solid_.size());
}

void JoinedSolids::join(std::size_t a, std::size_t b) {
  const std::size_t kept = std::min(first_[numberOf(a)], first_[numberOf(b)]);
  const std::size_t merged = std::max(first_[numberOf(a)], first_[numberOf(b)]);
  std::replace(first_.begin(), first_.end(), merged, kept);
}

void JoinedSolids::linearise(const State& state, const std::vector<bool>& awake) {
  for (std::size_t s = 0; s < first_.size(); ++s) first_[s] = bodyOf(s);
  for (const std::unique_ptr<Coupling>& coupling : coupling_) {
    coupling->linearise(state, awake);
    if (coupling->holds()) join(coupling->bodies()[0], coupling->bodies()[1]);
  }
  std::size_t groups = 0;
  for (std::size_t s = 0; s < first_.size(); ++s) {
    if (first_[s] != bodyOf(s)) continue;
    if (group_.size() == groups) group_.emplace_back();
    std::vector<std::size_t>& group = group_[groups++];
    group.clear();
    for (std::size_t other = s; other < first_.size(); ++other) {
      if (first_[other] == first_[s]) group.push_back(bodyOf(other));
    }
  }
  group_.resize(groups);
  open_.assign(groups, false);
}

void JoinedSolids::addLoads(std::size_t body, std::vector<Attachment>& attachments,
                            std::vector<JointAttachment>& joints) const {
  for (const std::unique_ptr<Coupling>& coupling : coupling_) {
    if (coupling->holds()) coupling->load(body, attachments, joints);
  }
}

void JoinedSolids::passOn(std::size_t body, std::vector<Vec3>& impulse) {
  for (const std::unique_ptr<Coupling>& coupling : coupling_) {
    if (coupling->holds()) coupling->passOn(body, impulse);
  }
}

SolveReport JoinedSolids::solveUnconstrained(std::size_t group, bool loose) {
  for (const std::unique_ptr<Coupling>& coupling : coupling_) {
    if (isOf(*coupling, group)) coupling->assemble();
  }
  SolidSolver::Settings settings = settings_;
  // Corners of nearly empty cubes weigh next to nothing: with a tolerance of speed they go on trembling.
  if (group_[group].back() >= firstFat()) {
    settings.speedTolerance = 0.0;
    settings.tolerance *= fatToleranceFactor;
  }
  if (loose) settings.speedTolerance = std::max(settings.speedTolerance, looseFactor * responses_.speedTolerance);
  open_[group] = loose;
  return solve(group, settings);
}

SolveReport JoinedSolids::applyImpulses(std::size_t group, bool loose) {
  SolidSolver::Settings settings = responses_;
  settings.goesOn = true;
  if (loose) settings.speedTolerance *= looseFactor;
  open_[group] = loose;
  return solve(group, settings);
}

SolveReport JoinedSolids::solve(std::size_t group, const SolidSolver::Settings& settings) {
  const std::vector<std::size_t>& bodies = group_[group];
  const auto number = [&](std::size_t body) {
    return static_cast<std::size_t>(std::find(bodies.begin(), bodies.end(), body) - bodies.begin());
  };
  solver_.clear();
  coupled_.clear();
  active_.clear();
  for (const std::size_t b : bodies) solver_.push_back(&solid(b).solver());
  for (const std::unique_ptr<Coupling>& coupling : coupling_) {
    if (!isOf(*coupling, group)) continue;
    active_.push_back(coupling.get());
    if (SystemCoupling* const system = coupling->system(); system != nullptr)
      coupled_.push_back({number(coupling->bodies()[0]), number(coupling->bodies()[1]), *system});
  }
  const SolveReport report = SolidSolver::solveJoined(solver_, coupled_, settings);
  for (Coupling* coupling : active_) coupling->follow();
  for (Coupling* coupling : active_) coupling->see();
  return report;
}

}  // namespace calot
