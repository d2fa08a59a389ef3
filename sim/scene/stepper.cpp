// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/scene/stepper.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>
#include <vector>

#include "sim/contact/complementarity.h"
#include "sim/contact/shaft_contact.h"
#include "sim/instruments/port.h"
#include "sim/math/floating_point.h"

namespace calot {

namespace {

constexpr double pieceLength = 0.02;       ///< of the shaft, in contact (m)
constexpr std::size_t mostPieces = 15;     ///< the last one takes the rest of the shaft
constexpr double margin = 0.001;           ///< contacts nearer than this are watched even at rest (m)
constexpr double slack = 0.0005;           ///< rows whose free gap is larger take no part (m)
constexpr double largestSlide = 0.005;     ///< of a tip near a surface in one step (m)
constexpr int largestAdvances = 16;        ///< conservative advancements a step
constexpr double quietSpeed = 1e-5;        ///< m/s
constexpr std::uint32_t quietSteps = 50;   ///< before an organ sleeps
constexpr double leastForce = 1e-6;        ///< N; below, nothing counts as touching
constexpr double broadCell = 0.02;         ///< m

/// One row of the contact problem.
struct Row {
  std::size_t hand = 0;
  std::size_t organ = 0;
  ShaftContact contact;
  SolidSolver::Impulse place;     ///< where and along what the organ is pushed
  Vec3 direction = Vec3::Zero();  ///< row of T: how the tip's displacement opens the gap
  double free = 0.0;              ///< gap without forces, tip moved as far as this step lets it (m)
  double freeFull = 0.0;          ///< the same, tip at its real place
};

struct Shaft {
  Vec3 port = Vec3::Zero();
  Vec3 tip = Vec3::Zero();
  Vec3 axis = Vec3::Zero();
  double length = 0.0;
  double radius = 0.0;

  Shaft(const Vec3& port_, const Vec3& tip_, double radius_) : port(port_), tip(tip_), radius(radius_) {
    const Vec3 reach = tip - port;
    length = reach.norm();
    axis = reach / length;
  }
  /// Pieces from the tip towards the port; the capsule's cap ends at the tip.
  [[nodiscard]] std::size_t pieces() const {
    const double inside = std::max(length - radius, 0.0);
    return std::clamp<std::size_t>(static_cast<std::size_t>(inside / pieceLength) + 1, 1, mostPieces);
  }
  [[nodiscard]] std::pair<Vec3, Vec3> piece(std::size_t k) const {
    const double from = radius + pieceLength * static_cast<double>(k);
    const double to = k + 1 == pieces() ? length : from + pieceLength;
    return {tip - std::min(from, length) * axis, tip - std::min(to, length) * axis};
  }
};

bool isMeasurement(const InstrumentSample& s) {
  return s.valid && s.position.allFinite() && s.orientation.coeffs().allFinite() && std::isfinite(s.jaw) &&
         s.orientation.coeffs().norm() > 0.5;
}

Vec3 clampedToWorkspace(const SceneDescription& scene, const Vec3& p) {
  return p.cwiseMax(scene.workspace[0]).cwiseMin(scene.workspace[1]);
}

Vec3 axisOf(const Vec3& port, const Vec3& tip) {
  const Vec3 reach = tip - port;
  const double length = reach.norm();
  return length > 1e-6 ? Vec3(reach / length) : Vec3(0.0, 0.0, -1.0);
}

/// The contact's place on the skin in terms of the solid's nodes: corner weights times anchor weights.
SolidSolver::Impulse influence(const ShaftContact& contact, const Embedding& embedding) {
  SolidSolver::Impulse out;
  for (std::size_t corner = 0; corner < 3; ++corner) {
    const Embedding::Anchor& anchor = embedding.anchors()[static_cast<std::size_t>(contact.node[corner])];
    for (std::size_t a = 0; a < 4; ++a) {
      out.node[4 * corner + a] = anchor.node[a];
      out.weight[4 * corner + a] = contact.weight[static_cast<int>(corner)] * anchor.weight[a];
    }
  }
  out.impulse = contact.normal;
  return out;
}

/// A nodal quantity at the contact's place.
Vec3 atContact(const SolidSolver::Impulse& place, const std::vector<Vec3>& values) {
  Vec3 sum = Vec3::Zero();
  for (std::size_t k = 0; k < place.node.size(); ++k) sum += place.weight[k] * values[static_cast<std::size_t>(place.node[k])];
  return sum;
}

}  // namespace

struct Stepper::Workspace {
  Workspace(const Model& model_, Executor& executor_, MakeBroadPhase make) : model(model_), executor(executor_) {
    solver.resize(model.organs().size());
    skin.resize(model.organs().size());
    for (std::size_t o = 0; o < model.organs().size(); ++o) {
      broad.push_back(make != nullptr ? make() : std::make_unique<SortedGrid>(broadCell));
    }
    settings.step = model.stepSeconds();
    settings.tolerance = model.scene().solver.tolerance;
    settings.cap = model.scene().solver.iterations;
    result.organ.resize(model.organs().size());
    for (HandResult& hand : result.hand) hand.organForce.resize(model.organs().size());
    invalidate();
  }

  void invalidate() {
    bounded.assign(model.organs().size(), false);
    digest.reset();
    for (ContactSet& set : contactSet) set = {};
  }

  void readSamples(State& state, std::span<const TickSamples> samples);
  void refreshBounds(const State& state);
  void patchesNear(std::size_t organ, const Box& box, std::vector<std::uint32_t>& out);
  double gapOf(const Shaft& shaft, double reach);
  void advanceFreely(State& state, std::size_t hand);
  void detect(const State& state);
  void wakeAndMove(State& state);
  void buildProblem(const State& state);
  void solveContacts(State& state);
  void applyForces(State& state);
  void finishOrgans(State& state);
  void finishHands(State& state);
  void publish(const State& state);
  void emit(EventKind kind, std::size_t hand, std::uint16_t subject, const Vec3& position, double value);

  const Model& model;
  Executor& executor;
  SolidSolver::Settings settings;
  std::vector<SolidSolver> solver;             // per organ
  std::vector<std::unique_ptr<BroadPhase>> broad;
  std::vector<bool> bounded;                   // per organ: broad phase holds bounds of the current positions
  std::vector<bool> moved;                     // per organ: solved in this step
  std::vector<std::vector<Vec3>> skin;         // per organ: surface points of the current positions
  std::vector<Box> bounds;
  std::vector<BroadPhase::Pair> pairs;
  std::vector<std::uint32_t> patches;
  std::vector<ShaftContact> found;
  std::array<Vec3, handCount> remaining{};     // of the tip's way to its real place (m)
  std::array<double, handCount> share{};       // of that way which this step lets it go
  std::array<double, handCount> reach{};       // how far contacts were looked for (m)
  std::vector<Row> rows;
  std::vector<SolidSolver::Impulse> impulses;
  std::vector<std::vector<Vec3>> batch;
  std::vector<std::vector<Vec3>> response;     // per row: velocity of the organ's nodes for a unit impulse
  std::vector<double> compliance, freeGap, lambda;
  std::vector<std::vector<Vec3>> correction;   // per organ
  std::array<ContactSet, handCount> contactSet;
  IncrementalDigest digest;
  StepResult result;
};

void Stepper::Workspace::emit(EventKind kind, std::size_t hand, std::uint16_t subject, const Vec3& position,
                              double value) {
  result.events.push_back({result.step, kind, static_cast<std::uint8_t>(hand), subject, position, value});
}

/// The newest measurement of each hand, and the newest camera.
void Stepper::Workspace::readSamples(State& state, std::span<const TickSamples> samples) {
  const SceneDescription& scene = model.scene();
  for (std::size_t h = 0; h < handCount; ++h) {
    HandState& hand = state.hand[h];
    const InstrumentSample* newest = nullptr;
    for (const TickSamples& tick : samples) {
      if (isMeasurement(tick.hand[h])) newest = &tick.hand[h];
    }
    const bool valid = isMeasurement(samples.back().hand[h]);
    if (hand.valid && !valid) {
      hand.invalidSince = state.clock.step;
      emit(EventKind::sampleInvalid, h, 0, hand.realPosition, 0.0);
    } else if (!hand.valid && valid) {
      emit(EventKind::sampleValid, h, 0, hand.realPosition,
           static_cast<double>(state.clock.step - hand.invalidSince) * settings.step);
    }
    hand.valid = valid;
    if (newest == nullptr) continue;
    if (newest->instrument != hand.instrument) {
      emit(EventKind::instrumentExchange, h, static_cast<std::uint16_t>(newest->instrument), hand.realPosition,
           static_cast<double>(hand.instrument));
      hand.instrument = newest->instrument;
    }
    const double outside = (newest->position - clampedToWorkspace(scene, newest->position)).norm();
    if (outside > 0.0 && !hand.outside) emit(EventKind::outOfWorkspace, h, 0, newest->position, outside);
    hand.outside = outside > 0.0;
    const Vec3& port = scene.hands[h].port;
    Quat orientation = newest->orientation;
    orientation.coeffs() /= orientation.coeffs().norm();
    const Pose pose = throughPort(port, clampedToWorkspace(scene, newest->position), orientation,
                                  axisOf(port, hand.realPosition));
    hand.realPosition = pose.position;
    hand.realOrientation = pose.orientation;
    hand.jaw = std::clamp(newest->jaw, 0.0, 1.6);
    hand.buttons = newest->buttons;
  }
  const CameraSample& camera = samples.back().camera;
  const double size = camera.orientation.coeffs().norm();
  if (camera.position.allFinite() && std::isfinite(size) && size > 0.5) {
    state.camera.position = camera.position;
    state.camera.orientation = camera.orientation;
    state.camera.orientation.coeffs() /= size;
  }
}

void Stepper::Workspace::refreshBounds(const State& state) {
  for (std::size_t o = 0; o < model.organs().size(); ++o) {
    if (bounded[o]) continue;
    model.organs()[o].embedding.map(state.organ[o].position, skin[o]);
    patchBounds(model.organs()[o].surface, skin[o], 0.0, bounds);
    broad[o]->update(bounds);
    bounded[o] = true;
  }
}

void Stepper::Workspace::patchesNear(std::size_t organ, const Box& box, std::vector<std::uint32_t>& out) {
  broad[organ]->pairs({&box, 1}, pairs);
  out.clear();
  for (const BroadPhase::Pair& p : pairs) out.push_back(p.leaf);
}

/// Least gap between a shaft and all organs, at most `reach_`. @pre refreshBounds() since organs moved
double Stepper::Workspace::gapOf(const Shaft& shaft, double reach_) {
  double least = reach_;
  for (std::size_t o = 0; o < model.organs().size(); ++o) {
    for (std::size_t k = 0; k < shaft.pieces(); ++k) {
      const auto [p0, p1] = shaft.piece(k);
      Box box;
      box.include(p0);
      box.include(p1);
      box.grow(shaft.radius + std::max(least, 0.0) + 1e-6);
      patchesNear(o, box, patches);
      if (patches.empty()) continue;
      least = leastGap(model.organs()[o].surface, skin[o], patches, p0, p1, shaft.radius, least);
    }
  }
  return least;
}

/// Conservative advancement (Mirtich 1996): the simulated tip goes towards the real one as far as free space reaches,
/// so that nothing is passed through on the way. A displacement d of the tip moves no point of the shaft by more.
void Stepper::Workspace::advanceFreely(State& state, std::size_t hand) {
  HandState& h = state.hand[hand];
  const HandDescription& description = model.scene().hands[hand];
  remaining[hand] = h.realPosition - h.simulatedPosition;
  for (int i = 0; i < largestAdvances; ++i) {
    const double left = remaining[hand].norm();
    if (!(left > 0.0)) break;
    const Shaft shaft(description.port, h.simulatedPosition, description.shaftRadius);
    const double gap = gapOf(shaft, left + 2.0 * margin);
    if (gap >= left + margin) {
      h.simulatedPosition = h.realPosition;
      remaining[hand].setZero();
      break;
    }
    if (gap <= 1.05 * margin) break;
    h.simulatedPosition += remaining[hand] * ((gap - margin) / left);
    remaining[hand] = h.realPosition - h.simulatedPosition;
  }
  const double left = remaining[hand].norm();
  share[hand] = left > largestSlide ? largestSlide / left : 1.0;
  reach[hand] = margin + std::min(left, largestSlide);
}

/// Rows of every shaft near every organ, in order of hand, organ and place.
void Stepper::Workspace::detect(const State& state) {
  rows.clear();
  for (std::size_t h = 0; h < handCount; ++h) {
    if (state.hand[h].instrument == InstrumentKind::none) continue;
    const HandDescription& description = model.scene().hands[h];
    const Shaft shaft(description.port, state.hand[h].simulatedPosition, description.shaftRadius);
    for (std::size_t o = 0; o < model.organs().size(); ++o) {
      double speed = 0.0;
      for (const Vec3& v : state.organ[o].velocity) speed = std::max(speed, v.squaredNorm());
      const double far = reach[h] + std::min(std::sqrt(speed) * settings.step, largestSlide);
      found.clear();
      for (std::size_t k = 0; k < shaft.pieces(); ++k) {
        const auto [p0, p1] = shaft.piece(k);
        Box box;
        box.include(p0);
        box.include(p1);
        box.grow(shaft.radius + far + 1e-6);
        patchesNear(o, box, patches);
        shaftContacts(model.organs()[o].surface, skin[o], patches, p0, p1, shaft.radius, far,
                      static_cast<std::uint32_t>(k), found);
      }
      for (const ShaftContact& contact : found) {
        Row row;
        row.hand = h;
        row.organ = o;
        row.contact = contact;
        row.place = influence(contact, model.organs()[o].embedding);
        row.contact.key |= static_cast<std::uint64_t>(o) << 52U;
        const double s = (contact.onAxis - shaft.port).dot(shaft.axis);
        row.direction = shaftTranspose(shaft.axis, s, shaft.length, contact.normal);
        rows.push_back(row);
      }
    }
  }
}

/// Wakes the organs that a shaft is about to touch, and computes the free motion of all that are awake.
void Stepper::Workspace::wakeAndMove(State& state) {
  for (const Row& row : rows) {
    const double approach = share[row.hand] * row.direction.dot(remaining[row.hand]);
    if (row.contact.gap + std::min(approach, 0.0) < slack) state.organ[row.organ].quietSteps = 0;
  }
  moved.assign(model.organs().size(), false);
  for (std::size_t o = 0; o < model.organs().size(); ++o) {
    OrganResult& out = result.organ[o];
    out.asleep = model.scene().solver.sleeping && state.organ[o].quietSteps >= quietSteps;
    out.residual = 0.0;
    out.iterations = 0;
    if (out.asleep) continue;
    moved[o] = true;
    const SolveReport report =
        solver[o].freeMotion(model.organs()[o].solid, state.organ[o], model.scene().gravity, {}, settings, executor);
    out.residual = report.residual;
    out.iterations = report.iterations;
    if (!report.converged) {
      result.misses |= miss::solver;
      emit(EventKind::solverMiss, 255, static_cast<std::uint16_t>(o), Vec3::Zero(), report.residual);
    }
  }
}

/// Free gaps, and the compliance of organs and virtual couplings between all rows that take part.
void Stepper::Workspace::buildProblem(const State& state) {
  const double h = settings.step;
  for (Row& row : rows) {
    double organMoves = 0.0;
    if (moved[row.organ]) organMoves = h * row.contact.normal.dot(atContact(row.place, solver[row.organ].freeVelocity()));
    const double toolMoves = row.direction.dot(remaining[row.hand]);
    row.free = row.contact.gap + share[row.hand] * toolMoves - organMoves;
    row.freeFull = row.contact.gap + toolMoves - organMoves;
  }
  std::erase_if(rows, [&](const Row& row) { return std::min(row.free, row.freeFull) > slack || !moved[row.organ]; });

  const std::size_t n = rows.size();
  response.resize(n);
  for (std::size_t o = 0; o < model.organs().size(); ++o) {
    std::vector<std::size_t> mine;
    for (std::size_t i = 0; i < n; ++i) {
      if (rows[i].organ == o) mine.push_back(i);
    }
    for (std::size_t first = 0; first < mine.size(); first += laneCount) {
      const std::size_t last = std::min(mine.size(), first + laneCount);
      impulses.clear();
      for (std::size_t k = first; k < last; ++k) impulses.push_back(rows[mine[k]].place);
      const SolveReport report = solver[o].responses(model.organs()[o].solid, impulses, settings, batch, executor);
      result.organ[o].iterations += report.iterations;
      result.organ[o].residual = std::max(result.organ[o].residual, report.residual);
      if (!report.converged) {
        result.misses |= miss::solver;
        emit(EventKind::solverMiss, 255, static_cast<std::uint16_t>(o), Vec3::Zero(), report.residual);
      }
      for (std::size_t k = first; k < last; ++k) response[mine[k]].swap(batch[k - first]);
    }
  }
  compliance.assign(n * n, 0.0);
  freeGap.resize(n);
  lambda.assign(n, 0.0);
  for (std::size_t i = 0; i < n; ++i) {
    freeGap[i] = rows[i].free;
    const HandState& hand = state.hand[rows[i].hand];
    for (std::size_t k = 0; k < hand.contactKey.size(); ++k) {
      if (hand.contactKey[k] == rows[i].contact.key) lambda[i] = hand.contactForce[k];
    }
    for (std::size_t j = 0; j < n; ++j) {
      double w = 0.0;
      if (rows[i].organ == rows[j].organ) {
        // Both orders of the two solves, so that W is symmetric although each solve stops at its tolerance.
        const double ij = rows[i].contact.normal.dot(atContact(rows[i].place, response[j]));
        const double ji = rows[j].contact.normal.dot(atContact(rows[j].place, response[i]));
        w += h * h * (0.5 * (ij + ji));
      }
      if (rows[i].hand == rows[j].hand) {
        w += rows[i].direction.dot(rows[j].direction) / model.scene().hands[rows[i].hand].couplingStiffness;
      }
      compliance[i * n + j] = w;
    }
  }
}

void Stepper::Workspace::solveContacts(State& state) {
  const SolverDescription& solverSettings = model.scene().solver;
  const ComplementarityReport report = solveComplementarity(compliance, freeGap, lambda, solverSettings.contactTolerance,
                                                            solverSettings.contactIterations);
  result.contact.rows = static_cast<std::uint32_t>(rows.size());
  result.contact.iterations = report.sweeps;
  result.contact.residual = report.residual;
  if (!report.converged) {
    result.misses |= miss::contact;
    emit(EventKind::contactMiss, 255, 0, Vec3::Zero(), report.residual);
  }
  for (HandState& hand : state.hand) {
    hand.contactKey.clear();
    hand.contactForce.clear();
  }
  for (std::size_t i = 0; i < rows.size(); ++i) {
    state.hand[rows[i].hand].contactKey.push_back(rows[i].contact.key);
    state.hand[rows[i].hand].contactForce.push_back(lambda[i]);
  }
}

/// Moves organs and instruments by what the contact forces do to them.
void Stepper::Workspace::applyForces(State& state) {
  const double h = settings.step;
  correction.resize(model.organs().size());
  for (std::size_t o = 0; o < model.organs().size(); ++o) {
    correction[o].clear();
    if (!moved[o]) continue;
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (rows[i].organ != o || !(lambda[i] > 0.0)) continue;
      if (correction[o].empty()) correction[o].assign(model.organs()[o].solid.nodes(), Vec3::Zero());
      const double impulse = -h * lambda[i];
      for (std::size_t n = 0; n < correction[o].size(); ++n) correction[o][n] += impulse * response[i][n];
    }
    if (!solver[o].advance(model.organs()[o].solid, state.organ[o], correction[o], h)) {
      result.misses |= miss::solver;
      emit(EventKind::solverMiss, 255, static_cast<std::uint16_t>(o), Vec3::Zero(), 1e300);
    }
    bounded[o] = false;
  }
  for (std::size_t hand = 0; hand < handCount; ++hand) {
    HandState& s = state.hand[hand];
    const HandDescription& description = model.scene().hands[hand];
    Vec3 push = Vec3::Zero();
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (rows[i].hand == hand) push += lambda[i] * rows[i].direction;
    }
    const Vec3 goal = s.simulatedPosition + share[hand] * remaining[hand] + push / description.couplingStiffness;
    const Pose pose = throughPort(description.port, goal, s.realOrientation, axisOf(description.port, s.simulatedPosition));
    s.simulatedPosition = pose.position;
    s.simulatedOrientation = pose.orientation;
    result.hand[hand].contactForce = push;
  }
}

void Stepper::Workspace::finishOrgans(State& state) {
  for (std::size_t o = 0; o < model.organs().size(); ++o) {
    SolidState& organ = state.organ[o];
    OrganResult& out = result.organ[o];
    const OrganModel& fixed = model.organs()[o];
    out.largestSpeed = 0.0;
    if (moved[o]) {
      double speed = 0.0;
      double displacement = 0.0;
      for (std::size_t n = 0; n < organ.position.size(); ++n) {
        speed = std::max(speed, organ.velocity[n].squaredNorm());
        displacement = std::max(displacement, (organ.position[n] - fixed.solid.rest()[n]).squaredNorm());
      }
      out.largestSpeed = std::sqrt(speed);
      organ.largestDisplacement = std::sqrt(displacement);
      organ.volume = fixed.solid.elements().volume(organ.position);
      bool touched = false;
      for (const Row& row : rows) touched = touched || row.organ == o;
      organ.quietSteps = !touched && out.largestSpeed < quietSpeed ? organ.quietSteps + 1 : 0;
      if (model.scene().solver.sleeping && organ.quietSteps >= quietSteps) {
        std::fill(organ.velocity.begin(), organ.velocity.end(), Vec3::Zero());
      }
    }
    out.largestDisplacement = organ.largestDisplacement;
    out.volume = organ.volume;
  }
}

void Stepper::Workspace::finishHands(State& state) {
  refreshBounds(state);
  result.contact.largestDepth = 0.0;
  for (std::size_t h = 0; h < handCount; ++h) {
    HandState& hand = state.hand[h];
    HandResult& out = result.hand[h];
    const HandDescription& description = model.scene().hands[h];
    out.instrument = hand.instrument;
    out.tipReal = hand.realPosition;
    out.tipSimulated = hand.simulatedPosition;
    out.orientation = hand.simulatedOrientation;
    out.jaw = hand.jaw;
    out.insertion = (hand.simulatedPosition - description.port).norm();
    std::fill(out.organForce.begin(), out.organForce.end(), 0.0);
    for (std::size_t i = 0; i < rows.size(); ++i) {
      if (rows[i].hand == h) out.organForce[rows[i].organ] += lambda[i];
    }
    out.touching = 0;
    for (std::size_t o = 0; o < model.organs().size(); ++o) {
      const std::uint32_t bit = 1U << o;
      const bool before = (hand.touching & bit) != 0;
      const bool now = out.organForce[o] > leastForce;
      if (now) out.touching |= bit;
      if (now && !before) {
        hand.touchingSince[o] = state.clock.step;
        emit(EventKind::contactBegin, h, static_cast<std::uint16_t>(o), hand.simulatedPosition, out.organForce[o]);
      } else if (before && !now) {
        emit(EventKind::contactEnd, h, static_cast<std::uint16_t>(o), hand.simulatedPosition,
             static_cast<double>(state.clock.step - hand.touchingSince[o]) * settings.step);
      }
    }
    hand.touching = out.touching;
    if (hand.instrument == InstrumentKind::none) continue;
    const Shaft shaft(description.port, hand.simulatedPosition, description.shaftRadius);
    result.contact.largestDepth = std::max(result.contact.largestDepth, -gapOf(shaft, 0.0));
  }
}

/// The problem of this step, reduced to each hand, for the ticks to come. The other hand's forces stay as they are.
void Stepper::Workspace::publish(const State& state) {
  const std::size_t n = rows.size();
  for (std::size_t h = 0; h < handCount; ++h) {
    ContactSet& set = contactSet[h];
    set.step = static_cast<std::int64_t>(result.step);
    set.reference = state.hand[h].realPosition;
    set.direction.clear();
    set.free.clear();
    set.compliance.clear();
    set.key.clear();
    set.lambda.clear();
    for (std::size_t i = 0; i < n; ++i) {
      if (rows[i].hand != h) continue;
      double free = rows[i].freeFull;
      for (std::size_t j = 0; j < n; ++j) {
        if (rows[j].hand != h) {
          free += compliance[i * n + j] * lambda[j];
        } else {
          set.compliance.push_back(compliance[i * n + j]);
        }
      }
      set.direction.push_back(rows[i].direction);
      set.free.push_back(free);
      set.key.push_back(rows[i].contact.key);
      set.lambda.push_back(lambda[i]);
    }
  }
}

Stepper::Stepper(const Model& model, Executor& executor, MakeBroadPhase makeBroadPhase)
    : w_(std::make_unique<Workspace>(model, executor, makeBroadPhase)) {}
Stepper::~Stepper() = default;

const StepResult& Stepper::step(State& state, std::span<const TickSamples> samples) {
  const FloatingPointScope scope;
  Workspace& w = *w_;
  assert(samples.size() == w.model.scene().ticksPerStep);
  w.result.step = state.clock.step;
  w.result.misses = 0;
  w.result.events.clear();
  w.readSamples(state, samples);
  w.refreshBounds(state);
  for (std::size_t h = 0; h < handCount; ++h) w.advanceFreely(state, h);
  w.detect(state);
  w.wakeAndMove(state);
  w.buildProblem(state);
  w.solveContacts(state);
  w.applyForces(state);
  w.finishOrgans(state);
  w.finishHands(state);
  w.publish(state);
  ++state.clock.step;
  return w.result;
}

const ContactSet& Stepper::contactSet(std::size_t hand) const { return w_->contactSet[hand]; }

const StateDigest& Stepper::digest(const State& state) {
  std::vector<bool> written(4, true);
  written.insert(written.end(), w_->moved.begin(), w_->moved.end());
  const StateDigest& digest = w_->digest.update(state, written);
  assert(digest == digestOf(state));
  return digest;
}

void Stepper::invalidate() { w_->invalidate(); }

Vec3 realTip(const Model& model, std::size_t hand, const InstrumentSample& sample, const Vec3& held) {
  if (!isMeasurement(sample)) return held;
  const Vec3& port = model.scene().hands[hand].port;
  return throughPort(port, clampedToWorkspace(model.scene(), sample.position), Quat::Identity(), axisOf(port, held)).position;
}

HapticModel hapticModel(const Model& model, std::size_t hand) {
  const HandDescription& description = model.scene().hands[hand];
  HapticModel haptics;
  haptics.largestForce = description.largestForce;
  haptics.tolerance = model.scene().solver.contactTolerance;
  return haptics;
}

SceneView viewOf(const Model& model, const State& state) {
  SceneView view;
  view.step = state.clock.step;
  view.time = static_cast<double>(state.clock.step) * model.stepSeconds();
  for (std::size_t o = 0; o < model.organs().size(); ++o) {
    const OrganModel& organ = model.organs()[o];
    SurfaceView surface;
    surface.organ = organ.name;
    surface.appearance = organ.appearance;
    surface.rest = organ.skin;
    organ.embedding.map(state.organ[o].position, surface.position);
    surface.triangle = organ.surface.triangles();
    view.surface.push_back(std::move(surface));
  }
  for (std::size_t h = 0; h < handCount; ++h) {
    InstrumentView& instrument = view.instrument[h];
    const HandDescription& description = model.scene().hands[h];
    instrument.kind = state.hand[h].instrument;
    instrument.pose = {state.hand[h].simulatedPosition, state.hand[h].simulatedOrientation};
    instrument.port = description.port;
    instrument.radius = description.shaftRadius;
    instrument.jaw = state.hand[h].jaw;
    instrument.touching = state.hand[h].touching != 0;
  }
  view.camera.position = state.camera.position;
  view.camera.orientation = state.camera.orientation;
  view.verticalFieldOfView = model.scene().verticalFieldOfView;
  return view;
}

}  // namespace calot
