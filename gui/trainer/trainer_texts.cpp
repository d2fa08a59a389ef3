// SPDX-License-Identifier: GPL-3.0-or-later
#include "gui/trainer/trainer_texts.h"

#include <cmath>
#include <QLocale>

#include "gui/trainer/hints.h"
#include "recorder/words.h"
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
    case Stage::running:
      return status.waiting ? QString("Waiting for the device …") : QString::fromUtf8("● Recording");
    case Stage::paused:
      return QString::fromUtf8("❚❚ Paused");
    case Stage::ended:
      return QString::fromUtf8("■ Ended");
  }
  return {};
}

QString deadlineText(const AttemptFigures& figures) {
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

QString handText(const AttemptFigures::Hand& hand, const std::optional<Exchange>& exchange, std::size_t which,
                 bool driven) {
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
  text += p.errors == 0   ? QString("No errors")
          : p.errors == 1 ? QString("1 error")
                          : QString("%1 errors").arg(p.errors);
  if (p.criticalErrors > 0) text += QString(", %1 critical").arg(p.criticalErrors);
  return text;
}

QString resultText(const TrainingStatus& status) {
  if (status.stage != Stage::ended || status.file.empty()) return {};
  QString text =
      QString("Outcome: %1, after %2").arg(recorder::wordFor(status.report.outcome), clockText(status.figures.time));
  const bool why = status.report.outcome == recorder::Outcome::abandoned && !status.undone.empty();
  text += why ? ": " + QString::fromStdString(status.undone) + '.' : QString('.');
  if (!status.parent.empty()) text += QString("\nA branch, from %1 on.").arg(clockText(status.branchedAt));
  return text + "\nRecorded in " + QString::fromStdString(status.file.string());
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
    case Pointer::free:
      return "The mouse is free and moves no hand. Click the picture to drive again.";
    case Pointer::windowLeft:
      return "The window lost the keyboard: all keys are let go, the hands hold still, the clock runs on. "
             "Click the picture to drive again.";
  }
  return {};
}

}  // namespace

QString clockText(double seconds) {
  // Tenths that are over: a clock does not round up.
  const auto tenths = static_cast<qlonglong>(std::floor(10.0 * std::max(seconds, 0.0) + 1e-6));
  return QString("%1:%2%3%4")
      .arg(tenths / 600)
      .arg(tenths / 10 % 60, 2, 10, QChar('0'))
      .arg(QLocale().decimalPoint())
      .arg(tenths % 10);
}

QString mistakeText(const Mistake& mistake) {
  return clockText(mistake.time) + (mistake.critical ? "  critical: " : "  ") + QString::fromStdString(mistake.text);
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
  out.deadlines = deadlineText(figures);
  out.late = status.stage == Stage::running && figures.missedLately > 0;
  if (figures.procedure.phase != Phase::none)
    out.phase = "Phase: " + QString::fromStdString(wordFor(figures.procedure.phase));
  if (figures.retraction)
    out.assistant = QString("Assistant: retracts %1 mm").arg(1e3 * *figures.retraction, 0, 'f', 0);
  if (practice) out.score = scoreText(scene, figures);
  if (practice && status.stage == Stage::running) out.hint = QString::fromStdString(hintFor(scene, summary, figures));
  for (std::size_t h = 0; h < handCount; ++h)
    out.hand[h] = handText(figures.hand[h], status.exchange[h], h, driven && static_cast<std::size_t>(*driven) == h);
  out.pointer = pointerText(status, mode, pointer);
  out.result = resultText(status);
  return out;
}

}  // namespace calot::gui
