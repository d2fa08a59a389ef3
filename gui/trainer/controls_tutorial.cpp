// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/trainer/controls_tutorial.h"

#include <cmath>
#include <string_view>

namespace calot::gui {
namespace {

constexpr double farEnough = 0.015;           // m across the picture
constexpr double deepEnough = 0.010;          // m along the line of sight
constexpr double opened = 0.4, closed = 0.1;  // rad
constexpr double rotated = 0.4;               // rad about the shaft

double rotationAboutShaft(const Quat& from, const Quat& to) {
  const Quat change = from.conjugate() * to;
  return 2.0 * std::abs(std::atan2(change.z(), std::abs(change.w())));
}

}  // namespace

std::vector<ControlsTutorial::Lesson> ControlsTutorial::lessonsFor(bool mouse) {
  using Hand = AttemptFigures::Hand;
  std::vector<Lesson> lessons{
      {"moving",
       mouse ? "Move the mouse, or use the arrows: the tip goes to all four sides." : "Move a hand to the side.",
       [](const Hand& from, const Hand& to) { return (to.tip - from.tip).head<2>().norm() >= farEnough; }},
      {"depth",
       mouse ? "Turn the wheel: the tip goes away from you or comes nearer, and stays where it is in the "
               "picture. (Page Up and Page Down push the shaft in and out.)"
             : "Move a hand away from you, or nearer.",
       [](const Hand& from, const Hand& to) { return std::abs(to.tip.z() - from.tip.z()) >= deepEnough; }},
      {"opening", mouse ? "Open the jaws: hold the right button, or S." : "Open the jaws of a hand.",
       [](const Hand&, const Hand& to) { return to.jaw >= opened; }},
      {"closing", mouse ? "Close the jaws: hold the left button, or A." : "Close them again.",
       [](const Hand& from, const Hand& to) { return from.jaw >= opened && to.jaw <= closed; }},
      {"rotating", mouse ? "Rotate the shaft: hold Q or W." : "Rotate a shaft.",
       [](const Hand& from, const Hand& to) {
         return rotationAboutShaft(from.orientation, to.orientation) >= rotated;
       }},
      {"the other hand", "Pass mouse and keyboard to the other hand: Space.", nullptr,
       [](const Begin& b, const TrainingStatus&, std::optional<calot::Hand> driven) { return driven != b.driven; }},
      {"exchanging",
       mouse ? "Take the hook into this hand: 2. An exchange takes three seconds."
             : "Take the hook into the right hand: key 2. An exchange takes three seconds.",
       [](const Hand&, const Hand& to) { return to.instrument == InstrumentKind::hook; }},
      {"the pedal",
       mouse ? "Press the cut pedal: D. Only on tissue, once you operate."
             : "Press the cut pedal. Only on tissue, once you operate.",
       [](const Hand&, const Hand& to) { return to.cautery != Cautery::off; }},
      {"touching", "Touch the liver with either tip, gently.", nullptr,
       [](const Begin&, const TrainingStatus& s, std::optional<calot::Hand>) { return s.figures.touched; }},
      {"the pause", "Pause: Escape. Then go on: Escape again.", nullptr,
       [](const Begin&, const TrainingStatus& s, std::optional<calot::Hand>) { return s.stage == Stage::paused; }}};
  if (!mouse)
    std::erase_if(lessons, [](const Lesson& lesson) { return lesson.name == std::string_view("the other hand"); });
  return lessons;
}

ControlsTutorial::ControlsTutorial(bool mouse) : lessons_(lessonsFor(mouse)) {}

bool ControlsTutorial::observe(const TrainingStatus& status, std::optional<Hand> driven) {
  if (over() || (status.stage != Stage::running && status.stage != Stage::paused) || status.figures.ticks == 0)
    return false;
  if (!begin_) begin_ = Begin{status.figures, driven};
  const Lesson& lesson = lessons_[at_];
  bool used = lesson.used != nullptr && lesson.used(*begin_, status, driven);
  for (std::size_t h = 0; h < handCount && lesson.byHand != nullptr; ++h)
    used = used || lesson.byHand(begin_->figures.hand[h], status.figures.hand[h]);
  if (!used) return false;
  ++at_;
  learnt_ = true;
  begin_ = Begin{status.figures, driven};
  return true;
}

void ControlsTutorial::skip() {
  if (over()) return;
  ++at_;
  learnt_ = false;
  begin_.reset();
}

QString ControlsTutorial::text() const {
  QString before;
  if (at_ > 0 && learnt_) before = QString::fromUtf8("✓ Done: %1.\n").arg(lessons_[at_ - 1].name);
  if (over()) return before + "These are the controls. End the attempt, and begin with the first task.";
  return before + QString("Control %1 of %2: %3").arg(at_ + 1).arg(count()).arg(lessons_[at_].ask);
}

}  // namespace calot::gui
