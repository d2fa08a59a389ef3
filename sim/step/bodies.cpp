// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/step/bodies.h"

#include <algorithm>
#include <utility>

namespace calot {

namespace {

/// Memory that the compliances of one body may take when they are computed ahead (bytes). Larger: longer preparation;
/// smaller: large organs compute them in mid-step at first touch. Assumed.
constexpr std::size_t maxPrecomputed = std::size_t{256} << 20U;

bool fitsMemory(std::size_t computed, std::size_t nodes) {
  return nodes == 0 || computed <= maxPrecomputed / (9 * sizeof(float)) / nodes;
}

/// A store may give nothing until a first column was worked out here: a few before all.
void precomputeAll(Body& body, std::span<const int> nodes) {
  body.precomputeCompliance(nodes.first(std::min<std::size_t>(nodes.size(), 1)));
  body.precomputeCompliance(nodes);
}

}  // namespace

Bodies::Bodies(const Model& model, Executor& executor, ComplianceStore* compliances) : model_(model) {
  const SolverDescription& solver = model.scene().solver;
  settings_.step = model.stepSeconds();
  settings_.tolerance = solver.tolerance;
  settings_.cap = solver.iterations;
  settings_.speedTolerance = solver.speedTolerance;
  responseSettings_ = settings_;
  responseSettings_.tolerance = solver.responseTolerance;
  responseSettings_.speedTolerance = solver.responseSpeedTolerance;
  for (std::size_t o = 0; o < model.organs().size(); ++o) {
    auto organ =
        std::make_unique<OrganBody>(model, o, settings_, responseSettings_, executor, ComplianceShelf{compliances, o});
    organ_.push_back(organ.get());
    body_.push_back(std::move(organ));
  }
  for (std::size_t t = 0; t < model.vesselTrees().size(); ++t) {
    auto vessels = std::make_unique<VesselBody>(model, t, settings_.step);
    vessel_.push_back(vessels.get());
    body_.push_back(std::move(vessels));
  }
  for (std::size_t f = 0; f < model.fat().size(); ++f) {
    auto fat = std::make_unique<FatMotion>(model, f, settings_, responseSettings_, executor,
                                           ComplianceShelf{compliances, model.organs().size() + f});
    fat_.push_back(fat.get());
    body_.push_back(std::move(fat));
  }
  joined_ = std::make_unique<JoinedSolids>(model, organ_, vessel_, fat_, sortTies(), settings_, responseSettings_);
}

/// Vessels that are grown to an organ are solved together with it (a tree that is grown to several organs, with the
/// first); fat is solved together with what it is tied to (JoinedSolids). Every other tie is a spring on both sides.
/// @return per organ: ties of vessels that are grown to it, tree by tree
std::vector<std::vector<std::size_t>> Bodies::sortTies() {
  std::vector<std::size_t> organOf(body_.size(), Tie::none);  // of vessel trees
  std::vector<std::vector<std::size_t>> grown(organs());
  springs_.resize(body_.size());
  for (std::size_t t = 0; t < model_.ties().size(); ++t) {
    const Tie& tie = model_.ties()[t];
    const bool isGrown =
        tie.fat == Tie::none && tie.body[0] < organs() && tie.body[1] >= organs() && tie.body[1] < firstFat();
    if (isGrown && organOf[tie.body[1]] == Tie::none) organOf[tie.body[1]] = tie.body[0];
    if (isGrown && organOf[tie.body[1]] == tie.body[0]) {
      grown[tie.body[0]].push_back(t);
      continue;
    }
    for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) springs_[tie.body[side]].emplace_back(t, side);
  }
  for (std::vector<std::size_t>& ties : grown) {
    std::stable_sort(ties.begin(), ties.end(),
                     [&](std::size_t a, std::size_t b) { return model_.ties()[a].body[1] < model_.ties()[b].body[1]; });
  }
  return grown;
}

void Bodies::invalidate() {
  for (FatMotion* fat : fat_) fat->invalidate();
}

void Bodies::precompute() {
  for (std::size_t o = 0; o < organs(); ++o) {
    const OrganModel& organ = model_.organs()[o];
    std::vector<int> nodes;
    for (const Embedding::Anchor& anchor : organ.embedding.anchors()) {
      nodes.insert(nodes.end(), anchor.node.begin(), anchor.node.end());
    }
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    if (fitsMemory(nodes.size(), organ.solid.nodes())) precomputeAll(*body_[o], nodes);
    body_[o]->precompute();
  }
  for (FatMotion* fat : fat_) {
    if (!fitsMemory(fat->nodes(), fat->nodes())) continue;
    std::vector<int> nodes(fat->nodes());
    for (std::size_t n = 0; n < nodes.size(); ++n) nodes[n] = static_cast<int>(n);
    precomputeAll(*fat, nodes);
  }
}

void Bodies::beginStep(const State& state) {
  for (FatMotion* fat : fat_) fat->beginStep(state);
}

double Bodies::shareLeft(const Tie& tie) const {
  return tie.fat == Tie::none ? 1.0 : fat_[tie.fat]->fat().tieShare(tie.fatTie);
}

std::size_t Bodies::firstStructure(std::size_t which) const {
  std::size_t s = 0;
  while (model_.structures()[s].body != which) ++s;
  return s;
}

Activity::Activity(const Model& model)
    : awake(model.bodies(), false),
      quiet(model.bodies(), 0),
      written(model.bodies(), false),
      reshaped(model.bodies(), false),
      frayed(model.connective().size(), false),
      charred(model.organs().size(), false),
      carved(model.fat().size(), false) {}

void Activity::beginStep() {
  std::fill(reshaped.begin(), reshaped.end(), false);
  std::fill(charred.begin(), charred.end(), false);
  std::fill(carved.begin(), carved.end(), false);
}

void Activity::appendWritten(const Bodies& bodies, std::vector<bool>& out) const {
  const auto vessels = written.begin() + static_cast<std::ptrdiff_t>(bodies.organs());
  const auto fat = written.begin() + static_cast<std::ptrdiff_t>(bodies.firstFat());
  out.insert(out.end(), written.begin(), vessels);
  out.insert(out.end(), charred.begin(), charred.end());
  out.insert(out.end(), frayed.begin(), frayed.end());
  out.insert(out.end(), vessels, fat);
  out.insert(out.end(), fat, written.end());
  out.insert(out.end(), carved.begin(), carved.end());
}

bool holdsAnything(const ConnectiveState& tissue) {
  return std::find(tissue.condition.begin(), tissue.condition.end(), StrandCondition::attached) !=
         tissue.condition.end();
}

}  // namespace calot
