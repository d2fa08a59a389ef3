// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/trainer/controls_tutorial.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace calot::gui {
namespace {

constexpr double farEnough = 0.015;           // m across the picture
constexpr double deepEnough = 0.010;          // m along the line of sight
constexpr double opened = 0.4, closed = 0.1;  // rad
constexpr double rotated = 0.4;               // rad about the shaft
constexpr std::array<std::size_t, handCount> each{0, 1};

using Hands = std::array<AttemptFigures::Hand, handCount>;

/// True if either hand did it.
template <class Did>
bool anyHand(const Hands& before, const Hands& now, Did did) {
  return std::any_of(each.begin(), each.end(), [&](std::size_t h) { return did(before[h], now[h]); });
}

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
       [](const Begin& b, const TrainingStatus& s, std::optional<calot::Hand>) {
         return anyHand(b.figures.hand, s.figures.hand, [](const Hand& from, const Hand& to) {
           return (to.tip - from.tip).head<2>().norm() >= farEnough;
         });
       }},
      {"depth",
       mouse ? "Turn the wheel: the tip goes away from you or comes nearer, and stays where it is in the "
               "picture. (Page Up and Page Down push the shaft in and out.)"
             : "Move a hand away from you, or nearer.",
       [](const Begin& b, const TrainingStatus& s, std::optional<calot::Hand>) {
         return anyHand(b.figures.hand, s.figures.hand, [](const Hand& from, const Hand& to) {
           return std::abs(to.tip.z() - from.tip.z()) >= deepEnough;
         });
       }},
      {"opening", mouse ? "Open the jaws: hold the right button, or S." : "Open the jaws of a hand.",
       [](const Begin&, const TrainingStatus& s, std::optional<calot::Hand>) {
         return anyHand(s.figures.hand, s.figures.hand, [](const Hand&, const Hand& to) { return to.jaw >= opened; });
       }},
      {"closing", mouse ? "Close the jaws: hold the left button, or A." : "Close them again.",
       [](const Begin& b, const TrainingStatus& s, std::optional<calot::Hand>) {
         return anyHand(b.figures.hand, s.figures.hand,
                        [](const Hand& from, const Hand& to) { return from.jaw >= opened && to.jaw <= closed; });
       }},
      {"rotating", mouse ? "Rotate the shaft: hold Q or W." : "Rotate a shaft.",
       [](const Begin& b, const TrainingStatus& s, std::optional<calot::Hand>) {
         return anyHand(b.figures.hand, s.figures.hand, [](const Hand& from, const Hand& to) {
           return rotationAboutShaft(from.orientation, to.orientation) >= rotated;
         });
       }}};
  if (mouse) {
    lessons.push_back(
        {"the other hand", "Pass mouse and keyboard to the other hand: Space.",
         [](const Begin& b, const TrainingStatus&, std::optional<calot::Hand> driven) { return driven != b.driven; }});
  }
  lessons.insert(
      lessons.end(),
      {{"exchanging",
        mouse ? "Take the hook into this hand: 2. An exchange takes three seconds."
              : "Take the hook into the right hand: key 2. An exchange takes three seconds.",
        [](const Begin&, const TrainingStatus& s, std::optional<calot::Hand>) {
          return anyHand(s.figures.hand, s.figures.hand,
                         [](const Hand&, const Hand& to) { return to.instrument == InstrumentKind::hook; });
        }},
       {"the pedal",
        mouse ? "Press the cut pedal: D. Only on tissue, once you operate."
              : "Press the cut pedal. Only on tissue, once you operate.",
        [](const Begin&, const TrainingStatus& s, std::optional<calot::Hand>) {
          return anyHand(s.figures.hand, s.figures.hand,
                         [](const Hand&, const Hand& to) { return to.cautery != Cautery::off; });
        }},
       {"touching", "Touch the liver with either tip, gently.",
        [](const Begin&, const TrainingStatus& s, std::optional<calot::Hand>) { return s.figures.touched; }},
       {"the pause", "Pause: Escape. Then go on: Escape again.",
        [](const Begin&, const TrainingStatus& s, std::optional<calot::Hand>) { return s.stage == Stage::paused; }}});
  return lessons;
}

ControlsTutorial::ControlsTutorial(bool mouse) : lessons_(lessonsFor(mouse)) {}

bool ControlsTutorial::observe(const TrainingStatus& status, std::optional<Hand> driven) {
  if (over() || (status.stage != Stage::running && status.stage != Stage::paused) || status.figures.ticks == 0)
    return false;
  if (!begin_) begin_ = Begin{status.figures, driven};
  if (!lessons_[at_].used(*begin_, status, driven)) return false;
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
