// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/trainer/trainer_texts.h"

#include <fmt/format.h>
#include <algorithm>
#include <cctype>
#include <cmath>
#include <cstddef>
#include <QLocale>
#include <string_view>

#include "gui/words/event_words.h"
#include "sim/instruments/instruments.h"

namespace calot::gui {
namespace {

QString stageText(const TrainingStatus& status) {
  switch (status.stage) {
    case Stage::preparing:
      return "Getting ready …";
    case Stage::takingParent:
      return QString("Going back: %1 %").arg(QLocale().toString(std::floor(100.0 * status.progress), 'f', 0));
    case Stage::countdown:
      return QString("Going on in %1 …").arg(QLocale().toString(status.countdown));
    case Stage::ready:
      return "Ready";
    case Stage::running:
      if (!status.kept) return "Demonstration";
      return status.waiting ? QString("Waiting for the device …") : QString::fromUtf8("● Recording");
    case Stage::paused:
      return QString::fromUtf8("❚❚ Paused");
    case Stage::ended:
      return QString::fromUtf8("■ Ended");
  }
  return {};
}

/// Late forces of the last thousand ticks that a hand may feel.
constexpr std::uint64_t noticeable = 10;

QString lateText(const TrainingStatus& status) {
  if (status.stage != Stage::running || status.figures.missedLately < noticeable) return {};
  return QString::fromUtf8("⚠ This computer is too slow at the moment: forces feel rough.");
}

QString technicalText(const AttemptFigures& figures) {
  if (figures.ticks == 0) return {};
  if (figures.missedDeadlines == 0) return "Forces on time";
  const double share = 100.0 * static_cast<double>(figures.missedDeadlines) / static_cast<double>(figures.ticks);
  QString text = QString("%1 forces late (%2 %)")
                     .arg(QLocale().toString(static_cast<qulonglong>(figures.missedDeadlines)),
                          QLocale().toString(share, 'f', share < 10.0 ? 2 : 0));
  if (figures.stretched > 0.05)
    text += QString("\nClock slowed by %1 s").arg(QLocale().toString(figures.stretched, 'f', 1));
  return text;
}

using Exchange = recorder::ControlledSource::Exchange;

/// @param force the task is to press no harder than needed: how hard it presses
QString handText(const AttemptFigures::Hand& hand, const std::optional<Exchange>& exchange, std::size_t which,
                 bool driven, bool force) {
  QString text = driven ? QString::fromUtf8("▶ ") : QString();
  text += which == 0 ? "Left: " : "Right: ";
  if (exchange) {
    const double seconds = std::ceil(tickLength * exchange->ticks);
    return text +
           QString("gets the %1 in %2 s").arg(instrumentOf(exchange->coming).word, QLocale().toString(seconds, 'f', 0));
  }
  const InstrumentDefinition& instrument = instrumentOf(hand.instrument);
  text += instrument.word;
  if (instrument.action == InstrumentAction::clip)
    text += hand.clips == 1 ? QString(", 1 clip left") : QString(", %1 clips left").arg(hand.clips);
  if (hand.holds) text += ", holds tissue";
  if (force && hand.force > 0.0)
    text += QString("\n  presses %1 mm deep with %2 N")
                .arg(QLocale().toString(1e3 * hand.depth, 'f', 0), QLocale().toString(hand.force, 'f', 1));
  if (force && hand.greatestForce > 0.0)
    text += QString("\n  at most %1 N so far").arg(QLocale().toString(hand.greatestForce, 'f', 1));
  if (hand.cautery == Cautery::onTissue) text += ", burns";
  if (hand.cautery == Cautery::withoutContact) text += ", burns in the air";
  if (!hand.measured) text += " (not measured)";
  return text;
}

QString scoreText(const SceneDescription& scene, const AttemptFigures& figures) {
  const ProcedureStatus& p = figures.procedure;
  if (scene.procedure.specimen.empty()) return {};
  QString text;
  if (!scene.procedure.divide.empty()) {
    text = QString("Critical view %1 of 6%2\n")
               .arg(p.triangleCleared + p.lowerThirdFreed + p.twoStructures)
               .arg(p.criticalViewFrozen ? " (at the first clip)" : "");
  }
  QStringList counts;
  for (const Severity severity : {Severity::critical, Severity::major, Severity::minor}) {
    if (p.errors(severity) > 0) counts += QString("%1 %2").arg(p.errors(severity)).arg(analytics::nameOf(severity));
  }
  return text + "Errors: " + (counts.isEmpty() ? QString("none") : counts.join(", "));
}

QString resultText(const TrainingStatus& status) {
  if (status.stage != Stage::ended || status.file.empty()) return {};
  QString text =
      QString("Outcome: %1, after %2").arg(recorder::wordFor(status.report.outcome), clockText(status.figures.time));
  const bool why = status.report.outcome == recorder::Outcome::abandoned && !status.undone.empty();
  text += why ? ": " + QString::fromStdString(status.undone) + '.' : QString('.');
  if (!status.parent.empty()) text += QString("\nA branch, from %1 on.").arg(clockText(status.branchedAt));
  if (!status.kept) return text + "\nA demonstration: its recording is not kept.";
  text += "\nRecorded in " + QString::fromStdString(status.file.string());
  return status.locked ? text : text + ", without a lock, which its file system does not grant";
}

QString pointerText(const TrainingStatus& status, recorder::Mode mode, Pointer pointer) {
  const bool practice = mode == recorder::Mode::practice;
  if (status.stage == Stage::paused && pointer == Pointer::windowLeft)
    return "Paused because the window lost the keyboard. Escape goes on.";
  if (status.stage != Stage::running) return {};
  switch (pointer) {
    case Pointer::elsewhere:
      break;
    case Pointer::held:
      return practice ? "The picture has the mouse: Escape pauses and frees it."
                      : "The picture has the mouse: Escape frees it.";
    case Pointer::bounded:
      return "This window system (Wayland) lets no program hold the mouse: it stops at the screen's edge. Ctrl moves "
             "it "
             "without the hand.";
    case Pointer::free:
      return "The mouse is free and moves no hand. Click the picture to drive again.";
    case Pointer::windowLeft:
      return "The window lost the keyboard: all keys are let go, the hands hold still, the clock runs on. "
             "Click the picture to drive again.";
  }
  return {};
}

bool acts(const AttemptFigures::Hand& hand, InstrumentAction action) {
  return instrumentOf(hand.instrument).action == action;
}

/// Instrument to mount first; empty if a hand holds one that does this.
std::string take(const AttemptFigures& figures, InstrumentAction action) {
  if (std::any_of(figures.hand.begin(), figures.hand.end(), [action](const auto& h) { return acts(h, action); }))
    return "";
  for (const InstrumentDefinition* instrument : instruments()) {
    if (instrument->action == action) return fmt::format("Take the {}. ", instrument->word);
  }
  return "";
}

const AttemptFigures::Vessel* vesselNamed(const SceneDescription& scene, const AttemptFigures& figures,
                                          const std::string& name) {
  for (std::size_t v = 0; v < scene.vessels.size() && v < figures.vessel.size(); ++v) {
    if (scene.vessels[v].name == name) return &figures.vessel[v];
  }
  return nullptr;
}

/// A step of the procedure, for who does it and for who watches.
struct Hint {
  std::string tool;   ///< what to take first: "Take the hook. ", or nothing
  std::string task;   ///< "clip the cystic duct"
  std::string how;    ///< for who does it: "pull it tight and press the cut pedal"; or nothing
  std::string state;  ///< "1 of 3 clips are on, 2 stay with the patient"; or nothing

  [[nodiscard]] std::string text(bool watched) const {
    std::string text = watched ? "Watch the performer " + task : tool + task;
    if (!watched) text[tool.size()] = static_cast<char>(std::toupper(static_cast<unsigned char>(text[tool.size()])));
    const std::string& method = watched ? std::string() : how;
    for (const std::string* part : {&method, &state})
      if (!part->empty()) text += (part == &state && !method.empty() ? ". " : ": ") + *part;
    return text + '.';
  }
};

/// The first vessel that is still to be clipped or cut, or nothing.
std::optional<Hint> vesselHint(const SceneDescription& scene, const AttemptFigures& figures) {
  for (const DivideDescription& wanted : scene.procedure.divide) {
    const AttemptFigures::Vessel* const vessel = vesselNamed(scene, figures, wanted.vessel);
    if (vessel == nullptr || vessel->partings > 0) continue;
    const std::uint32_t clips = wanted.patient + wanted.specimen;
    const std::string name = spoken(wanted.vessel);
    if (vessel->clips < clips) {
      return Hint{take(figures, InstrumentAction::clip), "clip the " + name, "",
                  fmt::format("{} of {} clips are on, {} stay with the patient", vessel->clips, clips, wanted.patient)};
    }
    return Hint{take(figures, InstrumentAction::cut), fmt::format("cut the {} between its clips", name), "",
                fmt::format("{} stay with the patient", wanted.patient)};
  }
  return std::nullopt;
}

/// A missing criterion of the critical view; none if it is satisfactory.
std::optional<Hint> viewHint(const SceneDescription& scene, const AttemptFigures& figures) {
  const ProcedureStatus& p = figures.procedure;
  if (p.criticalViewFrozen || p.criticalView() >= JudgementRules().satisfactory) return std::nullopt;
  const std::string hook = take(figures, InstrumentAction::burn);
  if (p.triangleCleared < 2)
    return Hint{hook, "carve the fat off Calot's triangle", "pull it tight and press the cut pedal", ""};
  if (p.twoStructures < 2)
    return Hint{hook, "free the vessels that enter the gallbladder of the fat around them", "", ""};
  return Hint{hook, fmt::format("free the lower third of the {}", spoken(scene.procedure.bed)), "",
              fmt::format("{:.0f} % of that third is still attached", std::ceil(100.0 * p.lowerThirdAttached))};
}

/// The dissection, when nothing is left to divide.
Hint dissectionHint(const SceneDescription& scene, const AttemptFigures& figures) {
  const std::string specimen = spoken(scene.procedure.specimen);
  if (!scene.procedure.fat.empty() && !(figures.attached > 0.0))
    return {"", fmt::format("pull the {} away and divide the fat that still holds it", specimen), "", ""};
  return {take(figures, InstrumentAction::burn), fmt::format("take the {} off its bed", specimen),
          "pull it away and burn what is stretched",
          fmt::format("{:.0f} % is still attached", std::ceil(100.0 * figures.attached))};
}

constexpr double farEnough = 0.015;           // m across the picture
constexpr double deepEnough = 0.010;          // m along the line of sight
constexpr double opened = 0.4, closed = 0.1;  // rad
constexpr double rotated = 0.4;               // rad about the shaft

double rotationAboutShaft(const Quat& from, const Quat& to) {
  const Quat change = from.conjugate() * to;
  return 2.0 * std::abs(std::atan2(change.z(), std::abs(change.w())));
}

}  // namespace

QString clockText(double seconds) {
  return QString::fromStdString(timeText(seconds)).replace('.', QLocale().decimalPoint());
}

QString errorText(const analytics::ErrorLine& error) {
  return QString("%1  %2: %3")
      .arg(clockText(error.time), analytics::nameOf(error.severity), QString::fromStdString(error.counted()));
}

PanelText panelText(const TrainingStatus& status, const SceneDescription& scene, const std::string& summary,
                    recorder::Mode mode, std::optional<Hand> driven, Pointer pointer) {
  PanelText out;
  out.stage = stageText(status);
  out.mode = mode == recorder::Mode::practice ? "Practice" : "Assessment";
  if (status.operatorKind != recorder::OperatorKind::human && !status.attempt.empty()) out.mode += ", synthetic";
  if (status.stage == Stage::preparing) return out;
  const AttemptFigures& figures = status.figures;
  const bool practice = mode == recorder::Mode::practice;
  out.time = clockText(figures.time);
  out.late = lateText(status);
  out.technical = technicalText(figures);
  if (figures.procedure.phase != Phase::none)
    out.phase = "Phase: " + QString::fromStdString(wordFor(figures.procedure.phase));
  if (figures.retraction)
    out.assistant = QString("Assistant: retracts %1 mm").arg(1e3 * *figures.retraction, 0, 'f', 0);
  if (practice) out.score = scoreText(scene, figures);
  if (practice && (status.stage == Stage::running || status.stage == Stage::ready)) {
    const bool watched = status.operatorKind == recorder::OperatorKind::performer;
    out.hint = QString::fromStdString(hintFor(scene, summary, figures, watched));
  }
  for (std::size_t h = 0; h < handCount; ++h)
    out.hand[h] = handText(figures.hand[h], status.exchange[h], h, driven && static_cast<std::size_t>(*driven) == h,
                           practice && scene.procedure.specimen.empty());
  out.pointer = pointerText(status, mode, pointer);
  out.result = resultText(status);
  return out;
}

std::string whatIsUndone(const SceneDescription& scene, const AttemptFigures& figures) {
  if (!figures.touched) return "nothing was touched";
  if (scene.procedure.specimen.empty() || figures.procedure.phase == Phase::done) return {};
  const std::string phase = wordFor(figures.procedure.phase);
  return phase.empty() ? "the procedure is not done" : "the procedure was still at its phase " + phase;
}

std::string hintFor(const SceneDescription& scene, const std::string& summary, const AttemptFigures& figures,
                    bool watched) {
  if (scene.procedure.specimen.empty()) return watched ? "Watch: a program operates, no person. " + summary : summary;
  if (figures.procedure.phase == Phase::done)
    return watched ? "The performer has done." : "All is done. End the attempt when you are content.";
  for (std::size_t h = 0; h < handCount && !watched; ++h) {
    if (figures.hand[h].cautery == Cautery::withoutContact)
      return fmt::format("The {} {} burns in the air: press the pedal on tissue only.", handNames[h],
                         instrumentOf(figures.hand[h].instrument).word);
  }
  const bool toDivide =
      std::any_of(scene.procedure.divide.begin(), scene.procedure.divide.end(), [&](const DivideDescription& d) {
        const AttemptFigures::Vessel* const vessel = vesselNamed(scene, figures, d.vessel);
        return vessel != nullptr && vessel->partings == 0;
      });
  std::optional<Hint> hint;
  if (toDivide) hint = viewHint(scene, figures);
  if (toDivide && !hint) hint = vesselHint(scene, figures);
  return hint.value_or(dissectionHint(scene, figures)).text(watched);
}

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
