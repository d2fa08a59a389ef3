// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/session.h"

#include <stdexcept>
#include <utility>

#include "sim/math/fields.h"

namespace calot::recorder {

Session::Session(const Model& model, std::uint64_t seed, Executor& executor)
    : model_(model), state_(initialState(model, seed)), stepper_(model, executor), sets_(1) {
  for (std::size_t h = 0; h < handCount; ++h) {
    hapticModel_[h] = hapticModel(model, h);
    haptic_[h] = initialHaptics(model_, state_, h);
  }
}

TickOutcome Session::tick(const TickSamples& samples, const std::optional<std::array<std::int64_t, handCount>>& sets) {
  TickOutcome outcome;
  for (std::size_t h = 0; h < handCount; ++h) {
    const ContactSet* set = &sets_.back()[h];
    if (sets) {
      const std::int64_t back = set->step - (*sets)[h];
      if (back < 0 || back >= static_cast<std::int64_t>(sets_.size())) {
        throw std::out_of_range("contact set of step " + std::to_string((*sets)[h]) + " is not at hand in step " +
                                std::to_string(steps()));
      }
      set = &sets_[sets_.size() - 1 - static_cast<std::size_t>(back)][h];
    }
    takeSample(model_, h, samples.hand[h], haptic_[h]);
    const HapticForce force = hapticTick(hapticModel_[h], haptic_[h], *set);
    outcome.hand[h] = {force.force, force.torque, set->step};
  }
  return outcome;
}

void Session::step(std::span<const TickSamples> samples, std::span<const TickOutcome> ticks, float lateness) {
  const StepResult& result = stepper_.step(state_, samples);
  if (sets_.size() == keptSets) sets_.pop_front();
  sets_.push_back({stepper_.contactSet(0), stepper_.contactSet(1)});
  const StateDigest& digest = stepper_.digest(state_);
  const StepRecord record{
      result.step, samples, ticks, result, digest, lateness, [this] { return keyframe(); }, [this] { return view(); }};
  for (Observer* observer : observers_) observer->onStep(record);
}

void Session::end(Outcome outcome) {
  for (Observer* observer : observers_) observer->onEnd(outcome);
}

Keyframe Session::keyframe() const {
  Keyframe frame;
  frame.step = steps() - 1;
  frame.state = saveState(state_);
  ByteWriter writer(frame.haptics);
  for (const HapticState& haptic : haptic_) writer.write(haptic);
  // Ticks name the newest set.
  for (const ContactSet& set : sets_.back()) writer.write(set);
  return frame;
}

bool Session::restore(const Keyframe& keyframe) {
  State state;
  if (!restoreState(model_, keyframe.state, state) || state.clock.step != keyframe.step + 1) return false;
  std::array<HapticState, handCount> haptic;
  SetPair sets;
  ByteReader reader(keyframe.haptics);
  for (HapticState& h : haptic) reader.read(h);
  for (ContactSet& set : sets) reader.read(set);
  if (!reader.complete()) return false;
  for (const ContactSet& set : sets) {
    if (!isConsistent(set) || set.step != static_cast<std::int64_t>(keyframe.step)) return false;
  }
  for (std::size_t h = 0; h < handCount; ++h) {
    if (!isConsistent(haptic[h], sets[h])) return false;
  }
  state_ = std::move(state);
  haptic_ = haptic;
  sets_.assign(1, sets);
  stepper_.invalidate();
  return true;
}

}  // namespace calot::recorder
