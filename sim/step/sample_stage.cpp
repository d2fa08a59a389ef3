// SPDX-License-Identifier: GPL-3.0-or-later
#include "sim/step/sample_stage.h"

#include <algorithm>
#include <vector>

#include "sim/math/bounds.h"
#include "sim/math/fields.h"
#include "sim/scene/measurement.h"

namespace calot {

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
  HandState& hand = state.hand[h];
  hand.inputs = handInputs(samples, h);
  const InstrumentSample* newest = nullptr;
  for (const TickSamples& tick : samples) {
    if (isMeasurement(tick.hand[h])) newest = &tick.hand[h];
  }
  const bool valid = isMeasurement(samples.back().hand[h]);
  if (hand.valid && !valid) {
    hand.invalidSince = state.clock.step;
    log.emit(EventKind::sampleInvalid, h, 0, hand.realPosition, 0.0);
  } else if (!hand.valid && valid) {
    log.emit(EventKind::sampleValid, h, 0, hand.realPosition,
             static_cast<double>(state.clock.step - hand.invalidSince) * model_.stepSeconds());
  }
  hand.valid = valid;
  if (newest == nullptr) return;
  if (newest->instrument != hand.instrument) {
    log.emit(EventKind::instrumentExchange, h, static_cast<std::size_t>(newest->instrument), hand.realPosition,
             static_cast<double>(hand.instrument));
    hand.instrument = newest->instrument;
    hand.jawsOpened = false;
  }
  const double outside = (newest->position - clampedToWorkspace(model_.scene(), newest->position)).norm();
  if (outside > 0.0 && !hand.outside) log.emit(EventKind::outOfWorkspace, h, 0, newest->position, outside);
  hand.outside = outside > 0.0;
  const Pose pose = realPose(model_.scene(), h, *newest, hand.realPosition);
  hand.realPosition = pose.position;
  hand.realOrientation = pose.orientation;
  hand.realJaw = std::min(notNegative(newest->jaw), maxJaw);
  readRequests(samples, h, state, log);
  hand.buttons = newest->buttons;
}

/// A button asks once, as it goes down, in whichever tick of the step that is.
void SampleStage::readRequests(std::span<const TickSamples> samples, std::size_t h, State& state, StepLog& log) const {
  std::uint8_t before = state.hand[h].buttons;
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
