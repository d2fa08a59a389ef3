// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/scene/stepper.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <vector>

#include "sim/instruments/port.h"
#include "sim/math/fields.h"
#include "sim/math/floating_point.h"
#include "sim/scene/organ_body.h"
#include "sim/scene/stepper_workspace.h"

namespace calot {

using namespace stepping;

namespace {

bool isMeasurement(const InstrumentSample& s) {
  return s.valid && s.position.allFinite() && s.orientation.coeffs().allFinite() && std::isfinite(s.jaw) &&
         s.orientation.coeffs().norm() > 0.5;
}

/// Digest of one hand's samples over a step, field by field: no padding enters it.
std::uint64_t handInputs(std::span<const TickSamples> samples, std::size_t hand) {
  std::vector<std::byte> bytes;
  ByteWriter writer(bytes);
  for (const TickSamples& tick : samples) {
    const InstrumentSample& s = tick.hand[hand];
    writer.write(s.position);
    writer.write(s.orientation);
    writer.write(s.jaw);
    writer.write(s.instrument);
    writer.write(s.buttons);
    writer.write(s.valid);
  }
  return digest64(bytes);
}

std::uint64_t cameraInputs(std::span<const TickSamples> samples) {
  std::vector<std::byte> bytes;
  ByteWriter writer(bytes);
  for (const TickSamples& tick : samples) {
    writer.write(tick.camera.position);
    writer.write(tick.camera.orientation);
  }
  return digest64(bytes);
}

constexpr std::size_t mostPrepared = std::size_t{256} << 20U;  ///< of compliances of one body (bytes)

/// Do the compliances of so many of a body's nodes have room?
bool canPrepare(std::size_t prepared, std::size_t nodes) {
  return nodes == 0 || prepared <= mostPrepared / (9 * sizeof(float)) / nodes;
}

Vec3 clampedToWorkspace(const SceneDescription& scene, const Vec3& p) {
  return p.cwiseMax(scene.workspace[0]).cwiseMin(scene.workspace[1]);
}

}  // namespace

Vec3 axisOf(const Vec3& port, const Vec3& tip) {
  const Vec3 reach = tip - port;
  const double length = reach.norm();
  return length > 1e-6 ? Vec3(reach / length) : Vec3(0.0, 0.0, -1.0);
}

void Stepper::Workspace::emit(EventKind kind, std::size_t hand, std::uint16_t subject, const Vec3& position,
                              double value) {
  result.events.push_back({result.step, kind, static_cast<std::uint8_t>(hand), subject, position, value});
}

/// The newest measurement of each hand, and the newest camera.
void Stepper::Workspace::readSamples(State& state, std::span<const TickSamples> samples) {
  const SceneDescription& scene = model.scene();
  for (std::size_t h = 0; h < handCount; ++h) {
    HandState& hand = state.hand[h];
    hand.inputs = handInputs(samples, h);
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
      hand.jawsOpened = false;
    }
    const double outside = (newest->position - clampedToWorkspace(scene, newest->position)).norm();
    if (outside > 0.0 && !hand.outside) emit(EventKind::outOfWorkspace, h, 0, newest->position, outside);
    hand.outside = outside > 0.0;
    const Vec3& port = scene.hands[h].port;
    Quat orientation = newest->orientation;
    orientation.coeffs() /= orientation.coeffs().norm();
    const Pose pose =
        throughPort(port, clampedToWorkspace(scene, newest->position), orientation, axisOf(port, hand.realPosition));
    hand.realPosition = pose.position;
    hand.realOrientation = pose.orientation;
    hand.realJaw = std::clamp(newest->jaw, 0.0, 1.6);
    hand.buttons = newest->buttons;
  }
  state.camera.inputs = cameraInputs(samples);
  const CameraSample& camera = samples.back().camera;
  const double size = camera.orientation.coeffs().norm();
  if (camera.position.allFinite() && std::isfinite(size) && size > 0.5) {
    state.camera.position = camera.position;
    state.camera.orientation = camera.orientation;
    state.camera.orientation.coeffs() /= size;
  }
}

void Stepper::Workspace::finishHands(State& state) {
  for (std::size_t h = 0; h < handCount; ++h) {
    HandState& hand = state.hand[h];
    HandResult& out = result.hand[h];
    const HandDescription& description = model.scene().hands[h];
    out.instrument = hand.instrument;
    out.tipReal = hand.realPosition;
    out.tipSimulated = hand.simulatedPosition;
    out.orientation = hand.simulatedOrientation;
    out.jaw = hand.jaw;
    out.clips = hand.clips;
    out.insertion = (hand.simulatedPosition - description.port).norm();
    std::fill(out.structureForce.begin(), out.structureForce.end(), 0.0);
    for (const ContactBlock& block : blocks) {
      if (block.hand == h && block.kind != BlockKind::ball) out.structureForce[block.structure] += lambda[block.row];
    }
    out.touching = 0;
    for (std::size_t o = 0; o < model.structures().size(); ++o) {
      const std::uint32_t bit = 1U << o;
      const bool touched = (hand.touching & bit) != 0;
      const bool now = out.structureForce[o] > leastForce;
      if (now) out.touching |= bit;
      if (now && !touched) {
        hand.touchingSince[o] = state.clock.step;
        emit(EventKind::contactBegin, h, static_cast<std::uint16_t>(o), hand.simulatedPosition, out.structureForce[o]);
      } else if (touched && !now) {
        emit(EventKind::contactEnd, h, static_cast<std::uint16_t>(o), hand.simulatedPosition,
             static_cast<double>(state.clock.step - hand.touchingSince[o]) * settings.step);
      }
    }
    hand.touching = out.touching;
  }
}

Stepper::Workspace::Workspace(const Model& model_, Executor& executor_, MakeBroadPhase make)
    : model(model_), executor(executor_) {
  const std::size_t organs = model.organs().size();
  const std::size_t structures = model.structures().size();
  skin.resize(structures);
  bounds.resize(structures);
  nodal.resize(model.bodies());
  selfRest.resize(organs);
  nearTriangles.resize(model.tissuePairs().size());
  moved.assign(model.bodies(), false);
  stopped.assign(model.bodies(), false);
  for (std::size_t s = 0; s < structures; ++s) {
    broad.push_back(make != nullptr ? make() : std::make_unique<SortedGrid>(broadCell));
  }
  settings.step = model.stepSeconds();
  settings.tolerance = model.scene().solver.tolerance;
  settings.cap = model.scene().solver.iterations;
  settings.speedTolerance = model.scene().solver.speedTolerance;
  responseSettings = settings;
  responseSettings.tolerance = model.scene().solver.responseTolerance;
  responseSettings.speedTolerance = model.scene().solver.responseSpeedTolerance;
  for (std::size_t o = 0; o < organs; ++o) {
    body.push_back(std::make_unique<OrganBody>(model, o, settings, responseSettings, executor));
    skinOf.push_back(std::make_unique<OrganSkin>(model, o));
  }
  for (std::size_t t = 0; t < model.vesselTrees().size(); ++t) {
    auto vessels = std::make_unique<VesselBody>(model, t, settings.step);
    vesselBody.push_back(vessels.get());
    body.push_back(std::move(vessels));
  }
  for (std::size_t f = 0; f < model.fat().size(); ++f) {
    auto fat = std::make_unique<FatMotion>(model, f, settings, responseSettings, executor);
    fatMotion.push_back(fat.get());
    body.push_back(std::move(fat));
  }
  for (std::size_t s = organs; s < structures; ++s) {
    const StructureModel& structure = model.structures()[s];
    if (structure.kind == StructureKind::vessel) {
      skinOf.push_back(std::make_unique<TubeSkin>(model, structure.index, structure.branch));
    } else {
      skinOf.push_back(std::make_unique<FatSkin>(*fatMotion[structure.index]));
    }
  }
  if (model.procedure().present && model.procedure().fat != ProcedureModel::none) {
    const FatBody& fat = fatMotion[model.procedure().fat]->fat();  // uncarved yet
    for (std::size_t r = 0; r < fat.model().regions(); ++r) wholeRegion.push_back(fat.volume().inRegion(r));
  }
  tiesOf.resize(body.size());
  coupleTies(settings.step);
  result.organ.resize(organs);
  result.connective.resize(model.connective().size());
  result.vessel.resize(model.scene().vessels.size());
  result.fat.resize(model.fat().size());
  carved.assign(model.fat().size(), false);
  charred.assign(organs, false);
  frayed.assign(model.connective().size(), false);
  for (HandResult& hand : result.hand) hand.structureForce.resize(structures);
  invalidate();
}

void Stepper::Workspace::invalidate() {
  bounded.assign(model.structures().size(), false);
  refittable.assign(model.structures().size(), false);
  digest.reset();
  for (FatMotion* fat : fatMotion) fat->invalidate();
  for (NearTriangles& lists : nearTriangles) lists.reset();
  for (ContactSet& set : contactSet) set = {};
}

Stepper::Stepper(const Model& model, Executor& executor, MakeBroadPhase makeBroadPhase)
    : w_(std::make_unique<Workspace>(model, executor, makeBroadPhase)) {}
Stepper::~Stepper() = default;

void Stepper::prepare() {
  const FloatingPointScope scope;
  Workspace& w = *w_;
  for (std::size_t pair = 0; pair < w.model.tissuePairs().size(); ++pair) {
    w.nearTriangles[pair].prepare(w.restOf(pair), w.model.organs()[w.model.tissuePairs()[pair].b].surface);
  }
  for (std::size_t o = 0; o < w.model.organs().size(); ++o) {
    const OrganModel& organ = w.model.organs()[o];
    std::vector<int> nodes;
    for (const Embedding::Anchor& anchor : organ.embedding.anchors()) {
      nodes.insert(nodes.end(), anchor.node.begin(), anchor.node.end());
    }
    std::sort(nodes.begin(), nodes.end());
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    if (canPrepare(nodes.size(), organ.solid.nodes())) w.body[o]->require(nodes);
    w.body[o]->prepare();
  }
  for (std::size_t f = 0; f < w.model.fat().size(); ++f) {
    Body& fat = *w.body[w.firstFat() + f];
    if (!canPrepare(fat.nodes(), fat.nodes())) continue;
    std::vector<int> nodes(fat.nodes());
    for (std::size_t n = 0; n < nodes.size(); ++n) nodes[n] = static_cast<int>(n);
    fat.require(nodes);
  }
}

const StepResult& Stepper::step(State& state, std::span<const TickSamples> samples) {
  const FloatingPointScope scope;
  Workspace& w = *w_;
  assert(samples.size() == w.model.scene().ticksPerStep);
  w.result.step = state.clock.step;
  w.result.misses = 0;
  w.result.events.clear();
  w.result.contact = {};
  std::fill(w.charred.begin(), w.charred.end(), false);
  std::fill(w.carved.begin(), w.carved.end(), false);
  for (FatMotion* fat : w.fatMotion) fat->beginStep(state);
  for (std::size_t h = 0; h < handCount; ++h) w.poseBefore[h] = w.simulated(state, h);
  w.readSamples(state, samples);
  w.refreshBounds(state);
  for (std::size_t h = 0; h < handCount; ++h) w.dropLostPlaces(state, h);
  for (std::size_t h = 0; h < handCount; ++h) w.openJaws(state, h);
  for (std::size_t h = 0; h < handCount; ++h) w.advanceFreely(state, h);
  for (std::size_t h = 0; h < handCount; ++h) w.closeJaws(state, h);
  w.detectInstruments(state);
  w.addHolds(state);
  w.wake(state);
  w.detectTissue(state);
  w.recallForces(state);
  w.moveFreely(state);
  w.poseProblem(state);
  w.solveContacts();
  w.keepForces(state);
  w.move(state);
  w.publish(state);
  w.refreshBounds(state);
  for (std::size_t h = 0; h < handCount; ++h) w.withdraw(state, h);
  w.finishConnective(state);
  for (std::size_t h = 0; h < handCount; ++h) w.closeOnVessels(state, h);
  w.burn(state);
  w.finishOrgans(state);
  w.finishVessels(state);
  w.finishFat(state);
  w.finishHolds(state);
  w.finishHands(state);
  w.finishProcedure(state);
  w.watchSpeeds(state);
  ++state.clock.step;
  return w.result;
}

const ContactSet& Stepper::contactSet(std::size_t hand) const { return w_->contactSet[hand]; }

const StateDigest& Stepper::digest(const State& state) {
  std::vector<bool> written(State::organsFrom, true);
  const auto vessels = w_->written.begin() + static_cast<std::ptrdiff_t>(w_->model.organs().size());
  const auto fat = w_->written.begin() + static_cast<std::ptrdiff_t>(w_->firstFat());
  written.insert(written.end(), w_->written.begin(), vessels);
  written.insert(written.end(), w_->frayed.begin(), w_->frayed.end());
  written.insert(written.end(), vessels, fat);
  written.insert(written.end(), w_->charred.begin(), w_->charred.end());
  written.insert(written.end(), fat, w_->written.end());
  written.insert(written.end(), w_->carved.begin(), w_->carved.end());
  written.resize(written.size() + state.procedure.size(), true);
  const StateDigest& digest = w_->digest.update(state, written);
  assert(digest == digestOf(state));
  return digest;
}

void Stepper::invalidate() { w_->invalidate(); }

HapticState initialHaptics(const Model&, const State& state, std::size_t hand) {
  HapticState haptics;
  haptics.tip = state.hand[hand].realPosition;
  haptics.orientation = state.hand[hand].realOrientation;
  return haptics;
}

void takeSample(const Model& model, std::size_t hand, const InstrumentSample& sample, HapticState& haptics) {
  if (!isMeasurement(sample)) return;
  const Vec3& port = model.scene().hands[hand].port;
  Quat orientation = sample.orientation;
  orientation.coeffs() /= orientation.coeffs().norm();
  const Pose pose =
      throughPort(port, clampedToWorkspace(model.scene(), sample.position), orientation, axisOf(port, haptics.tip));
  haptics.tip = pose.position;
  haptics.orientation = pose.orientation;
}

HapticModel hapticModel(const Model& model, std::size_t hand) {
  const HandDescription& description = model.scene().hands[hand];
  HapticModel haptics;
  haptics.largestForce = description.largestForce;
  haptics.largestStretch = description.largestForce / description.couplingStiffness;
  haptics.ticksPerStep = model.scene().ticksPerStep;
  return haptics;
}

}  // namespace calot
