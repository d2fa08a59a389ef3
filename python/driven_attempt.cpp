// SPDX-License-Identifier: GPL-3.0-or-later
#include "python/driven_attempt.h"

#include <fmt/format.h>

#include <cmath>

#include "python/places.h"
#include "recorder/base/errors.h"
#include "recorder/base/text_words.h"
#include "recorder/formats/scene_file.h"
#include "sim/instruments/instruments.h"

namespace calot::python {

namespace {

constexpr double allButtons = 63.0;

/// Rounded: actions that are drawn at random are no whole numbers.
std::uint8_t buttonsOf(double number, const char* hand) {
  if (!(number >= 0.0 && number <= allButtons))
    throw Error(ErrorKind::invalid,
                fmt::format("the {} hand's command: its buttons are {}; give the sum of 1 cut, 2 coagulation, 4 fire, "
                            "8 lock, 16 and 32 retract more and less",
                            hand, number));
  return static_cast<std::uint8_t>(std::lround(number));
}

}  // namespace

DrivenAttempt::DrivenAttempt(const std::string& scene, std::uint64_t seed)
    : loaded_(recorder::loadScene(recorder::findScene(scene, assetFolders()))),
      scene_(recorder::prepareScene(loaded_.assets, Where{"scene " + scene})),
      facts_(scene_->model().scene()),
      attempt_(scene_, loaded_.assets, seed) {
  for (std::size_t h = 0; h < handCount; ++h) mounted_[h] = attempt_.hands()[h].instrument;
  attempt_.join(facts_);
}

void DrivenAttempt::record(const std::filesystem::path& target, const recorder::AttemptSettings& settings,
                           const recorder::Provenance& controller, bool force) {
  const std::lock_guard lock(mutex_);
  attempt_.record(target, settings, controller, {force, {}});
}

recorder::HandCommands DrivenAttempt::commandsOf(std::span<const double> action) const {
  recorder::HandCommands commands;
  for (std::size_t h = 0; h < handCount; ++h) {
    const std::span<const double> own = action.subspan(h * numbersOfHand, numbersOfHand);
    commands[h] = {Vec3(own[0], own[1], own[2]), own[3], own[4], buttonsOf(own[5], handNames[h]), mounted_[h]};
  }
  return commands;
}

recorder::Outcome DrivenAttempt::step(std::span<const double> action) {
  const std::lock_guard lock(mutex_);
  return attempt_.step(commandsOf(action));
}

std::size_t DrivenAttempt::run(std::span<const double> actions, Bytes& rows) {
  const std::lock_guard lock(mutex_);
  std::size_t done = 0;
  recorder::Outcome outcome = attempt_.outcome();
  for (; (done + 1) * numbersOfAction <= actions.size() && outcome == recorder::Outcome::running; ++done) {
    outcome = attempt_.step(commandsOf(actions.subspan(done * numbersOfAction, numbersOfAction)));
    const Bytes& row = facts_.facts().row;
    rows.insert(rows.end(), row.begin(), row.end());
  }
  return done;
}

void DrivenAttempt::end(recorder::Outcome outcome) {
  const std::lock_guard lock(mutex_);
  attempt_.end(outcome);
}

void DrivenAttempt::mount(Hand hand, const std::string& name) {
  const std::lock_guard lock(mutex_);
  const InstrumentDefinition* const found = findInstrument(name);
  if (found == nullptr && name != "none") {
    std::string known = "none";
    for (const InstrumentDefinition* each : instruments()) known += std::string(", ") + each->name;
    throw Error(ErrorKind::invalid,
                fmt::format("there is no instrument \"{}\"; there are {}", recorder::shown(name), known));
  }
  mounted_[static_cast<std::size_t>(hand)] = found == nullptr ? InstrumentKind::none : found->kind;
}

void DrivenAttempt::look(const Vec3& position, const Quat& orientation) {
  const std::lock_guard lock(mutex_);
  const bool unit = std::abs(orientation.norm() - 1.0) <= 1e-6;
  if (!position.allFinite() || !unit)
    throw Error(ErrorKind::invalid, "the camera: a finite position and a unit quaternion w, x, y, z are expected");
  attempt_.look({position, orientation});
}

Moment DrivenAttempt::moment() const {
  const std::lock_guard lock(mutex_);
  Moment moment;
  moment.view = attempt_.view();
  return moment;
}

std::vector<double> DrivenAttempt::action() const {
  const std::lock_guard lock(mutex_);
  std::vector<double> numbers;
  for (const recorder::HandCommand& hand : attempt_.hands()) {
    for (const double v : {hand.tip.x(), hand.tip.y(), hand.tip.z(), hand.roll, hand.jaw}) numbers.push_back(v);
    numbers.push_back(static_cast<double>(hand.buttons));
  }
  return numbers;
}

}  // namespace calot::python
