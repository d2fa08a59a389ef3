// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/step/bodies.h"

#include <algorithm>
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

JoinedSolids::JoinedSolids(const Model& model, std::vector<OrganBody*> organs, std::vector<VesselBody*> vessels,
                           std::vector<FatMotion*> fat, const SolidSolver::Settings& settings,
                           const SolidSolver::Settings& responses)
    : model_(model),
      organ_(std::move(organs)),
      vessel_(std::move(vessels)),
      fat_(std::move(fat)),
      settings_(settings),
      responses_(responses) {
  solid_.assign(organ_.begin(), organ_.end());
  solid_.insert(solid_.end(), fat_.begin(), fat_.end());
  first_.resize(solid_.size());
  for (const ConnectiveModel& tie : model.connective()) {
    std::vector<std::array<MaterialPoint, 2>> points;
    for (const Strand& strand : tie.tissue.strands()) points.push_back({strand.a, strand.b});
    tissue_.emplace_back().coupling = std::make_unique<PointCoupling>(model.organs()[tie.a].solid.system(),
                                                                      model.organs()[tie.b].solid.system(), points);
  }
  for (std::size_t f = 0; f < fat_.size(); ++f) {
    for (std::size_t o = 0; o < organ_.size(); ++o) {
      FatTies ties;
      ties.organ = o;
      ties.fat = f;
      for (std::size_t t = 0; t < model.ties().size(); ++t) {
        const Tie& tie = model.ties()[t];
        if (tie.fat != f || tie.body[0] != o) continue;
        ties.tie.push_back(t);
        ties.place.push_back(tie.place);
      }
      ties.damper.resize(ties.tie.size());
      if (!ties.tie.empty()) fatTies_.push_back(std::move(ties));
    }
    for (std::size_t v = 0; v < vessel_.size(); ++v) {
      auto reaction = std::make_unique<VesselReaction>(model, f, v);
      if (reaction->exists()) reaction_.push_back(std::move(reaction));
    }
  }
}

void JoinedSolids::join(std::size_t a, std::size_t b) {
  const std::size_t kept = std::min(first_[numberOf(a)], first_[numberOf(b)]);
  const std::size_t merged = std::max(first_[numberOf(a)], first_[numberOf(b)]);
  std::replace(first_.begin(), first_.end(), merged, kept);
}

void JoinedSolids::lineariseTissues(const State& state, const std::vector<bool>& awake) {
  for (std::size_t c = 0; c < tissue_.size(); ++c) {
    const ConnectiveModel& tie = model_.connective()[c];
    const SolidState& a = state.organ[tie.a];
    const SolidState& b = state.organ[tie.b];
    Tissue& tissue = tissue_[c];
    tissue.holds = false;
    if (!awake[tie.a]) continue;  // organs that strands tie are awake together
    calot::linearise(tie.tissue, state.connective[c], {a.position, a.velocity, a.rotation},
                     {b.position, b.velocity, b.rotation}, settings_.step, tissue.loads);
    tissue.holds = !tissue.loads.onA.empty();
    if (!tissue.holds) continue;
    tissue.coupling->assemble(tissue.loads.damper, settings_.step);
    join(tie.a, tie.b);
  }
}

TieCoupling* JoinedSolids::grownOf(std::span<TieCoupling> grown, std::size_t tree) const {
  for (TieCoupling& c : grown) {
    if (c.joins(organ_.size() + tree)) return &c;
  }
  return nullptr;
}

void JoinedSolids::lineariseFatTies(const State& state, const std::vector<bool>& awake, std::span<TieCoupling> grown) {
  for (FatTies& ties : fatTies_) {
    ties.holds = false;
    if (!awake[ties.organ]) continue;  // what ties hold together is awake together
    for (std::size_t i = 0; i < ties.tie.size(); ++i) {
      const Tie& tie = model_.ties()[ties.tie[i]];
      ties.damper[i] = fat_[ties.fat]->fat().tieShare(tie.fatTie) * (settings_.step * tie.stiffness + tie.damping);
      ties.holds = ties.holds || ties.damper[i] > 0.0;
    }
    if (ties.holds) join(ties.organ, firstFat() + ties.fat);
  }
  for (const std::unique_ptr<VesselReaction>& reaction : reaction_) {
    reaction->linearise(state, awake[firstFat() + reaction->fat()], *fat_[reaction->fat()], settings_.step);
    const TieCoupling* const tie = grownOf(grown, reaction->tree());
    if (reaction->holds() && tie != nullptr) join(tie->organ(), firstFat() + reaction->fat());
  }
}

void JoinedSolids::linearise(const State& state, const std::vector<bool>& awake, std::span<TieCoupling> grown) {
  for (std::size_t s = 0; s < first_.size(); ++s) first_[s] = bodyOf(s);
  lineariseTissues(state, awake);
  lineariseFatTies(state, awake, grown);
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

void JoinedSolids::addAttachments(std::size_t organ, std::vector<Attachment>& out) const {
  for (std::size_t c = 0; c < tissue_.size(); ++c) {
    const ConnectiveModel& tie = model_.connective()[c];
    const ConnectiveLoads& loads = tissue_[c].loads;
    if (!tissue_[c].holds) continue;
    if (tie.a == organ) out.insert(out.end(), loads.onA.begin(), loads.onA.end());
    if (tie.b == organ) out.insert(out.end(), loads.onB.begin(), loads.onB.end());
  }
}

void JoinedSolids::passOn(std::size_t body, std::vector<Vec3>& impulse) {
  for (const std::unique_ptr<VesselReaction>& reaction : reaction_) {
    if (!reaction->holds() || firstFat() + reaction->fat() != body) continue;
    reaction->passOn(*fat_[reaction->fat()], *vessel_[reaction->tree()], impulse);
  }
}

SolveReport JoinedSolids::solveUnconstrained(std::size_t group, std::span<TieCoupling> grown, bool loose) {
  const std::size_t first = group_[group][0];
  for (FatTies& ties : fatTies_) {
    if (!ties.holds || first_[ties.organ] != first) continue;
    SolidSolver& fat = fat_[ties.fat]->solver();
    if (ties.coupling == nullptr || ties.version != fat.systemVersion()) {
      ties.coupling = std::make_unique<PointCoupling>(organ_[ties.organ]->solver().system(), fat.system(), ties.place);
      ties.version = fat.systemVersion();
    }
    ties.coupling->assemble(ties.damper, settings_.step);
  }
  for (const std::unique_ptr<VesselReaction>& reaction : reaction_) {
    if (!isOf(*reaction, first)) continue;
    TieCoupling* const tie = grownOf(grown, reaction->tree());
    reaction->assemble(*fat_[reaction->fat()], *vessel_[reaction->tree()], tie,
                       tie != nullptr ? &organ_[tie->organ()]->solver().system() : nullptr);
  }
  SolidSolver::Settings settings = settings_;
  // Corners of nearly empty cubes weigh next to nothing: with a tolerance of speed they go on trembling.
  if (group_[group].back() >= firstFat()) {
    settings.speedTolerance = 0.0;
    settings.tolerance *= fatToleranceFactor;
  }
  if (loose) settings.speedTolerance = std::max(settings.speedTolerance, looseFactor * responses_.speedTolerance);
  open_[group] = loose;
  return solve(group, grown, settings);
}

SolveReport JoinedSolids::applyImpulses(std::size_t group, std::span<TieCoupling> grown, bool loose) {
  SolidSolver::Settings settings = responses_;
  settings.goesOn = true;
  if (loose) settings.speedTolerance *= looseFactor;
  open_[group] = loose;
  return solve(group, grown, settings);
}

SolveReport JoinedSolids::solve(std::size_t group, std::span<TieCoupling> grown,
                                const SolidSolver::Settings& settings) {
  const std::vector<std::size_t>& bodies = group_[group];
  const auto number = [&](std::size_t body) {
    return static_cast<std::size_t>(std::find(bodies.begin(), bodies.end(), body) - bodies.begin());
  };
  solver_.clear();
  coupled_.clear();
  for (const std::size_t b : bodies) solver_.push_back(&solid(b).solver());
  for (std::size_t c = 0; c < tissue_.size(); ++c) {
    const ConnectiveModel& tie = model_.connective()[c];
    if (!tissue_[c].holds || first_[tie.a] != bodies[0]) continue;
    coupled_.push_back({number(tie.a), number(tie.b), *tissue_[c].coupling});
  }
  for (const FatTies& ties : fatTies_) {
    if (!ties.holds || first_[ties.organ] != bodies[0]) continue;
    coupled_.push_back({number(ties.organ), number(firstFat() + ties.fat), *ties.coupling});
  }
  for (const std::unique_ptr<VesselReaction>& reaction : reaction_) {
    if (!isOf(*reaction, bodies[0])) continue;
    const TieCoupling* const tie = grownOf(grown, reaction->tree());
    const std::size_t fat = number(firstFat() + reaction->fat());
    coupled_.push_back({tie != nullptr ? number(tie->organ()) : fat, fat, *reaction});
  }
  const SolveReport report = SolidSolver::solveJoined(solver_, coupled_, settings);
  for (const std::unique_ptr<VesselReaction>& reaction : reaction_) {
    if (isOf(*reaction, bodies[0])) reaction->pull(*fat_[reaction->fat()], *vessel_[reaction->tree()]);
  }
  for (TieCoupling& tie : grown) {
    if (number(tie.organ()) < bodies.size()) tie.pull(organ_[tie.organ()]->freeVelocity(), vessel_);
  }
  for (const std::unique_ptr<VesselReaction>& reaction : reaction_) {
    if (isOf(*reaction, bodies[0])) reaction->see(*vessel_[reaction->tree()]);
  }
  return report;
}

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
  joined_ = std::make_unique<JoinedSolids>(model, organ_, vessel_, fat_, settings_, responseSettings_);
  sortTies();
}

/// Vessels that are grown to an organ are solved together with it (a tree that is grown to several organs, with the
/// first); fat is solved together with what it is tied to (JoinedSolids). Every other tie is a spring on both sides.
void Bodies::sortTies() {
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
  for (std::size_t o = 0; o < grown.size(); ++o) {
    if (grown[o].empty()) continue;
    std::stable_sort(grown[o].begin(), grown[o].end(),
                     [&](std::size_t a, std::size_t b) { return model_.ties()[a].body[1] < model_.ties()[b].body[1]; });
    coupling_.emplace_back(model_, o, grown[o], settings_.step);
  }
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
