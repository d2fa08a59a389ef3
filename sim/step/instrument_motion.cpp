// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/step/stages.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "sim/contact/capsule_contact.h"
#include "sim/haptics/haptic_tick.h"
#include "sim/math/fields.h"
#include "sim/math/linear.h"
#include "sim/scene/description.h"
#include "sim/step/contact_block.h"
#include "sim/step/placed_instrument.h"

namespace calot {

namespace {

constexpr int maxAdvances = 16;  ///< conservative advancements a step; each halves the way at worst
/// Maximum speed of a jaw near a surface (rad/s). Larger: jaws jump through thin tissue; smaller: they lag. Assumed.
constexpr double maxJawSpeed = 5.0;

}  // namespace

/// Least gap between the placed instrument and all structures, at most `limit` (m).
double InstrumentMotion::gapOf(const Surfaces& surfaces, const State& state, std::size_t hand, double limit) {
  double least = gapBetween(instrument_, other_, limit);
  for (std::size_t s = 0; s < surfaces.size(); ++s) {
    for (const Capsule& c : instrument_.capsule) {
      const double allowed = allowedDepth(model_, state, hand, c, s);
      const Vec3 dimple = dimpleOf(state.hand[hand].touches, s, c.piece);
      const Vec3 p0 = c.p0 + dimple;
      const Vec3 p1 = c.p1 + dimple;
      const double far = capsuleSearch(c.radius, notNegative(least - allowed));
      const std::span<const std::uint32_t> near = surfaces.patchesNear(s, p0, p1, far, search_);
      if (near.empty()) continue;
      least = allowed + minGap(surfaces.mesh(s), surfaces.points(s), near, p0, p1, c.radius, least - allowed);
    }
  }
  return least;
}

void InstrumentMotion::advance(const Surfaces& surfaces, std::size_t hand, State& state, InstrumentTravel& travel) {
  const InputState& input = state.hand[hand].input;
  InstrumentState& instrument = state.hand[hand].instrument;
  const HandDescription& description = model_.scene().hands[hand];
  const Pose real{input.position, input.orientation};
  other_.place(model_.scene().hands[1 - hand], state.hand[1 - hand].instrument);
  double left = 0.0;
  for (int i = 0;; ++i) {
    const Pose now = simulatedPose(instrument);
    const Vec3 way = real.position - now.position;
    const double roll = rollBetween(now.orientation, real.orientation);
    const double closing = input.jaw - instrument.jaw;
    instrument_.place(description, instrument.kind, now, std::max(instrument.jaw, input.jaw));
    // No point of the instrument moves farther: rotating about the port, it moves with the tip, and what stands off the
    // axis a little more.
    const InstrumentShape& local = instrument_.local;
    const double length = (now.position - description.port).norm();
    left = way.norm() * (1.0 + local.lateralReach() / length) + std::abs(roll) * local.lateralReach() +
           0.5 * std::abs(closing) * local.jawReach();
    if (!(left > 0.0)) break;
    instrument_.place(description, instrument);
    const double room = gapOf(surfaces, state, hand, left + 2.0 * contactMargin);
    double share = 0.0;
    if (room >= left + contactMargin) {
      share = 1.0;
    } else if (room > 1.05 * contactMargin && i < maxAdvances) {
      share = (room - contactMargin) / left;
    } else {
      const double most = maxJawSpeed * model_.stepSeconds();
      instrument.jaw += std::clamp(closing, -most, most);
      break;
    }
    const Pose next = share == 1.0 ? throughPort(description.port, real.position, real.orientation,
                                                 now.orientation.toRotationMatrix().col(2))
                                   : movedTool(description.port, now, share * way, share * roll);
    instrument.position = next.position;
    instrument.orientation = next.orientation;
    instrument.jaw = share == 1.0 ? input.jaw : instrument.jaw + share * closing;
    if (share == 1.0) {
      left = 0.0;
      break;
    }
  }
  travel.reference = simulatedPose(instrument);
  travel.stretch = couplingStretch(travel.reference, real, hapticModel(model_, hand).maxStretch);
  travel.reach = contactMargin + std::min(left, maxSlide);
}

InstrumentTravels InstrumentMotion::run(const Surfaces& surfaces, State& state, StepLog& log, ContactResult& contact) {
  InstrumentTravels travel;
  for (std::size_t hand = 0; hand < handCount; ++hand) travel[hand].before = simulatedPose(state.hand[hand].instrument);
  grasping_.release(surfaces, state, log, contact);
  for (std::size_t hand = 0; hand < handCount; ++hand) advance(surfaces, hand, state, travel[hand]);
  grasping_.close(surfaces, state, log);
  return travel;
}

namespace {

/// Widest opening of any jaw (rad). Devices that report more are clamped. Assumed.
constexpr double maxJaw = 1.6;

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

}  // namespace

void SampleStage::readHand(std::span<const TickSamples> samples, std::size_t h, State& state, StepLog& log) const {
  InputState& input = state.hand[h].input;
  InstrumentState& instrument = state.hand[h].instrument;
  input.samples = handInputs(samples, h);
  const InstrumentSample* newest = nullptr;
  for (const TickSamples& tick : samples) {
    if (isMeasurement(tick.hand[h])) newest = &tick.hand[h];
  }
  const bool valid = isMeasurement(samples.back().hand[h]);
  if (input.valid && !valid) {
    input.invalidSince = state.clock.step;
    log.emit(EventKind::sampleInvalid, h, 0, input.position, 0.0);
  } else if (!input.valid && valid) {
    log.emit(EventKind::sampleValid, h, 0, input.position,
             static_cast<double>(state.clock.step - input.invalidSince) * model_.stepSeconds());
  }
  input.valid = valid;
  if (newest == nullptr) return;
  if (newest->instrument != instrument.kind) {
    log.emit(EventKind::instrumentExchange, h, static_cast<std::size_t>(newest->instrument), input.position,
             static_cast<double>(instrument.kind));
    instrument.kind = newest->instrument;
    instrument.jawsOpened = false;
  }
  const double outside = (newest->position - clampedToWorkspace(model_.scene(), newest->position)).norm();
  if (outside > 0.0 && !input.outside) log.emit(EventKind::outOfWorkspace, h, 0, newest->position, outside);
  input.outside = outside > 0.0;
  const Pose pose = realPose(model_.scene(), h, *newest, input.position);
  input.position = pose.position;
  input.orientation = pose.orientation;
  input.jaw = std::min(notNegative(newest->jaw), maxJaw);
  readRequests(samples, h, state, log);
  input.buttons = newest->buttons;
}

/// A button asks once, as it goes down, in whichever tick of the step that is.
void SampleStage::readRequests(std::span<const TickSamples> samples, std::size_t h, State& state, StepLog& log) const {
  std::uint8_t before = state.hand[h].input.buttons;
  for (const TickSamples& tick : samples) {
    if (!isMeasurement(tick.hand[h])) continue;
    const auto pressed = static_cast<std::uint8_t>(tick.hand[h].buttons & ~before);
    before = tick.hand[h].buttons;
    if ((pressed & button::retractMore) != 0) askAssistant(h, true, state, log);
    if ((pressed & button::retractLess) != 0) askAssistant(h, false, state, log);
  }
}

void SampleStage::askAssistant(std::size_t h, bool more, State& state, StepLog& log) const {
  const double time = static_cast<double>(state.clock.step) * model_.stepSeconds();
  for (std::size_t r = 0; r < model_.retractions().size(); ++r) {
    const RetractionDescription& d = model_.scene().retraction[r];
    if (!(d.stage > 0.0)) continue;
    askForRetraction(d, r, time, more, state.retraction);
    log.emit(more ? EventKind::retractionMore : EventKind::retractionLess, h, model_.retractions()[r].organ, d.centre,
             state.retraction.goal[r] * d.displacement.norm());
  }
}

void SampleStage::run(std::span<const TickSamples> samples, State& state, StepLog& log) const {
  for (std::size_t h = 0; h < handCount; ++h) readHand(samples, h, state, log);
  state.camera.inputs = cameraInputs(samples);
  const CameraSample& camera = samples.back().camera;
  if (!isMeasurement(camera)) return;
  state.camera.position = camera.position;
  state.camera.orientation = camera.orientation;
  state.camera.orientation.coeffs() /= camera.orientation.coeffs().norm();
}

}  // namespace calot
