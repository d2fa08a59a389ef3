// SPDX-License-Identifier: GPL-3.0-or-later
#include "recorder/engine/session.h"

#include <algorithm>
#include <stdexcept>
#include <string_view>
#include <type_traits>
#include <utility>

#include "sim/math/fields.h"
#include "sim/solid/elements.h"

namespace calot::recorder {

namespace {

/// Writes fields as saveState() does and notes what they are.
class PartWriter {
 public:
  PartWriter(std::vector<std::byte>& out, std::vector<KeyframePart>& parts) : out_(out), parts_(parts), writer_(out) {}

  template <class T>
  void operator()(const char* name, const T& value) {
    const std::size_t before = out_.size();
    writer_.write(value);
    PartForm form = PartForm::plain;
    if (std::is_same_v<T, std::vector<Quat>>) form = PartForm::quaternions;
    if (std::is_same_v<T, std::vector<RotationGroup>>) form = PartForm::quaternionsByLane;
    if (std::string_view(name) == "compliance") form = PartForm::symmetricMatrix;
    parts_.push_back({static_cast<std::uint32_t>(out_.size() - before), form});
  }
  template <class Part>
  void fieldsOf(const Part& part) {
    Part::fields(part, *this);
  }

 private:
  std::vector<std::byte>& out_;
  std::vector<KeyframePart>& parts_;
  ByteWriter writer_;
};

}  // namespace

Session::Session(const Model& model, std::uint64_t seed, Executor& executor, const StepperServices& services)
    : model_(model), state_(initialState(model, seed)), stepper_(model, executor, services), sets_(keptSets) {
  for (std::size_t h = 0; h < handCount; ++h) {
    hapticModel_[h] = hapticModel(model, h);
    haptic_[h] = initialHaptics(state_, h);
  }
}

TickOutcome Session::tick(const TickSamples& samples, const std::optional<NamedSets>& sets) {
  TickOutcome outcome;
  for (std::size_t h = 0; h < handCount; ++h) {
    const std::int64_t named = sets ? (*sets)[h] : newest_;
    if (named < named_[h]) {
      throw std::out_of_range("contact set of step " + std::to_string(named) + " is named after that of step " +
                              std::to_string(named_[h]) + " in step " + std::to_string(steps()));
    }
    if (named < oldest_ || named > newest_) {
      throw std::out_of_range("contact set of step " + std::to_string(named) + " is not at hand in step " +
                              std::to_string(steps()));
    }
    named_[h] = named;
    takeSample(model_, h, samples.hand[h], haptic_[h]);
    const HapticForce force = hapticTick(hapticModel_[h], haptic_[h], setsOf(named)[h]);
    outcome.hand[h] = {force.force, force.torque, named};
  }
  return outcome;
}

const StepResult& Session::withStretch(const StepResult& result, std::span<const TickOutcome> ticks) {
  double stretched = 0.0;
  for (const TickOutcome& tick : ticks) {
    if (tick.lateness > maxLag) stretched += static_cast<double>(tick.lateness) - static_cast<double>(maxLag);
  }
  if (stretched <= 0.0) return result;
  flagged_ = result;
  Event event;
  event.step = result.step;
  event.kind = EventKind::clockStretched;
  event.value = stretched;
  flagged_.events.push_back(event);
  return flagged_;
}

EngineStep Session::step(std::span<const TickSamples> samples, std::span<const TickOutcome> ticks, float lateness) {
  const StepResult& result = withStretch(stepper_.step(state_, samples), ticks);
  newest_ = static_cast<std::int64_t>(result.step);
  oldest_ = std::max(oldest_, newest_ + 1 - static_cast<std::int64_t>(keptSets));
  ContactSets& made = setsOf(newest_);
  for (std::size_t h = 0; h < handCount; ++h) made[h] = stepper_.contactSet(h);
  if (tell_) tell_(made);
  const StateDigest& digest = stepper_.digest(state_);
  const StepRecord record{
      result.step, samples, ticks, result, digest, lateness, [this] { return keyframe(); }, [this] { return view(); }};
  for (Observer* observer : observers_) observer->onStep(record);
  return {result.step, ticks, result, digest};
}

EngineStep Session::run(const StepInput& input) {
  ticks_.resize(input.samples.size());
  for (std::size_t i = 0; i < ticks_.size(); ++i) {
    if (input.logged.empty()) {
      ticks_[i] = tick(input.samples[i]);
    } else {
      const TickOutcome& logged = input.logged[i];
      ticks_[i] = tick(input.samples[i], NamedSets{logged.hand[0].contactSet, logged.hand[1].contactSet});
      ticks_[i].lateness = logged.lateness;
    }
  }
  return step(input.samples, ticks_, input.lateness);
}

SceneView Session::view() {
  if (!viewer_) viewer_ = std::make_unique<SceneViewer>(model_);
  return viewer_->view(state_);
}

void Session::end(Outcome outcome) {
  for (Observer* observer : observers_) observer->onEnd(outcome);
}

Keyframe Session::keyframe() const {
  Keyframe frame;
  frame.step = steps() - 1;
  PartWriter state(frame.state, frame.parts);
  State::components(state_, [&](const auto& part) { state.fieldsOf(part); });
  PartWriter haptics(frame.haptics, frame.parts);
  for (const HapticState& haptic : haptic_) haptics.fieldsOf(haptic);
  const std::int64_t first = std::max(oldest_, *std::min_element(named_.begin(), named_.end()));
  haptics("sets", static_cast<std::uint64_t>(newest_ - first + 1));
  for (std::int64_t n = first; n <= newest_; ++n) {
    for (const ContactSet& set : setsOf(n)) haptics.fieldsOf(set);
  }
  return frame;
}

bool Session::restore(const Keyframe& keyframe, const std::optional<NamedSets>& named) {
  State state;
  if (!restoreState(model_, keyframe.state, state) || state.clock.step != keyframe.step + 1) return false;
  HapticStates haptic;
  ByteReader reader(keyframe.haptics);
  for (HapticState& h : haptic) reader.read(h);
  std::uint64_t count = 0;
  reader.read(count);
  const auto newest = static_cast<std::int64_t>(keyframe.step);
  if (!reader.ok() || count < 1 || count > keptSets || static_cast<std::int64_t>(count) > newest + 2) return false;
  const std::int64_t oldest = newest + 1 - static_cast<std::int64_t>(count);
  std::vector<ContactSets> sets(count);
  for (std::size_t i = 0; i < sets.size(); ++i) {
    for (std::size_t h = 0; h < handCount; ++h) {
      ContactSet& set = sets[i][h];
      reader.read(set);
      if (!reader.ok() || !isConsistent(set) || set.step != oldest + static_cast<std::int64_t>(i)) return false;
      if (!isConsistent(haptic[h], set)) return false;
    }
  }
  if (!reader.complete()) return false;
  state_ = std::move(state);
  haptic_ = haptic;
  oldest_ = oldest;
  newest_ = newest;
  named_.fill(oldest);
  if (named) named_ = *named;
  for (std::size_t i = 0; i < sets.size(); ++i) setsOf(oldest + static_cast<std::int64_t>(i)) = std::move(sets[i]);
  stepper_.invalidate();
  return true;
}

void LocalEngine::start(std::uint64_t seed) {
  owned_ = std::make_unique<Session>(model_, seed, *executor_, services_);
  session_ = owned_.get();
}

bool LocalEngine::restore(const Keyframe& keyframe, const std::optional<NamedSets>& named) {
  // A session that is used again keeps what it worked out of the model. The seed went into the keyframe's State.
  if (session_ != nullptr) return session_->restore(keyframe, named);
  auto fresh = std::make_unique<Session>(model_, 0, *executor_, services_);
  if (!fresh->restore(keyframe, named)) return false;
  owned_ = std::move(fresh);
  session_ = owned_.get();
  return true;
}

}  // namespace calot::recorder
